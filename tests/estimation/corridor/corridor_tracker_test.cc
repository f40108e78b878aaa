#include "estimation/corridor/corridor_tracker.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "tests/support/corridor_lines.h"

#include <Eigen/LU>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace waymark {
namespace {

CorridorGeometry Corridor() {
  CorridorGeometry corridor;
  corridor.width = 2.0;
  corridor.height = 2.5;
  corridor.skirting_height = 0.08;
  corridor.x_min = 0.0;
  corridor.x_max = 20.0;
  return corridor;
}

// Without a skirting board.
CorridorGeometry BareCorridor() {
  CorridorGeometry corridor = Corridor();
  corridor.skirting_height.reset();
  return corridor;
}

CorridorPrior PriorAt(const Pose2& X_LR) {
  return {X_LR, Eigen::Vector3d(0.04, 0.09, 0.01).asDiagonal()};
}

CorridorTrackerOptions ExactOptions() {
  CorridorTrackerOptions options;
  options.model_px = 0.0;
  options.model_rad = 0.0;
  return options;
}

// A grid of tilts, yaws, headings and offsets; how many of the 180 poses had no
// answer. Those that have one are exact.
int RefusedOfGrid(double x) {
  CorridorLinesOptions see;
  see.has_skirting = true;
  see.has_clutter = true;
  int num_refused = 0;
  for (const double tilt_deg : {-8.0, 0.0, 12.0}) {
    for (const double yaw_deg : {0.0, 15.0}) {
      const CorridorView view = ViewForTests(RadiansFromDegrees(tilt_deg),
                                             RadiansFromDegrees(yaw_deg));
      for (const double heading_deg : {-25.0, -8.0, 0.0, 3.0, 17.0, 25.0}) {
        for (const double y : {-0.6, -0.1, 0.0, 0.35, 0.7}) {
          const Pose2 X_LR{x, y, RadiansFromDegrees(heading_deg - yaw_deg)};
          const auto estimate =
              EstimateCorridor(view,
                               SeeCorridor(view, Corridor(), X_LR, see),
                               Corridor(),
                               PriorAt({x, y + 0.1, X_LR.heading - 0.05}),
                               ExactOptions());
          if (estimate.status != CorridorStatus::kAccepted) {
            ++num_refused;
            continue;
          }
          EXPECT_NEAR(*estimate.y, y, 1e-9);
          EXPECT_NEAR(*estimate.heading, X_LR.heading, 1e-9);
        }
      }
    }
  }
  return num_refused;
}

TEST(EstimateCorridor, ExactLinesGiveExactPoses) {
  EXPECT_EQ(RefusedOfGrid(5.0), 0);
}

// Edges near by, which count most, are not expected where the corridor may not
// have begun: one of the poses is then not told from another.
TEST(EstimateCorridor, ExactLinesGiveExactPosesWhereTheCorridorBegins) {
  EXPECT_LE(RefusedOfGrid(0.0), 2);
}

// Somewhere in the corridor, who knows where: its lines say the rest.
TEST(EstimateCorridor, WhereAlongTheCorridorNeedNotBeKnown) {
  const CorridorView view = ViewForTests(0.1);
  CorridorLinesOptions see;
  see.has_skirting = true;
  for (const double x : {4.0, 10.0, 12.0}) {
    for (const double sigma_x : {3.0, 8.0, 100.0}) {
      const Pose2 X_LR{x, 0.3, 0.1};
      CorridorPrior prior = PriorAt({10.0, 0.2, 0.05});
      prior.covariance(0, 0) = sigma_x * sigma_x;
      const auto estimate =
          EstimateCorridor(view,
                           SeeCorridor(view, Corridor(), X_LR, see),
                           Corridor(),
                           prior,
                           ExactOptions());
      ASSERT_EQ(estimate.status, CorridorStatus::kAccepted)
          << estimate.reason << " " << x << " " << sigma_x;
      EXPECT_NEAR(*estimate.y, 0.3, 1e-9);
    }
  }
}

// Turning on the spot it sees floor edge and skirting board of one wall alone.
TEST(EstimateCorridor, OneWallBeforeARobotThatTurnsIsEnough) {
  const CorridorView view = ViewForTests(0.1);
  CorridorLinesOptions see;
  see.has_skirting = true;
  see.has_ceiling = false;
  for (const double heading_deg : {-75.0, -60.0, 50.0, 65.0, -105.0}) {
    const Pose2 X_LR{8.0, 0.05, RadiansFromDegrees(heading_deg)};
    const auto estimate =
        EstimateCorridor(view,
                         SeeCorridor(view, Corridor(), X_LR, see),
                         Corridor(),
                         PriorAt({8.0, 0.1, X_LR.heading + 0.05}),
                         ExactOptions());
    ASSERT_EQ(estimate.status, CorridorStatus::kAccepted)
        << estimate.reason << " " << heading_deg;
    EXPECT_NEAR(*estimate.y, 0.05, 1e-9);
    EXPECT_NEAR(WrapAngle(*estimate.heading - X_LR.heading), 0.0, 1e-9);
  }
}

// Two joints of a floor are as parallel: where such a pair is but near its
// place, it is no position.
TEST(EstimateCorridor, APairOfLinesThatFitsBadlyIsNone) {
  const CorridorView view = ViewForTests(0.1);
  CorridorLinesOptions see;
  see.has_skirting = true;
  see.has_ceiling = false;
  const Pose2 X_LR{8.0, 0.05, RadiansFromDegrees(70.0)};
  LineSet lines = SeeCorridor(view, Corridor(), X_LR, see);
  ASSERT_EQ(lines.segments.size(), 2u);
  for (const double off_px : {2.0, -2.0}) {
    LineSet moved = lines;
    for (std::size_t i = 0; i < 2; ++i) {
      const double own = i == 0 ? off_px : -off_px;
      moved.segments[i].a.y() += own;
      moved.segments[i].b.y() += own;
      moved.segments[i].sigma_px = 1.0;
    }
    const auto estimate = EstimateCorridor(view,
                                           moved,
                                           Corridor(),
                                           PriorAt({8.0, 0.05, X_LR.heading}),
                                           ExactOptions());
    EXPECT_NE(estimate.status, CorridorStatus::kAccepted);
  }
}

// The border of what a lens sees is as sharp as any edge of a corridor.
TEST(PinholeLines, TheBorderOfTheLensIsNoLine) {
  const FisheyeCamera narrow({320.0, 320.0, 159.5, 119.5});
  PinholeLines lines({narrow, {320, 240}}, {});
  const LineSet found = lines.Find(cv::Mat1b(240, 320, std::uint8_t{220}));
  EXPECT_TRUE(found.segments.empty());
}

TEST(EstimateCorridor, ABlankWallAtTheEndIsTheEnd) {
  const CorridorView view = ViewForTests(0.1);
  CorridorPrior prior = PriorAt({19.5, 0.0, 0.0});
  const auto blank = [&] {
    return EstimateCorridor(view, {}, Corridor(), prior, ExactOptions()).status;
  };
  EXPECT_EQ(blank(), CorridorStatus::kEnds);
  prior.covariance(0, 0) = 25.0;  // It may be anywhere.
  EXPECT_EQ(blank(), CorridorStatus::kNoLines);
}

// The other way along the corridor, which looks the same.
TEST(EstimateCorridor, ThePriorChoosesTheDirection) {
  const CorridorView view = ViewForTests(0.1);
  const Pose2 X_LR{16.0, 0.3, RadiansFromDegrees(172.0)};
  const LineSet lines = SeeCorridor(view, BareCorridor(), X_LR, {});
  const auto back = EstimateCorridor(
      view, lines, BareCorridor(), PriorAt(X_LR), ExactOptions());
  ASSERT_EQ(back.status, CorridorStatus::kAccepted) << back.reason;
  EXPECT_NEAR(*back.heading, X_LR.heading, 1e-9);
  EXPECT_NEAR(*back.y, 0.3, 1e-9);
  // Turned by half a turn, the same lines are those of -y.
  const auto there = EstimateCorridor(
      view, lines, BareCorridor(), PriorAt({5.0, -0.3, -0.1}), ExactOptions());
  ASSERT_EQ(there.status, CorridorStatus::kAccepted) << there.reason;
  EXPECT_NEAR(*there.heading, RadiansFromDegrees(-8.0), 1e-9);
  EXPECT_NEAR(*there.y, -0.3, 1e-9);
  const auto nothing = EstimateCorridor(
      view, lines, BareCorridor(), std::nullopt, ExactOptions());
  EXPECT_EQ(nothing.status, CorridorStatus::kAmbiguous);
  EXPECT_FALSE(nothing.heading);
  EXPECT_TRUE(nothing.vanishing_point);
}

TEST(EstimateCorridor, MirroredLinesFlipTheSigns) {
  CorridorView view = ViewForTests(0.1);
  view.X_RC.translation().y() = 0.0;
  const double middle = view.intrinsics.cx;
  const Pose2 X_LR{0.0, 0.4, 0.2};
  LineSet lines = SeeCorridor(view, BareCorridor(), X_LR, {});
  for (LineSegment& segment : lines.segments) {
    segment.a.x() = 2.0 * middle - segment.a.x();
    segment.b.x() = 2.0 * middle - segment.b.x();
  }
  const auto estimate = EstimateCorridor(
      view, lines, BareCorridor(), PriorAt({0.0, -0.4, -0.2}), ExactOptions());
  ASSERT_EQ(estimate.status, CorridorStatus::kAccepted) << estimate.reason;
  EXPECT_NEAR(*estimate.y, -0.4, 1e-9);
  EXPECT_NEAR(*estimate.heading, -0.2, 1e-9);
}

TEST(EstimateCorridor, ErrorsAreAsLargeAsStated) {
  const CorridorView view = ViewForTests(0.1);
  CorridorTrackerOptions options = ExactOptions();
  options.pose.floor_m = 1e-6;
  options.pose.floor_rad = 1e-6;
  CorridorLinesOptions see;
  see.noise_px = 0.5;
  see.sigma_px = 0.5;
  Random random(7);
  double sum = 0.0;
  int num = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    see.seed = seed;
    const Pose2 X_LR{0.0, random.Uniform(-0.7, 0.7), random.Uniform(-0.4, 0.4)};
    const auto estimate =
        EstimateCorridor(view,
                         SeeCorridor(view, BareCorridor(), X_LR, see),
                         BareCorridor(),
                         PriorAt(X_LR),
                         options);
    if (estimate.status != CorridorStatus::kAccepted) continue;
    const Eigen::Vector2d error(*estimate.y - X_LR.y,
                                *estimate.heading - X_LR.heading);
    sum += error.dot(estimate.covariance.inverse() * error);
    ++num;
  }
  EXPECT_GT(num, 380);
  // Chi-square of 2 num degrees, five sigmas: 2 num +- 5 sqrt(4 num). Weights
  // that fall towards the gate take a little of the information away.
  EXPECT_NEAR(sum, 2.0 * num, 5.0 * std::sqrt(4.0 * num));
}

