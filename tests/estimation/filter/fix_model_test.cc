#include "estimation/filter/fix_model.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace waymark {
namespace {

AbsoluteFix FullFix() {
  AbsoluteFix fix;
  fix.has = {true, true, true};
  fix.covariance = Eigen::Vector3d(9e-4, 4e-4, 1e-4).asDiagonal();
  return fix;
}

// By hand: F lies at (2, 1), its x axis along the world's y; the robot stands
// at (1, 3) and looks along the world's -x; the sensor is 0.5 m before it and
// 0.25 m to its left, and looks to its right.
TEST(PredictFix, IsWhatOneReadsOffADrawing) {
  AbsoluteFix fix = FullFix();
  fix.X_WF = {2.0, 1.0, kPi / 2};
  fix.X_RS = {0.5, 0.25, -kPi / 2};
  const Pose2 X_WR{1.0, 3.0, kPi};
  // The sensor is at (0.5, 2.75) and looks along the world's y, F's x.
  fix.value = {1.75 + 0.1, 1.5 - 0.2, 0.3};
  const FixPrediction prediction = PredictFix(fix, X_WR);
  ASSERT_EQ(prediction.residual.size(), 3);
  // Measured minus expected. Rounding only, as in all tests here.
  EXPECT_NEAR(prediction.residual(0), 0.1, 1e-14);
  EXPECT_NEAR(prediction.residual(1), -0.2, 1e-14);
  EXPECT_NEAR(prediction.residual(2), 0.3, 1e-14);
  // The robot's way along the world's x is F's -y; a left turn moves the
  // sensor, which is at (-0.5, -0.25) from the robot, along (0.25, -0.5).
  Eigen::Matrix3d d_pose;
  d_pose << 0, 1, -0.5, -1, 0, -0.25, 0, 0, 1;
  EXPECT_LT((prediction.d_pose - d_pose).norm(), 1e-14);
  EXPECT_EQ(prediction.covariance, fix.covariance);
}

TEST(PredictFix, JacobianMatchesDifferencesInAnyFrame) {
  Random random(7);
  const auto draw = [&] {
    return Pose2{random.Uniform(-3, 3),
                 random.Uniform(-3, 3),
                 random.Uniform(-kPi, kPi)};
  };
  for (int i = 0; i < 200; ++i) {
    AbsoluteFix fix = FullFix();
    fix.X_WF = draw();
    fix.X_RS = draw();
    const Pose2 X_WR = draw();
    // Measured exactly here, so no residual, wherever the frames are.
    fix.value = (Inverse(fix.X_WF) * X_WR * fix.X_RS).vector();
    const FixPrediction prediction = PredictFix(fix, X_WR);
    EXPECT_LT(prediction.residual.norm(), 1e-12);
    for (int k = 0; k < 3; ++k) {
      constexpr double kStep = 1e-6;
      Eigen::Vector3d d = Eigen::Vector3d::Zero();
      d(k) = kStep;
      const FixVector numeric =
          -(PredictFix(fix, Pose2::FromVector(X_WR.vector() + d)).residual -
            PredictFix(fix, Pose2::FromVector(X_WR.vector() - d)).residual) /
          (2 * kStep);
      EXPECT_LT((numeric - prediction.d_pose.col(k)).norm(), 1e-8);
    }
  }
}

// Across +-pi the error of a heading is the short way round.
TEST(PredictFix, HeadingResidualIsWrapped) {
  AbsoluteFix fix = FullFix();
  fix.value(2) = kPi - 0.01;
  EXPECT_NEAR(PredictFix(fix, {0, 0, -kPi + 0.02}).residual(2), -0.03, 1e-14);
  fix.value(2) = -kPi + 0.02;
  EXPECT_NEAR(PredictFix(fix, {0, 0, kPi - 0.01}).residual(2), 0.03, 1e-14);
  // A message may count whole turns.
  fix.value(2) = 0.1 + 4 * kPi;
  EXPECT_NEAR(PredictFix(fix, {}).residual(2), 0.1, 1e-14);
}

// All seven choices, with what is absent not even a number.
TEST(PredictFix, PartsAreRowsOfTheWhole) {
  AbsoluteFix fix = FullFix();
  fix.value = {1, 2, 0.5};
  fix.X_WF = {0.4, -0.2, 1.1};
  fix.X_RS = {0.3, 0.1, 0};
  fix.covariance << 9e-4, 1e-4, 2e-5, 1e-4, 4e-4, 3e-5, 2e-5, 3e-5, 1e-4;
  const Pose2 X_WR{0.2, 0.1, 0.4};
  const FixPrediction whole = PredictFix(fix, X_WR);
  for (int choice = 1; choice < 8; ++choice) {
    AbsoluteFix part = fix;
    std::array<int, 3> index{};
    std::size_t n = 0;
    for (int i = 0; i < 3; ++i) {
      const bool has = (choice >> i & 1) != 0;
      part.has[static_cast<std::size_t>(i)] = has;
      if (has) {
        index[n++] = i;
        continue;
      }
      part.value(i) = std::numeric_limits<double>::quiet_NaN();
      part.covariance.row(i).setConstant(part.value(i));
      part.covariance.col(i).setConstant(part.value(i));
    }
    const FixPrediction prediction = PredictFix(part, X_WR);
    ASSERT_EQ(prediction.residual.size(), static_cast<Eigen::Index>(n));
    for (std::size_t i = 0; i < n; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      EXPECT_EQ(prediction.residual(row), whole.residual(index[i])) << choice;
      EXPECT_EQ(prediction.d_pose.row(row), whole.d_pose.row(index[i]));
      for (std::size_t k = 0; k < n; ++k) {
        EXPECT_EQ(prediction.covariance(row, static_cast<Eigen::Index>(k)),
                  whole.covariance(index[i], index[k]))
            << choice;
      }
    }
  }
}

}  // namespace
}  // namespace waymark
