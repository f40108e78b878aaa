#include "logs/evaluation/trajectory_error.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

AssociatedPair Pair(double seconds, const Pose2& truth, const Pose2& estimate) {
  AssociatedPair pair;
  pair.truth.time = Time(DurationFromSeconds(seconds));
  pair.truth.p_WS = truth.position();
  pair.truth.heading = truth.heading;
  pair.estimate = {pair.truth.time, estimate, std::nullopt};
  return pair;
}

// Truth: 4 m along x, one sample per metre and second. The estimate drifts
// 0.1 m to the left per metre (heading stays) and is 0.2 rad off from x = 2.
std::vector<AssociatedPair> Drifting() {
  std::vector<AssociatedPair> pairs;
  for (int i = 0; i <= 4; ++i) {
    pairs.push_back(
        Pair(i, {1.0 * i, 0, 0}, {1.0 * i, 0.1 * i, i < 2 ? 0.0 : 0.2}));
  }
  return pairs;
}

TEST(AbsoluteError, HandComputed) {
  const auto error = EvaluateAbsoluteError(Drifting(), Alignment::kNone);
  ASSERT_TRUE(error);
  // 0, 0.1, 0.2, 0.3, 0.4: squares sum to 0.30.
  EXPECT_NEAR(error->position_summary.rmse, std::sqrt(0.30 / 5), 1e-15);
  EXPECT_NEAR(error->position_summary.median, 0.2, 1e-15);
  EXPECT_NEAR(error->position_summary.max, 0.4, 1e-15);
  // 0, 0, 0.2, 0.2, 0.2.
  EXPECT_NEAR(error->heading_summary.rmse, std::sqrt(0.12 / 5), 1e-15);
  EXPECT_NEAR(error->heading[4], 0.2, 1e-15);  // Estimate minus reference.
}

TEST(AbsoluteError, Se2TakesOutTheDriftsAngle) {
  const auto error = EvaluateAbsoluteError(Drifting(), Alignment::kSe2);
  ASSERT_TRUE(error);
  // The estimate lies on a line of slope 0.1, stretched by sqrt(1.01): after
  // alignment only the stretch about the middle is left.
  const double stretch = std::sqrt(1.01) - 1.0;
  EXPECT_NEAR(error->X_WE.heading, -std::atan(0.1), 1e-12);
  EXPECT_NEAR(error->position_summary.max, 2 * stretch, 1e-12);
  EXPECT_NEAR(
      error->position_summary.rmse, stretch * std::sqrt(10.0 / 5), 1e-12);
}

// Whatever rigid motion hides the truth, alignment finds it: both signs of the
// turn, with a sensor point off the axle.
TEST(AbsoluteError, AlignmentsUndoAnyRigidMotion) {
  Random random(7);
  for (int run = 0; run < 50; ++run) {
    const Pose2 X_EW{random.Uniform(-5, 5),
                     random.Uniform(-5, 5),
                     random.Uniform(-kPi, kPi)};
    std::vector<AssociatedPair> pairs;
    for (int i = 0; i < 20; ++i) {
      const Pose2 X_WR{random.Uniform(-3, 3),
                       random.Uniform(-3, 3),
                       random.Uniform(-kPi, kPi)};
      AssociatedPair pair = Pair(i, X_WR, X_EW * X_WR);
      pair.truth.p_RS = {0.3, -0.1};
      pair.truth.p_WS = X_WR * pair.truth.p_RS;
      pairs.push_back(pair);
    }
    for (const auto alignment : {Alignment::kStart, Alignment::kSe2}) {
      const auto error = EvaluateAbsoluteError(pairs, alignment);
      ASSERT_TRUE(error);
      EXPECT_LT(error->position_summary.max, 1e-12) << NameOf(alignment);
      EXPECT_LT(error->heading_summary.max, 1e-12) << NameOf(alignment);
    }
  }
}

// No alignment near the one found is better.
TEST(AbsoluteError, Se2IsTheLeastSquaresAlignment) {
  Random random(11);
  std::vector<AssociatedPair> pairs;
  for (int i = 0; i < 30; ++i) {
    const Pose2 truth{random.Uniform(-3, 3), random.Uniform(-3, 3), 0};
    pairs.push_back(Pair(i,
                         truth,
                         Pose2{1, 2, 0.7} * Pose2{truth.x + random.Normal(0.1),
                                                  truth.y + random.Normal(0.1),
                                                  0}));
  }
  const auto best = EvaluateAbsoluteError(pairs, Alignment::kSe2);
  ASSERT_TRUE(best);
  for (const Pose2 nudge : {Pose2{1e-3, 0, 0},
                            Pose2{-1e-3, 0, 0},
                            Pose2{0, 1e-3, 0},
                            Pose2{0, -1e-3, 0},
                            Pose2{0, 0, 1e-3},
                            Pose2{0, 0, -1e-3}}) {
    std::vector<AssociatedPair> moved = pairs;
    for (auto& pair : moved) {
      pair.estimate.X_WR = nudge * best->X_WE * pair.estimate.X_WR;
    }
    const auto other = EvaluateAbsoluteError(moved, Alignment::kNone);
    EXPECT_GT(other->position_summary.rmse, best->position_summary.rmse);
  }
}

