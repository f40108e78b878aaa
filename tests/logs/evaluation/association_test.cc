#include "logs/evaluation/association.h"

#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

EstimatedPose At(double seconds, const Pose2& X_WR) {
  return {Time(DurationFromSeconds(seconds)), X_WR, std::nullopt};
}
TruthSample TruthAt(double seconds) {
  TruthSample sample;
  sample.time = Time(DurationFromSeconds(seconds));
  return sample;
}

TEST(Associate, InterpolatesLinearlyAndTurnsAlongTheShorterArc) {
  const std::vector<EstimatedPose> estimates{At(1.0, {0, 0, 3.0}),
                                             At(2.0, {4, -8, -3.0})};
  const std::vector<TruthSample> truth{TruthAt(1.25)};
  const Association a = Associate(truth, estimates, {});
  ASSERT_EQ(a.pairs.size(), 1u);
  EXPECT_DOUBLE_EQ(a.pairs[0].estimate.X_WR.x, 1.0);
  EXPECT_DOUBLE_EQ(a.pairs[0].estimate.X_WR.y, -2.0);
  // From 3.0 to -3.0 it is 2 pi - 6 forward, not 6 back.
  EXPECT_NEAR(
      a.pairs[0].estimate.X_WR.heading, 3.0 + 0.25 * (2 * kPi - 6.0), 1e-15);
}

TEST(Associate, NeverExtrapolatesNorBridgesGaps) {
  const std::vector<EstimatedPose> estimates{
      At(1.0, {}), At(1.5, {}), At(4.0, {})};
  const std::vector<TruthSample> truth{TruthAt(0.5),
                                       TruthAt(1.0),
                                       TruthAt(1.2),
                                       TruthAt(2.0),
                                       TruthAt(4.0),
                                       TruthAt(4.1)};
  const Association a = Associate(truth, estimates, {});
  EXPECT_EQ(a.pairs.size(), 3u);  // 1.0, 1.2, 4.0.
  EXPECT_EQ(a.num_outside, 2);
  EXPECT_EQ(a.num_in_gaps, 1);
}

TEST(Associate, TakesTheLastOfSeveralEstimatesAtOneTime) {
  // A filter publishes again when a measurement arrives at the same time.
  const std::vector<EstimatedPose> estimates{
      At(2.0, {7, 0, 0}), At(1.0, {1, 0, 0}), At(1.0, {2, 0, 0})};
  const std::vector<TruthSample> truth{TruthAt(1.0)};
  const Association a = Associate(truth, estimates, {});
  ASSERT_EQ(a.pairs.size(), 1u);
  EXPECT_EQ(a.pairs[0].estimate.X_WR.x, 2.0);
}

TEST(Associate, ComparesThePointOfTheReferenceNotTheRobot) {
  const std::vector<EstimatedPose> estimates{At(1.0, {1, 2, kPi / 2})};
  TruthSample sample = TruthAt(1.0);
  sample.p_RS = {0.5, 0.25};
  const Association a = Associate({&sample, 1}, estimates, {});
  ASSERT_EQ(a.pairs.size(), 1u);
  // Facing +y: forward is +y, left is -x.
  EXPECT_NEAR(a.pairs[0].EstimatedPoint().x(), 0.75, 1e-15);
  EXPECT_NEAR(a.pairs[0].EstimatedPoint().y(), 2.5, 1e-15);
}

TEST(Associate, ForgetsOrderOfInputAndEmptyInputGivesNothing) {
  EXPECT_TRUE(Associate({}, {}, {}).pairs.empty());
  const std::vector<TruthSample> truth{TruthAt(3.0), TruthAt(1.0)};
  EXPECT_EQ(Associate(truth, {}, {}).num_outside, 2);
  const std::vector<EstimatedPose> estimates{At(3.0, {3, 0, 0}),
                                             At(1.0, {1, 0, 0})};
  const Association a = Associate(truth, estimates, {});
  ASSERT_EQ(a.pairs.size(), 2u);
  EXPECT_EQ(a.pairs[0].estimate.X_WR.x, 1.0);
  EXPECT_EQ(a.pairs[1].estimate.X_WR.x, 3.0);
}

TEST(Associate, RejectsAnImpossibleGap) {
  EXPECT_THROW((void)Associate({}, {}, {.max_gap_s = 0.0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace waymark