TEST(EstimateCorridor, WhatIsFarFromThePriorIsFaulty) {
  const CorridorView view = ViewForTests(0.1);
  const Pose2 X_LR{0.0, 0.3, 0.1};
  const LineSet lines = SeeCorridor(view, BareCorridor(), X_LR, {});
  CorridorPrior prior = PriorAt({0.0, -0.3, 0.1});
  prior.covariance = 1e-4 * Eigen::Matrix3d::Identity();
  const auto estimate =
      EstimateCorridor(view, lines, BareCorridor(), prior, ExactOptions());
  EXPECT_EQ(estimate.status, CorridorStatus::kFaulty);
  EXPECT_LT(estimate.p_regular, 0.01);
  ASSERT_TRUE(estimate.y);
  EXPECT_NEAR(*estimate.y, 0.3, 1e-9);
}

TEST(EstimateCorridor, UnknownSizeLeavesTheHeading) {
  const CorridorView view = ViewForTests(0.1);
  const Pose2 X_LR{0.0, 0.3, 0.1};
  CorridorGeometry corridor = Corridor();
  corridor.width.reset();
  corridor.height.reset();
  const auto estimate =
      EstimateCorridor(view,
                       SeeCorridor(view, Corridor(), X_LR, {}),
                       corridor,
                       PriorAt(X_LR),
                       ExactOptions());
  EXPECT_EQ(estimate.status, CorridorStatus::kUnknownSize);
  EXPECT_FALSE(estimate.y);
  EXPECT_NEAR(*estimate.heading, 0.1, 1e-9);
  EXPECT_GT(estimate.covariance(1, 1), 0.0);
}

