#include "drivers/wheels/differential_base.h"

#include "estimation/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace waymark {
namespace {

Time At(double seconds) {
  return TimeFromMicroseconds(1'700'000'000'000'000) +
         DurationFromSeconds(seconds);
}

constexpr BaseSensors kFree{};
constexpr BaseSensors kBump{.is_bumper_left = true};
constexpr BaseSensors kLifted{.must_stop = true};

TEST(DifferentialBase, LeftTurnsRunTheRightWheelFaster) {
  const DifferentialBaseOptions options;
  const WheelSpeeds ahead = WheelSpeedsOf(0.2, 0.0, options);
  EXPECT_EQ(ahead, (WheelSpeeds{0.2, 0.2}));
  const WheelSpeeds left = WheelSpeedsOf(0.2, 0.5, options);
  EXPECT_DOUBLE_EQ(left.right - left.left, 0.5 * options.wheel_base);
  EXPECT_DOUBLE_EQ((left.right + left.left) / 2.0, 0.2);
}

TEST(DifferentialBase, SaturationKeepsTheCurvature) {
  const DifferentialBaseOptions options;
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double forward = random.Uniform(-3.0, 3.0);
    const double turn_rate = random.Uniform(-10.0, 10.0);
    const WheelSpeeds speeds = WheelSpeedsOf(forward, turn_rate, options);
    EXPECT_LE(std::max(std::abs(speeds.right), std::abs(speeds.left)),
              options.max_wheel_speed * (1.0 + 1e-15));
    const double v = (speeds.right + speeds.left) / 2.0;
    const double w = (speeds.right - speeds.left) / options.wheel_base;
    // Same curvature, same sense: (v, w) is a positive share of what was asked
    // for; rounding of numbers up to 10.
    EXPECT_NEAR(v * turn_rate, w * forward, 1e-13);
    EXPECT_GE(v * forward + w * turn_rate, 0.0);
  }
}

TEST(DifferentialBase, CommandsWearOut) {
  DifferentialBase base(DifferentialBaseOptions{});
  EXPECT_FALSE(base.is_command_current());
  EXPECT_EQ(base.Speeds(At(0.0)), WheelSpeeds{});
  base.Command(At(1.0), 0.2, 0.0);
  EXPECT_EQ(base.Speeds(At(1.399)), (WheelSpeeds{0.2, 0.2}));
  // At 2 m/s^2 it has 0.1 s to stand in time, on the same curve.
  EXPECT_NEAR(base.Speeds(At(1.45)).right, 0.1, 1e-12);
  EXPECT_NEAR(base.Speeds(At(1.45)).left, 0.1, 1e-12);
  EXPECT_TRUE(base.is_command_current());
  EXPECT_EQ(base.Speeds(At(1.5)), WheelSpeeds{});
  EXPECT_FALSE(base.is_command_current());
  EXPECT_EQ(base.Speeds(At(9.0)), WheelSpeeds{});
  EXPECT_EQ(base.num_timeouts(), 1);
  // Who was told to stand is not late.
  base.Command(At(10.0), 0.0, 0.0);
  EXPECT_EQ(base.Speeds(At(11.0)), WheelSpeeds{});
  EXPECT_EQ(base.num_timeouts(), 1);
  // A late renewal counts, and is obeyed.
  base.Command(At(12.0), 0.1, 0.0);
  base.Command(At(13.0), 0.1, 0.0);
  EXPECT_EQ(base.num_timeouts(), 2);
  EXPECT_EQ(base.Speeds(At(13.1)), (WheelSpeeds{0.1, 0.1}));
}

TEST(DifferentialBase, BumperStopsForwardMotionUntilNoneIsAskedFor) {
  DifferentialBase base(DifferentialBaseOptions{});
  base.Command(At(0.0), 0.2, 0.4);
  base.Sense(kBump);
  const WheelSpeeds turning = WheelSpeedsOf(0.0, 0.4, {});
  EXPECT_EQ(base.Speeds(At(0.1)), turning);
  EXPECT_EQ(base.hold(), BaseHold::kBumper);
  // It bounces off, and does not run into it again.
  base.Sense(kFree);
  EXPECT_EQ(base.Speeds(At(0.2)), turning);
  base.Command(At(0.3), 0.2, 0.0);
  EXPECT_EQ(base.Speeds(At(0.3)), WheelSpeeds{});
  base.Command(At(0.4), -0.1, 0.0);
  EXPECT_EQ(base.Speeds(At(0.4)), (WheelSpeeds{-0.1, -0.1}));
  base.Command(At(0.5), 0.2, 0.0);
  EXPECT_EQ(base.Speeds(At(0.5)), (WheelSpeeds{0.2, 0.2}));
  EXPECT_EQ(base.hold(), BaseHold::kNone);
  EXPECT_EQ(base.num_contacts(), 1);
}

TEST(DifferentialBase, PressedBumperHoldsWhateverIsAskedFor) {
  DifferentialBase base(DifferentialBaseOptions{});
  base.Sense({.is_bumper_right = true});
  base.Command(At(0.0), -0.1, 0.0);
  EXPECT_EQ(base.Speeds(At(0.0)), (WheelSpeeds{-0.1, -0.1}));
  base.Command(At(0.1), 0.1, 0.0);
  EXPECT_EQ(base.Speeds(At(0.1)), WheelSpeeds{});
  // Still the same contact.
  base.Sense({.is_bumper_left = true, .is_bumper_right = true});
  EXPECT_EQ(base.num_contacts(), 1);
  base.Sense(kFree);
  base.Sense(kBump);
  EXPECT_EQ(base.num_contacts(), 2);
}

TEST(DifferentialBase, AfterAStopMotionWaitsForACommandToStand) {
  DifferentialBase base(DifferentialBaseOptions{});
  base.Command(At(0.0), 0.2, 0.0);
  base.Sense(kLifted);
  EXPECT_EQ(base.Speeds(At(0.1)), WheelSpeeds{});
  EXPECT_EQ(base.hold(), BaseHold::kStopped);
  // Put down while the driver still asks for motion, backwards even.
  base.Sense(kFree);
  for (const double forward : {0.2, -0.2}) {
    base.Command(At(0.2), forward, 0.1);
    EXPECT_EQ(base.Speeds(At(0.2)), WheelSpeeds{});
  }
  base.Command(At(0.3), 0.0, 0.0);
  base.Command(At(0.4), 0.2, 0.0);
  EXPECT_EQ(base.Speeds(At(0.4)), (WheelSpeeds{0.2, 0.2}));
  // Silence for the time-out serves as well.
  base.Sense(kLifted);
  base.Sense(kFree);
  EXPECT_EQ(base.Speeds(At(0.5)), WheelSpeeds{});
  EXPECT_EQ(base.Speeds(At(1.0)), WheelSpeeds{});
  base.Command(At(1.1), 0.2, 0.0);
  EXPECT_EQ(base.Speeds(At(1.1)), (WheelSpeeds{0.2, 0.2}));
}

// From the first moment on: it could not brake before the time-out else.
TEST(DifferentialBase, AShortTimeOutLimitsFreshCommandsOnTheSameCurve) {
  DifferentialBase base(
      {.command_timeout_s = 0.1, .max_wheel_acceleration = 2.0});
  base.Command(At(0.0), 0.5, 0.0);
  EXPECT_NEAR(base.Speeds(At(0.0)).right, 0.2, 1e-12);
  EXPECT_NEAR(base.Speeds(At(0.05)).right, 0.1, 1e-12);
  base.Command(At(0.05), 0.25, 1.0);
  const WheelSpeeds speeds = base.Speeds(At(0.05));
  EXPECT_NEAR(speeds.right, 0.2, 1e-12);
  EXPECT_NEAR((speeds.right - speeds.left) / (speeds.right + speeds.left),
              0.235 * 1.0 / (2.0 * 0.25),
              1e-12);
}

TEST(DifferentialBase, NonsenseIsRefused) {
  DifferentialBase base(DifferentialBaseOptions{});
  EXPECT_THROW(base.Command(At(0), std::numeric_limits<double>::quiet_NaN(), 0),
               std::logic_error);
  EXPECT_THROW(base.Command(At(0), 0, std::numeric_limits<double>::infinity()),
               std::logic_error);
  EXPECT_THROW(DifferentialBase({.wheel_base = 0.0}), std::invalid_argument);
  EXPECT_THROW(DifferentialBase({.max_wheel_speed = -1.0}),
               std::invalid_argument);
  EXPECT_THROW(DifferentialBase({.command_timeout_s = 0.0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace waymark
