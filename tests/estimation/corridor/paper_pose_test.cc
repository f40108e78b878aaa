#include "estimation/corridor/paper_pose.h"

#include "estimation/corridor/corridor_tracker.h"
#include "estimation/geometry/angle.h"
#include "tests/support/corridor_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

namespace waymark {
namespace {

CorridorGeometry Corridor() {
  CorridorGeometry corridor;
  corridor.width = 2.0;
  corridor.height = 2.5;
  corridor.x_min = 0.0;
  corridor.x_max = 20.0;
  return corridor;
}

CorridorPrior PriorAt(const Pose2& X_LR) {
  return {X_LR, Eigen::Vector3d(0.04, 0.09, 0.01).asDiagonal()};
}

CorridorEstimate Estimate(const CorridorView& view,
                          const LineSet& lines,
                          const std::optional<CorridorPrior>& prior,
                          const CorridorGeometry& corridor = Corridor()) {
  CorridorTrackerOptions options;
  options.method = CorridorMethod::kPaper;
  options.model_px = 0.0;
  options.model_rad = 0.0;
  return EstimateCorridor(view, lines, corridor, prior, options);
}

TEST(PaperPose, ExactLinesGiveExactPoses) {
  for (const double tilt_deg : {-8.0, 0.0, 12.0}) {
    for (const double yaw_deg : {0.0, 15.0}) {
      const CorridorView view = ViewForTests(RadiansFromDegrees(tilt_deg),
                                             RadiansFromDegrees(yaw_deg));
      for (const double heading_deg : {-25.0, -8.0, 0.0, 3.0, 17.0, 25.0}) {
        for (const double y : {-0.6, -0.1, 0.0, 0.35, 0.7}) {
          const Pose2 X_LR{0.0, y, RadiansFromDegrees(heading_deg - yaw_deg)};
          const auto estimate =
              Estimate(view,
                       SeeCorridor(view, Corridor(), X_LR, {}),
                       PriorAt({0.0, y + 0.1, X_LR.heading - 0.05}));
          ASSERT_EQ(estimate.status, CorridorStatus::kAccepted)
              << estimate.reason << " " << tilt_deg << " " << yaw_deg << " "
              << heading_deg << " " << y;
          EXPECT_NEAR(*estimate.y, y, 1e-9);
          EXPECT_NEAR(*estimate.heading, X_LR.heading, 1e-9);
        }
      }
    }
  }
}

TEST(PaperPose, MirroredLinesFlipTheSigns) {
  CorridorView view = ViewForTests(0.1);
  view.X_RC.translation().y() = 0.0;
  const double middle = view.intrinsics.cx;
  LineSet lines = SeeCorridor(view, Corridor(), {0.0, 0.4, 0.2}, {});
  for (LineSegment& segment : lines.segments) {
    segment.a.x() = 2.0 * middle - segment.a.x();
    segment.b.x() = 2.0 * middle - segment.b.x();
  }
  const auto estimate = Estimate(view, lines, PriorAt({0.0, -0.4, -0.2}));
  ASSERT_EQ(estimate.status, CorridorStatus::kAccepted) << estimate.reason;
  EXPECT_NEAR(*estimate.y, -0.4, 1e-9);
  EXPECT_NEAR(*estimate.heading, -0.2, 1e-9);
}

TEST(PaperPose, ThePriorChoosesTheDirection) {
  const CorridorView view = ViewForTests(0.1);
  const Pose2 X_LR{20.0, 0.3, RadiansFromDegrees(172.0)};
  const LineSet lines = SeeCorridor(view, Corridor(), X_LR, {});
  const auto back = Estimate(view, lines, PriorAt(X_LR));
  ASSERT_EQ(back.status, CorridorStatus::kAccepted) << back.reason;
  EXPECT_NEAR(*back.heading, X_LR.heading, 1e-9);
  EXPECT_NEAR(*back.y, 0.3, 1e-9);
  const auto there = Estimate(view, lines, PriorAt({5.0, -0.3, -0.1}));
  ASSERT_EQ(there.status, CorridorStatus::kAccepted) << there.reason;
  EXPECT_NEAR(*there.heading, RadiansFromDegrees(-8.0), 1e-9);
  EXPECT_NEAR(*there.y, -0.3, 1e-9);
  const auto nothing = Estimate(view, lines, std::nullopt);
  EXPECT_EQ(nothing.status, CorridorStatus::kAmbiguous);
  EXPECT_FALSE(nothing.heading);
  EXPECT_TRUE(nothing.vanishing_point);
}

// The lines of tiles, lamps and pictures make candidates, and are taken away.
TEST(PaperPose, EliminatedLinesAreNotUsed) {
  const CorridorView view = ViewForTests(0.1);
  const Pose2 X_LR{0.0, 0.1, 0.1};
  CorridorLinesOptions see;
  see.has_clutter = true;
  const auto estimate =
      Estimate(view, SeeCorridor(view, Corridor(), X_LR, see), PriorAt(X_LR));
  const auto is_used = [](const CorridorLine& line) { return line.is_used; };
  const auto is_along = [](const CorridorLine& line) {
    return line.edge == CorridorEdge::kAlong;
  };
  EXPECT_EQ(
      std::count_if(estimate.lines.begin(), estimate.lines.end(), is_used),
      LateralConsensusOptions().num_kept);
  EXPECT_GT(
      std::count_if(estimate.lines.begin(), estimate.lines.end(), is_along), 0);
}

// Constant errors, whatever the lines' own.
TEST(PaperPose, ErrorsAreThePublishedOnes) {
  const CorridorView view = ViewForTests(0.1);
  const Pose2 X_LR{0.0, 0.3, 0.1};
  const auto estimate =
      Estimate(view, SeeCorridor(view, Corridor(), X_LR, {}), PriorAt(X_LR));
  ASSERT_EQ(estimate.status, CorridorStatus::kAccepted) << estimate.reason;
  EXPECT_DOUBLE_EQ(estimate.covariance(0, 0), 0.03 * 0.03);
  EXPECT_DOUBLE_EQ(estimate.covariance(1, 1), 0.01 * 0.01);
  EXPECT_EQ(estimate.covariance(0, 1), 0.0);
}

TEST(PaperPose, WhatIsFarFromThePriorIsFaulty) {
  const CorridorView view = ViewForTests(0.1);
  CorridorPrior prior = PriorAt({0.0, -0.3, 0.1});
  prior.covariance = 1e-4 * Eigen::Matrix3d::Identity();
  const auto estimate =
      Estimate(view, SeeCorridor(view, Corridor(), {0.0, 0.3, 0.1}, {}), prior);
  EXPECT_EQ(estimate.status, CorridorStatus::kFaulty);
  EXPECT_LT(estimate.p_regular, 0.01);
  EXPECT_NEAR(estimate.y.value_or(9.0), 0.3, 1e-9);
}

TEST(PaperPose, WithoutPositionTheHeadingStays) {
  const CorridorView view = ViewForTests(0.1);
  const Pose2 X_LR{0.0, 0.3, 0.1};
  LineSet lines = SeeCorridor(view, Corridor(), X_LR, {});
  CorridorGeometry corridor = Corridor();
  corridor.width.reset();
  auto estimate = Estimate(view, lines, PriorAt(X_LR), corridor);
  EXPECT_EQ(estimate.status, CorridorStatus::kUnknownSize);
  EXPECT_FALSE(estimate.y);
  EXPECT_NEAR(estimate.heading.value_or(9.0), 0.1, 1e-9);
  EXPECT_DOUBLE_EQ(estimate.covariance(1, 1), 0.01 * 0.01);
  // The left wall's edges come first.
  lines.segments.resize(2);
  estimate = Estimate(view, lines, PriorAt(X_LR));
  EXPECT_EQ(estimate.status, CorridorStatus::kNoPosition) << estimate.reason;
  EXPECT_FALSE(estimate.y);
  EXPECT_NEAR(estimate.heading.value_or(9.0), 0.1, 1e-9);
  EXPECT_FALSE(estimate.reason.empty());
}

TEST(PaperPose, TooFewLinesSaySo) {
  const CorridorView view = ViewForTests(0.1);
  const Pose2 X_LR{0.0, 0.3, 0.1};
  auto estimate = Estimate(view, {}, PriorAt(X_LR));
  EXPECT_EQ(estimate.status, CorridorStatus::kNoLines);
  LineSet one = SeeCorridor(view, Corridor(), X_LR, {});
  one.segments.resize(1);
  estimate = Estimate(view, one, PriorAt(X_LR));
  EXPECT_EQ(estimate.status, CorridorStatus::kNoVanishingPoint);
  EXPECT_FALSE(estimate.heading);
  EXPECT_FALSE(estimate.y);
}

TEST(PaperPose, OptionsAreChecked) {
  PaperPoseOptions options;
  EXPECT_NO_THROW(options.Check());
  options.sigma_m = 0.0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.min_lines = 1;
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.classification.max_sigmas = -1.0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace waymark
