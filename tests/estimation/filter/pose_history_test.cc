#include "estimation/filter/pose_history.h"

#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace waymark {
namespace {

constexpr Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

Time At(double seconds) {
  return kStart + DurationFromSeconds(seconds);
}

// On a circle of radius 2 m, 0.5 m/s, to the left.
PoseEstimate OnCircle(double seconds) {
  PoseEstimate estimate;
  estimate.time = At(seconds);
  estimate.is_known = true;
  const double angle = 0.25 * seconds;
  estimate.X_WR = {
      2.0 * std::sin(angle), 2.0 - 2.0 * std::cos(angle), WrapAngle(angle)};
  estimate.covariance = (1e-4 + 1e-4 * seconds) * Eigen::Matrix3d::Identity();
  estimate.forward_speed = 0.5;
  estimate.turn_rate = 0.25;
  return estimate;
}

TEST(PoseHistory, BetweenAndAheadAreOnTheWay) {
  PoseHistory history;
  // Past half a turn the heading wraps.
  for (int i = 0; i <= 200; ++i) history.Add(OnCircle(10.0 + 0.02 * i));
  for (const double t : {10.013, 12.0, 12.5631, 13.999, 14.0, 14.1, 14.3}) {
    const auto estimate = history.At(At(t));
    ASSERT_TRUE(estimate) << t;
    const PoseEstimate truth = OnCircle(t);
    EXPECT_EQ(estimate->time, truth.time);
    // Sagitta of 1 cm of way: v^2 t^2 / 8 r = 6 um; a chord for an arc: 1e-5.
    EXPECT_NEAR(
        (estimate->X_WR.position() - truth.X_WR.position()).norm(), 0.0, 5e-5)
        << t;
    EXPECT_NEAR(
        WrapAngle(estimate->X_WR.heading - truth.X_WR.heading), 0.0, 1e-9);
  }
  EXPECT_NEAR(history.At(At(12.01))->covariance(0, 0), 1e-4 + 12.01e-4, 1e-9);
  EXPECT_GT(history.At(At(14.3))->covariance(0, 0),
            history.At(At(14.0))->covariance(0, 0) + 1e-3);
}

TEST(PoseHistory, HasNoAnswerBeyondItsEnds) {
  PoseHistory history({.length_s = 1.0});
  EXPECT_FALSE(history.At(At(1.0)));
  for (int i = 0; i <= 100; ++i) history.Add(OnCircle(0.02 * i));
  EXPECT_FALSE(history.At(At(0.99)));
  EXPECT_TRUE(history.At(At(1.01)));
  EXPECT_TRUE(history.At(At(2.29)));
  EXPECT_FALSE(history.At(At(2.31)));
}

TEST(PoseHistory, StartsAnewWhereTheFilterDoes) {
  PoseHistory history;
  for (int i = 0; i <= 10; ++i) history.Add(OnCircle(0.02 * i));
  PoseEstimate none;
  none.time = At(0.22);
  history.Add(none);
  EXPECT_FALSE(history.At(At(0.1)));
  history.Add(OnCircle(0.3));
  EXPECT_FALSE(history.At(At(0.29)));
  EXPECT_TRUE(history.At(At(0.3)));
  history.Add(OnCircle(0.1));  // Time went back.
  EXPECT_FALSE(history.At(At(0.05)));
  EXPECT_TRUE(history.At(At(0.1)));
  EXPECT_NEAR(history.At(At(0.3))->X_WR.x, OnCircle(0.3).X_WR.x, 1e-4);
}

TEST(PoseHistory, RefusesImpossibleOptions) {
  EXPECT_THROW(PoseHistory({.length_s = -1.0}), std::invalid_argument);
  EXPECT_THROW(
      PoseHistory({.acceleration = std::numeric_limits<double>::quiet_NaN()}),
      std::invalid_argument);
}

}  // namespace
}  // namespace waymark