TEST(AbsoluteError, StartWithoutHeadingOnlyShifts) {
  std::vector<AssociatedPair> pairs = Drifting();
  for (auto& pair : pairs) {
    pair.truth.heading.reset();
    pair.estimate.X_WR = Pose2{3, 4, 0} * pair.estimate.X_WR;
  }
  const auto error = EvaluateAbsoluteError(pairs, Alignment::kStart);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->position[0], 0, 1e-15);
  EXPECT_NEAR(error->position[4], 0.4, 1e-12);
  EXPECT_EQ(error->heading_summary.num, 0);
  EXPECT_FALSE(EvaluateAbsoluteError({}, Alignment::kStart));
}

TEST(RelativeError, HandComputedPerMetre) {
  const RelativeError error = EvaluateRelativeError(Drifting(), {.delta = 1.0});
  // Pairs (0,1), (1,2), (2,3), (3,4). Truth moves (1, 0). The estimate moves
  // (1, 0.1) in its own axes where its heading is 0: 0.1 off; from x = 2 its
  // axes are turned by 0.2, so that it sees (1, 0.1) turned by -0.2.
  const double c = std::cos(0.2);
  const double s = std::sin(0.2);
  const double late = std::hypot(c + 0.1 * s - 1.0, -s + 0.1 * c);
  EXPECT_EQ(error.translation.num, 4);
  EXPECT_TRUE(error.has_heading);
  EXPECT_NEAR(error.translation.rmse,
              std::sqrt((2 * 0.01 + 2 * late * late) / 4),
              1e-12);
  // Rotation: only the pair (1, 2) turns, by 0.2.
  EXPECT_NEAR(error.rotation.max, 0.2, 1e-12);
  EXPECT_NEAR(error.rotation.rmse, std::sqrt(0.04 / 4), 1e-12);
}

TEST(RelativeError, HandComputedPerSecond) {
  const RelativeError error = EvaluateRelativeError(
      Drifting(), {.delta = 4.0, .unit = DeltaUnit::kSeconds});
  EXPECT_EQ(error.translation.num, 1);  // (0, 4) only.
  EXPECT_NEAR(error.translation.rmse, 0.4, 1e-12);
  EXPECT_NEAR(error.rotation.rmse, 0.2, 1e-12);
}

TEST(RelativeError, WithoutHeadingsComparesLengths) {
  std::vector<AssociatedPair> pairs = Drifting();
  for (auto& pair : pairs) pair.truth.heading.reset();
  const RelativeError error = EvaluateRelativeError(pairs, {.delta = 2.0});
  EXPECT_FALSE(error.has_heading);
  EXPECT_EQ(error.translation.num, 3);
  EXPECT_NEAR(error.translation.rmse, 2 * (std::sqrt(1.01) - 1), 1e-12);
  EXPECT_EQ(error.rotation.num, 0);
}

TEST(RelativeError, SkipsPairsOutsideTheTolerance) {
  std::vector<AssociatedPair> pairs = Drifting();
  // Samples lie 1 m apart: nothing is within 10 % of 1.5 m.
  EXPECT_EQ(EvaluateRelativeError(pairs, {.delta = 1.5}).translation.num, 0);
  EXPECT_EQ(EvaluateRelativeError({}, {.delta = 1.5}).translation.num, 0);
  EXPECT_THROW((void)EvaluateRelativeError(pairs, {.delta = 0.0}),
               std::invalid_argument);
}

// A rigid motion of the whole estimate changes no relative error.
TEST(RelativeError, IsInvariantToTheWorldsFrame) {
  std::vector<AssociatedPair> pairs = Drifting();
  const RelativeError before = EvaluateRelativeError(pairs, {});
  for (auto& pair : pairs) {
    pair.estimate.X_WR = Pose2{-3, 8, 2.5} * pair.estimate.X_WR;
  }
  const RelativeError after = EvaluateRelativeError(pairs, {});
  EXPECT_NEAR(before.translation.rmse, after.translation.rmse, 1e-12);
  EXPECT_NEAR(before.rotation.rmse, after.rotation.rmse, 1e-12);
}

}  // namespace
}  // namespace waymark
