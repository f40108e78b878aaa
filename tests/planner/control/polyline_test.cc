#include "planner/control/polyline.h"

#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(Polyline, MeasuresAlongItAndGoesStraightOnBeyond) {
  const Polyline line({{0, 0}, {2, 0}, {2, 3}});
  EXPECT_EQ(line.length(), 5.0);
  EXPECT_EQ(line.PointAt(1.0), Eigen::Vector2d(1, 0));
  EXPECT_EQ(line.PointAt(3.0), Eigen::Vector2d(2, 1));
  EXPECT_EQ(line.PointAt(7.0), Eigen::Vector2d(2, 5));
  EXPECT_NEAR(line.TurnAt(1), kPi / 2, 1e-12);
  EXPECT_EQ(Polyline({{1, 2}}).PointAt(3.0), Eigen::Vector2d(1, 2));
}

TEST(Polyline, ProjectsWithinBoundsWithTheSideAsSign) {
  const Polyline line({{0, 0}, {2, 0}, {2, 3}, {0, 3}, {0, -1}});
  Polyline::Foot foot = line.Project({1.0, 0.4}, 0.0, 2.0);
  EXPECT_NEAR(foot.s, 1.0, 1e-12);
  EXPECT_NEAR(foot.offset, 0.4, 1e-12);
  foot = line.Project({1.0, -0.4}, 0.0, 2.0);
  EXPECT_NEAR(foot.offset, -0.4, 1e-12);
  // The last piece crosses the first: the bounds choose.
  EXPECT_NEAR(line.Project({0.0, 0.1}, 0.0, 1.0).s, 0.0, 1e-12);
  EXPECT_NEAR(line.Project({0.0, 0.1}, 8.0, 11.0).s, 9.9, 1e-12);
  // Before and after.
  EXPECT_EQ(line.Project({-5.0, 0.0}, -1.0, 1.0).s, 0.0);
  EXPECT_EQ(line.Project({0.0, -9.0}, 10.0, 99.0).s, line.length());
}

TEST(Polyline, RefusesEqualPointsInARow) {
  EXPECT_THROW(Polyline({{0, 0}, {0, 0}}), std::logic_error);
  EXPECT_THROW(Polyline(std::vector<Eigen::Vector2d>{}), std::logic_error);
}

}  // namespace
}  // namespace waymark
