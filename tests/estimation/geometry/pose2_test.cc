#include "estimation/geometry/pose2.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

constexpr double kTight = 1e-12;  // A few roundings of values near 1.

Pose2 RandomPose(Random* random) {
  return {random->Uniform(-5, 5),
          random->Uniform(-5, 5),
          WrapAngle(random->Uniform(-10, 10))};
}

TEST(WrapAngle, StaysInHalfOpenIntervalAndKeepsTheDirection) {
  for (int i = -4000; i <= 4000; ++i) {
    const double angle = 0.01 * i;
    const double wrapped = WrapAngle(angle);
    EXPECT_GT(wrapped, -kPi);
    EXPECT_LE(wrapped, kPi);
    EXPECT_NEAR(std::sin(wrapped), std::sin(angle), kTight);
    EXPECT_NEAR(std::cos(wrapped), std::cos(angle), kTight);
  }
  EXPECT_EQ(WrapAngle(kPi), kPi);
  EXPECT_EQ(WrapAngle(-kPi), kPi);
  EXPECT_TRUE(std::isnan(WrapAngle(std::nan(""))));
}

TEST(Pose2, ComposeWithInverseIsIdentity) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Pose2 X_AB = RandomPose(&random);
    const Pose2 identity = X_AB * Inverse(X_AB);
    EXPECT_NEAR(identity.x, 0, kTight);
    EXPECT_NEAR(identity.y, 0, kTight);
    EXPECT_NEAR(identity.heading, 0, kTight);
  }
}

TEST(Pose2, BetweenUndoesCompose) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Pose2 X_AB = RandomPose(&random);
    const Pose2 X_BC = RandomPose(&random);
    const Pose2 back = Between(X_AB, X_AB * X_BC);
    EXPECT_NEAR(back.x, X_BC.x, kTight);
    EXPECT_NEAR(back.y, X_BC.y, kTight);
    EXPECT_NEAR(WrapAngle(back.heading - X_BC.heading), 0, kTight);
  }
}

TEST(Pose2, QuarterTurnToTheLeftMapsForwardToLeft) {
  const Pose2 X_AB{1, 2, kPi / 2};
  const Eigen::Vector2d p_AQ = X_AB * Eigen::Vector2d(3, 0);
  EXPECT_NEAR(p_AQ.x(), 1, kTight);
  EXPECT_NEAR(p_AQ.y(), 5, kTight);
}

// Derivative of function(step) at 0, whose last value is an angle, by central
// differences: error step^2 * value, plus rounding / step.
constexpr double kDerivative = 1e-8;
template <typename Function>
Eigen::Vector3d DerivativeOf(const Function& function) {
  constexpr double kStep = 1e-6;
  Eigen::Vector3d d = function(kStep).vector() - function(-kStep).vector();
  d.z() = WrapAngle(d.z());
  return d / (2 * kStep);
}

// X with its k-th value changed.
Pose2 Changed(const Pose2& X, int k, double step) {
  return Pose2::FromVector(X.vector() + step * Eigen::Vector3d::Unit(k));
}

TEST(Pose2, JacobiansOfComposeMatchDifferences) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Pose2 X_AB = RandomPose(&random);
    const Pose2 X_BC = RandomPose(&random);
    const ComposeJacobians jacobians = JacobiansOfCompose(X_AB, X_BC);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d_AB = DerivativeOf(
          [&](double step) { return Changed(X_AB, k, step) * X_BC; });
      const Eigen::Vector3d d_BC = DerivativeOf(
          [&](double step) { return X_AB * Changed(X_BC, k, step); });
      EXPECT_LT((d_AB - jacobians.d_AB.col(k)).norm(), kDerivative);
      EXPECT_LT((d_BC - jacobians.d_BC.col(k)).norm(), kDerivative);
    }
  }
}

TEST(Pose2, JacobiansOfBetweenMatchDifferences) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Pose2 X_AB = RandomPose(&random);
    const Pose2 X_AC = RandomPose(&random);
    const BetweenJacobians jacobians = JacobiansOfBetween(X_AB, X_AC);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d_AB = DerivativeOf(
          [&](double step) { return Between(Changed(X_AB, k, step), X_AC); });
      const Eigen::Vector3d d_AC = DerivativeOf(
          [&](double step) { return Between(X_AB, Changed(X_AC, k, step)); });
      EXPECT_LT((d_AB - jacobians.d_AB.col(k)).norm(), kDerivative);
      EXPECT_LT((d_AC - jacobians.d_AC.col(k)).norm(), kDerivative);
    }
  }
}

}  // namespace
}  // namespace waymark
