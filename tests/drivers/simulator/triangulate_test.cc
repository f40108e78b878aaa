#include "drivers/simulator/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>

namespace waymark {
namespace {

using Outline = std::vector<Eigen::Vector2d>;

double Area(const Eigen::Vector2d& a,
            const Eigen::Vector2d& b,
            const Eigen::Vector2d& c) {
  return ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x()) / 2.0;
}

double Area(const Outline& outline) {
  double area = 0.0;
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    area += Area(outline[0], outline[i], outline[i + 1]);
  }
  return area;
}

void ExpectFilled(const Outline& outline) {
  const auto triangles = Triangulate(outline);
  EXPECT_EQ(triangles.size(), outline.size() - 2);
  double area = 0.0;
  std::set<std::uint32_t> used;
  for (const auto& t : triangles) {
    const double part = Area(outline[t[0]], outline[t[1]], outline[t[2]]);
    EXPECT_GT(part, 0.0);
    area += part;
    used.insert(t.begin(), t.end());
  }
  EXPECT_NEAR(area, Area(outline), 1e-9);
  EXPECT_EQ(used.size(), outline.size());  // Those within a side too.
}

TEST(Triangulate, FillsConvexAndConcaveOutlines) {
  ExpectFilled({{0, 0}, {1, 0}, {0, 1}});
  ExpectFilled({{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 5}, {0, 5}});
  ExpectFilled(
      {{0, 0}, {9, 0}, {9, 6}, {7, 6}, {7, 2}, {2, 2}, {2, 6}, {0, 6}});  // A
                                                                          // U.
}

TEST(Triangulate, KeepsCornersWithinStraightSides) {
  ExpectFilled(
      {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {3, 2}, {1.5, 2}, {0, 2}});
  // All but one side have some.
  ExpectFilled({{0, 0}, {1, 0}, {4, 0}, {3, 1}, {2, 2}, {0, 4}, {0, 1}});
}

TEST(Triangulate, FillsStarsAtAnyTurn) {
  for (int turn = 0; turn < 12; ++turn) {
    Outline outline;
    for (int i = 0; i < 14; ++i) {
      const double angle = 0.1 * turn + 2.0 * std::numbers::pi * i / 14.0;
      const double radius = i % 2 == 0 ? 3.0 : 1.0;
      outline.emplace_back(20.0 + radius * std::cos(angle),
                           -7.0 + radius * std::sin(angle));
    }
    ExpectFilled(outline);
  }
}

TEST(Triangulate, RefusesWhatHasNoInside) {
  EXPECT_THROW((void)Triangulate({{0, 0}, {1, 0}}), std::invalid_argument);
  EXPECT_THROW((void)Triangulate({{0, 0}, {0, 1}, {1, 1}, {1, 0}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace waymark