TEST(EstimateCorridor, AHeadingAloneIsTestedToo) {
  const CorridorView view = ViewForTests(0.1);
  CorridorGeometry corridor = Corridor();
  corridor.width.reset();
  corridor.height.reset();
  CorridorLinesOptions see;
  see.has_clutter = true;
  const auto estimate = EstimateCorridor(
      view,
      SeeCorridor(view, Corridor(), {0.0, 0.3, 0.5}, see),
      corridor,
      CorridorPrior{Pose2{0.0, 0.3, 0.0},
                    Eigen::Vector3d(0.04, 0.09, 1e-4).asDiagonal()},
      ExactOptions());
  EXPECT_EQ(estimate.status, CorridorStatus::kFaulty);
  EXPECT_NEAR(*estimate.heading, 0.5, 1e-9);
  EXPECT_LT(estimate.p_regular, 0.01);
}

TEST(EstimateCorridor, APriorThatIsNoHeadingChoosesNone) {
  const CorridorView view = ViewForTests(0.1);
  for (const CorridorMethod method :
       {CorridorMethod::kJoint, CorridorMethod::kPaper}) {
    CorridorTrackerOptions options = ExactOptions();
    options.method = method;
    for (const double heading : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      const auto estimate =
          EstimateCorridor(view,
                           SeeCorridor(view, Corridor(), {0.0, 0.3, 0.1}, {}),
                           Corridor(),
                           PriorAt({0.0, 0.3, heading}),
                           options);
      EXPECT_EQ(estimate.status, CorridorStatus::kAmbiguous);
      EXPECT_FALSE(estimate.heading);
    }
  }
}

