#include "logs/evaluation/corridor_evaluation.h"

#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace waymark {
namespace {

const Pose2 kCorridor{3.0, -2.0, 2.1};  // X_WL.

Pose2 RobotAt(double seconds) {
  return kCorridor * Pose2{0.5 * seconds, 0.1 * std::sin(seconds), 0.2};
}

Time At(double seconds) {
  return Time(DurationFromSeconds(100.0 + seconds));
}

// Truth 50 times a second; the reference looks at a point beside the robot.
std::vector<TruthSample> Truth() {
  std::vector<TruthSample> truth;
  for (int i = 0; i <= 500; ++i) {
    TruthSample sample;
    sample.time = At(0.02 * i);
    const Pose2 X_WR = RobotAt(0.02 * i);
    sample.p_RS = {0.3, 0.1};
    sample.p_WS = X_WR * sample.p_RS;
    sample.heading = X_WR.heading;
    truth.push_back(sample);
  }
  return truth;
}

// Every image is off by +2 cm and -1 degree; each tenth is refused.
std::vector<CorridorAnswer> Answers() {
  std::vector<CorridorAnswer> answers;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.05 + 0.09 * i;
    const Pose2 X_LR = Between(kCorridor, RobotAt(t));
    CorridorAnswer answer;
    answer.time = At(t);
    answer.corridor.emplace().X_WL = kCorridor;
    answer.estimate.status =
        i % 10 == 3 ? CorridorStatus::kFaulty : CorridorStatus::kAccepted;
    answer.estimate.y = X_LR.y + (i % 10 == 3 ? 1.0 : 0.02);
    answer.estimate.heading = X_LR.heading - RadiansFromDegrees(1.0);
    answer.estimate.covariance << 1e-4, 0, 0, 1e-4;
    answers.push_back(answer);
  }
  return answers;
}

TEST(EvaluateCorridor, SaysHowFarOffItWas) {
  std::vector<EstimatedPose> path;
  for (int i = 0; i <= 500; ++i) {
    Pose2 X_WR = RobotAt(0.02 * i);
    // 5 m along the corridor do not count, 1 cm across it does.
    const Eigen::Vector2d p = X_WR.position() + Pose2{0, 0, kCorridor.heading} *
                                                    Eigen::Vector2d(5.0, -0.01);
    X_WR.x = p.x();
    X_WR.y = p.y();
    path.push_back(
        {At(0.02 * i),
         X_WR,
         Eigen::Matrix3d(Eigen::Vector3d(1.0, 1.0, 1e-4).asDiagonal())});
  }
  const auto evaluation = EvaluateCorridor(Answers(), Truth(), path, {});
  ASSERT_TRUE(evaluation);
  EXPECT_EQ(evaluation->num, 100);
  EXPECT_EQ(evaluation->statuses.at("accepted"), 90);
  EXPECT_EQ(evaluation->statuses.at("faulty"), 10);
  EXPECT_DOUBLE_EQ(evaluation->accepted_share(), 0.9);
  EXPECT_EQ(evaluation->seen.y_m.num, 90);
  // Truth is linear between samples 2 cm apart: (0.02 s)^2 / 8 * 0.1 m.
  EXPECT_NEAR(evaluation->seen.y_m.median, 0.02, 1e-5);
  EXPECT_NEAR(evaluation->seen.y_m.max, 0.02, 1e-5);
  EXPECT_NEAR(evaluation->seen.worst_y_sigmas, 2.0, 1e-3);
  EXPECT_NEAR(
      evaluation->seen.heading_rad.median, RadiansFromDegrees(1.0), 1e-9);
  EXPECT_NEAR(evaluation->fused.y_m.rmse, 0.01, 1e-5);
  EXPECT_NEAR(evaluation->fused.worst_y_sigmas, 0.01, 1e-4);
  ASSERT_EQ(evaluation->sights.size(), 100u);
  EXPECT_NEAR(
      *evaluation->sights[3].y - *evaluation->sights[3].true_y, 1.0, 1e-5);
}

TEST(EvaluateCorridor, WithoutReferenceItCounts) {
  const auto evaluation = EvaluateCorridor(Answers(), {}, {}, {});
  ASSERT_TRUE(evaluation);
  EXPECT_EQ(evaluation->num, 100);
  EXPECT_EQ(evaluation->seen.y_m.num, 0);
  EXPECT_FALSE(evaluation->sights[0].true_y);
  EXPECT_FALSE(EvaluateCorridor({}, Truth(), {}, {}));
}

// Where there is no corridor, nothing is off.
TEST(EvaluateCorridor, OutsideNothingIsCompared) {
  std::vector<CorridorAnswer> answers = Answers();
  for (CorridorAnswer& answer : answers) {
    answer.corridor.reset();
    answer.estimate = CorridorEstimate();
    answer.estimate.status = CorridorStatus::kOutside;
  }
  const auto evaluation = EvaluateCorridor(answers, Truth(), {}, {});
  ASSERT_TRUE(evaluation);
  EXPECT_EQ(evaluation->accepted_share(), 0.0);
  EXPECT_FALSE(evaluation->sights[0].true_y);
}

}  // namespace
}  // namespace waymark
