#include "planner/control/drive_model.h"

#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

TEST(DriveModel, BrakesWithinTheDistanceOfTheFormula) {
  DriveRates rates;
  DriveState state;
  state.velocity = {0.5, 0.0};
  for (int i = 0; i < 200; ++i) state = Advance(state, {}, rates, 0.01);
  EXPECT_TRUE(state.velocity.is_zero());
  // v^2 / 2a, exact for a ramp in any steps.
  EXPECT_NEAR(state.pose.x, 0.25, 1e-9);
}

TEST(DriveModel, DoesNotDependOnTheSteps) {
  DriveRates rates;
  DriveState coarse;
  coarse.velocity = {0.3, 0.0};
  DriveState fine = coarse;
  for (int i = 0; i < 10; ++i)
    coarse = Advance(coarse, {-0.2, 0.0}, rates, 0.1);
  for (int i = 0; i < 1000; ++i) {
    fine = Advance(fine, {-0.2, 0.0}, rates, 0.001);
  }
  EXPECT_NEAR(coarse.velocity.forward, -0.2, 1e-12);
  EXPECT_NEAR(fine.velocity.forward, -0.2, 1e-12);
  // A step that ramps through 0 has one mean rate of the two.
  EXPECT_NEAR(coarse.pose.x, fine.pose.x, 0.02);
}

TEST(DriveModel, BrakingKeepsTheCurve) {
  DriveRates rates;
  DriveState state;
  state.velocity = {0.4, 0.8};  // Radius 0.5 m, to the left.
  while (!state.velocity.is_zero()) {
    state = Advance(state, {}, rates, 0.01);
    EXPECT_NEAR(std::hypot(state.pose.x, state.pose.y - 0.5), 0.5, 1e-4);
  }
  EXPECT_GT(state.pose.y, 0.0);
}

TEST(DriveModel, ArcsComposeAndTurnLeftForPositiveTurns) {
  const Pose2 X{1.0, 2.0, 0.3};
  const Pose2 whole = AlongArc(X, 1.0, 0.7);
  const Pose2 halves = AlongArc(AlongArc(X, 0.5, 0.35), 0.5, 0.35);
  EXPECT_LT((whole.vector() - halves.vector()).norm(), 1e-12);
  const Pose2 quarter = AlongArc({}, kPi / 2, kPi / 2);
  EXPECT_LT((quarter.vector() - Eigen::Vector3d(1, 1, kPi / 2)).norm(), 1e-12);
  // The two forms meet where the turn is small.
  EXPECT_LT(
      (AlongArc({}, 1.0, 2.1e-6).vector() - AlongArc({}, 1.0, 1.9e-6).vector())
          .norm(),
      1e-6);
}

TEST(DriveModel, LimitKeepsTheCurve) {
  EXPECT_EQ(Limit({0.4, -1.0}, 0.5, 1.5), (Velocity{0.4, -1.0}));
  const Velocity limited = Limit({-2.0, 3.0}, 0.5, 1.5);
  EXPECT_NEAR(limited.forward, -0.5, 1e-12);
  EXPECT_NEAR(limited.turn_rate, 0.75, 1e-12);
  EXPECT_NEAR(Limit({0.1, 6.0}, 0.5, 1.5).forward, 0.025, 1e-12);
}

}  // namespace
}  // namespace waymark