TEST(EstimateCorridor, WithoutLinesItSaysSo) {
  const CorridorView view = ViewForTests(0.1);
  const auto none = EstimateCorridor(
      view, {}, Corridor(), PriorAt({0.0, 0.0, 0.0}), ExactOptions());
  EXPECT_EQ(none.status, CorridorStatus::kNoLines);
  EXPECT_FALSE(none.reason.empty());
  // Lines at random are no corridor.
  Random random(3);
  LineSet lines;
  for (int i = 0; i < 12; ++i) {
    LineSegment segment;
    segment.a = {random.Uniform(0.0, 639.0), random.Uniform(0.0, 479.0)};
    segment.b = {random.Uniform(0.0, 639.0), random.Uniform(0.0, 479.0)};
    segment.sigma_px = 0.3;
    segment.sigma_rad = 0.003;
    lines.segments.push_back(segment);
  }
  const auto random_lines =
      EstimateCorridor(view, lines, Corridor(), PriorAt({0.0, 0.0, 0.0}), {});
  EXPECT_FALSE(random_lines.y);
  EXPECT_NE(random_lines.status, CorridorStatus::kAccepted);
}

// What stands out from the wall hides its foot, on both sides alike.
TEST(CorridorView, FloorEndsAtSkirtingBoard) {
  CorridorGeometry corridor = Corridor();
  const auto y_of = [&](CorridorEdge edge) {
    return PlaceOf(edge, corridor).value().x();
  };
  const double wall = y_of(CorridorEdge::kSkirtingLeft);
  EXPECT_EQ(y_of(CorridorEdge::kFloorLeft), wall);
  corridor.skirting_depth = 0.02;
  EXPECT_DOUBLE_EQ(y_of(CorridorEdge::kFloorLeft), wall - 0.02);
  EXPECT_DOUBLE_EQ(y_of(CorridorEdge::kFloorRight), 0.02 - wall);
  EXPECT_EQ(y_of(CorridorEdge::kSkirtingLeft), wall);
  corridor.skirting_height.reset();
  EXPECT_EQ(y_of(CorridorEdge::kFloorLeft), wall);
}

}  // namespace
}  // namespace waymark
