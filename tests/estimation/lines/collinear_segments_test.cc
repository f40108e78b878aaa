#include "estimation/lines/collinear_segments.h"

#include "estimation/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

using Eigen::Vector2d;

LineSegment Segment(const Vector2d& a, const Vector2d& b) {
  LineSegment segment;
  segment.a = a;
  segment.b = b;
  segment.sigma_px = 0.2;
  segment.sigma_rad = 0.4 / (b - a).norm();
  return segment;
}

TEST(CollinearSegments, PiecesOfOneLineBecomeThatLine) {
  // Down to the left, so that neither axis is special.
  const Vector2d from(400.0, 50.0);
  const Vector2d along = Vector2d(-2.0, 1.0).normalized();
  std::vector<LineSegment> segments;
  for (const double s : {150.0, 0.0, 60.0}) {
    const double length = 40.0 + 0.1 * s;
    segments.push_back(Segment(from + s * along, from + (s + length) * along));
  }
  // Walked the other way.
  std::swap(segments[1].a, segments[1].b);
  segments.push_back(Segment({10.0, 10.0}, {10.0, 30.0}));
  const JoinedSegments joined = JoinCollinear(segments, {});
  ASSERT_EQ(joined.segments.size(), 2u);
  const LineSegment& line = joined.segments[0];
  EXPECT_LT((line.a - from).norm(), 1e-9);
  EXPECT_LT((line.b - (from + 205.0 * along)).norm(), 1e-9);
  // Longer lines know more.
  EXPECT_LT(line.sigma_rad, segments[0].sigma_rad);
  EXPECT_LT(line.sigma_px, segments[0].sigma_px);
  EXPECT_EQ(joined.num_pieces, (std::vector<int>{3, 3, 3, 1}));
}

TEST(CollinearSegments, ErrorsAreThoseItStates) {
  Random random(SeedFor(1, "CollinearSegments.Errors"));
  constexpr int kRuns = 400;
  // Short pieces point far past the others.
  CollinearOptions options;
  options.max_distance_px = 10.0;
  double offsets = 0.0;
  double turns = 0.0;
  for (int i = 0; i < kRuns; ++i) {
    std::vector<LineSegment> segments;
    for (const double x : {0.0, 50.0, 160.0}) {
      LineSegment segment = Segment({x, 0.0}, {x + 40.0 - 0.1 * x, 0.0});
      const double half = 0.5 * (segment.b.x() - segment.a.x());
      const double offset = random.Normal(segment.sigma_px);
      const double turn = random.Normal(segment.sigma_rad);
      segment.a.y() = offset - half * turn;
      segment.b.y() = offset + half * turn;
      segments.push_back(segment);
    }
    const JoinedSegments joined = JoinCollinear(segments, options);
    ASSERT_EQ(joined.segments.size(), 1u);
    const LineSegment& line = joined.segments[0];
    const double offset = 0.5 * (line.a.y() + line.b.y()) / line.sigma_px;
    const Vector2d d = line.b - line.a;
    const double turn = std::atan(d.y() / d.x()) / line.sigma_rad;
    offsets += offset * offset;
    turns += turn * turn;
  }
  // Four sigma of the mean of 400 squares about 1.
  EXPECT_NEAR(offsets / kRuns, 1.0, 0.28);
  EXPECT_NEAR(turns / kRuns, 1.0, 0.28);
}

TEST(CollinearSegments, OthersStayAsTheyAre) {
  const std::vector<LineSegment> segments{
      Segment({0.0, 0.0}, {100.0, 0.0}),
      // Beside it, across it, and far along it.
      Segment({0.0, 4.0}, {90.0, 4.0}),
      Segment({50.0, -10.0}, {50.0, 10.0}),
      Segment({501.0, 0.0}, {540.0, 0.0})};
  const JoinedSegments joined = JoinCollinear(segments, {});
  ASSERT_EQ(joined.segments.size(), 4u);
  EXPECT_EQ(joined.segments[0].b, segments[0].b);
  EXPECT_EQ(joined.segments[1].b, segments[1].b);
  EXPECT_EQ(joined.num_pieces, (std::vector<int>{1, 1, 1, 1}));
  EXPECT_TRUE(JoinCollinear({}, {}).segments.empty());
}

TEST(CollinearSegments, RefusesWhatIsNoSegment) {
  std::vector<LineSegment> segments{Segment({0.0, 0.0}, {9.0, 0.0})};
  segments[0].b.y() = std::numeric_limits<double>::infinity();
  EXPECT_THROW((void)JoinCollinear(segments, {}), std::logic_error);
  segments[0].b = segments[0].a;
  EXPECT_THROW((void)JoinCollinear(segments, {}), std::logic_error);
  CollinearOptions options;
  options.max_gap = -1.0;
  EXPECT_THROW((void)JoinCollinear({}, options), std::invalid_argument);
}

}  // namespace
}  // namespace waymark
