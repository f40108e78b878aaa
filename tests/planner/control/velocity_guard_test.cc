#include "planner/control/velocity_guard.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "tests/planner/control/disc_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace waymark {
namespace {

using testing::HasSubstr;

DiscScene Wall(double x) {
  return {{}, {{{x, -5.0}, {x, 5.0}}}};
}

TEST(VelocityGuard, ChangesNothingWithoutObstacles) {
  VelocityGuard guard({});
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    guard.SetRanges(ScanOf({}, {}, 0.05 * i));
    const Velocity asked{random.Uniform(-0.5, 0.5), random.Uniform(-1.5, 1.5)};
    const AllowedVelocity allowed = guard.Allow(At(0.05 * i), asked);
    EXPECT_EQ(allowed.velocity, asked);
    EXPECT_EQ(allowed.reason, "");
  }
}

// Whatever number a driver sends for "no echo": nothing is so near.
TEST(VelocityGuard, TakesAnyLargeRangeForNothingInReach) {
  for (const double beam_width : {0.0, 1.5}) {
    for (const double range : {5.0,
                               1e3,
                               1e7,
                               1e12,
                               double{std::numeric_limits<float>::max()},
                               std::numeric_limits<double>::max()}) {
      VelocityGuardOptions options;
      options.beam_width = beam_width;
      VelocityGuard guard(options);
      RangeScan scan = ScanOf(Wall(0.45), {}, 0.0);
      for (double& r : scan.ranges) r = r < 2.0 ? r : range;
      guard.SetRanges(scan);
      // Ahead the wall counts; behind nothing is near, and that is seen.
      EXPECT_LT(guard.Allow(At(0), {0.5, 0.0}).velocity.forward, 0.45) << range;
      const AllowedVelocity back = guard.Allow(At(0), {-0.3, 0.0});
      EXPECT_EQ(back.velocity, (Velocity{-0.3, 0.0})) << range;
      EXPECT_EQ(back.reason, "") << range;
    }
  }
}

// What is left out for its distance is what no command meets: the robot has
// come a long way since the ranges, and brakes badly.
TEST(VelocityGuard, FastRobotsLookAsFarAsTheyNeedTo) {
  VelocityGuardOptions options;
  options.max_speed = 10.0;
  options.max_range_age = 1.0;
  options.rates.braking = 1.0;
  VelocityGuard guard(options);
  const Velocity fast{10.0, 0.0};
  // It has reached its speed.
  const auto see = [&](double range, double s) {
    RangeScan scan = ScanOf({}, {}, s);
    for (double& r : scan.ranges) r = range;
    guard.SetRanges(scan);
  };
  for (int i = 0; i < 40; ++i) {
    see(1000.0, 1.0 + 0.5 * i);
    EXPECT_EQ(guard.Allow(At(1.0 + 0.5 * i), fast).velocity, fast);
  }
  see(60.0, 21.0);
  EXPECT_EQ(guard.Allow(At(21.0), fast).velocity, fast);
  EXPECT_LT(guard.Allow(At(21.9), fast).velocity.forward, 9.5);
}

TEST(VelocityGuard, KeepsTheLimitsOnTheSameCurve) {
  VelocityGuardOptions options;
  options.ranges = RangeUse::kNone;
  VelocityGuard guard(options);
  const AllowedVelocity allowed = guard.Allow(At(0), {1.0, 1.0});
  EXPECT_NEAR(allowed.velocity.forward, 0.5, 1e-12);
  EXPECT_NEAR(allowed.velocity.turn_rate, 0.5, 1e-12);
  EXPECT_EQ(allowed.reason, "speed limit");
}

TEST(VelocityGuard, StopsWithoutRanges) {
  VelocityGuard guard({});
  EXPECT_TRUE(guard.Allow(At(0), {0.3, 0.5}).velocity.is_zero());
  EXPECT_EQ(guard.Allow(At(0), {0.3, 0.0}).reason, "no ranges yet");
  guard.SetRanges(ScanOf({}, {}, 1.0));
  EXPECT_EQ(guard.Allow(At(1.4), {0.3, 0.0}).velocity.forward, 0.3);
  const AllowedVelocity late = guard.Allow(At(1.7), {0.0, 0.5});
  EXPECT_TRUE(late.velocity.is_zero());
  EXPECT_EQ(late.reason, "ranges are 0.7 s old");
  // A run that starts anew does not take the ranges of the one before.
  EXPECT_EQ(guard.Allow(At(-0.5), {0.3, 0.0}).reason, "no ranges yet");
}

TEST(VelocityGuard, SlowsDownBeforeAWallAndStandsAtTheMargin) {
  const DiscScene scene = Wall(2.0);
  VelocityGuard guard({});
  DriveState state;
  double last = 0.5;
  for (int i = 0; i < 1000; ++i) {
    guard.SetRanges(ScanOf(scene, state.pose, 0.05 * i));
    const AllowedVelocity allowed = guard.Allow(At(0.05 * i), {0.5, 0.0});
    // Never faster again: nothing swings.
    EXPECT_LE(allowed.velocity.forward, last + 1e-9);
    if (allowed.velocity.forward < 0.5) {
      EXPECT_THAT(allowed.reason, HasSubstr("obstacle at"));
    }
    last = allowed.velocity.forward;
    state = Advance(state, allowed.velocity, {}, 0.05);
  }
  const double clearance = 2.0 - state.pose.x - 0.2;
  EXPECT_GE(clearance, 0.05);
  EXPECT_LT(clearance, 0.07) << "it gets there";
}

TEST(VelocityGuard, TurnsOnTheSpotAndBacksOffWhereItStands) {
  const DiscScene scene = Wall(0.23);  // Already within the margin.
  VelocityGuard guard({});
  guard.SetRanges(ScanOf(scene, {}, 0.0));
  EXPECT_EQ(guard.Allow(At(0), {0.3, 0.0}).velocity, Velocity{});
  EXPECT_EQ(guard.Allow(At(0.0), {0.0, 1.0}).velocity, (Velocity{0.0, 1.0}));
  EXPECT_EQ(guard.Allow(At(0.0), {-0.3, 0.0}).velocity, (Velocity{-0.3, 0.0}));
  // Of what is not free turning is left: it leads away.
  EXPECT_EQ(guard.Allow(At(0.0), {0.3, 1.0}).velocity, (Velocity{0.0, 1.0}));
}

TEST(VelocityGuard, LooksAlongTheCurve) {
  // A post to the left of straight ahead.
  const DiscScene scene{{{{0.5, 0.35}, 0.05}}, {}};
  const auto allowed = [&](const Velocity& asked) {
    VelocityGuard guard({});
    guard.SetRanges(ScanOf(scene, {}, 0.0));
    return guard.Allow(At(0), asked).velocity;
  };
  EXPECT_EQ(allowed({0.5, 0.0}), (Velocity{0.5, 0.0}));
  EXPECT_EQ(allowed({0.5, -0.8}), (Velocity{0.5, -0.8}));
  EXPECT_LT(allowed({0.5, 0.8}).forward, 0.48);
  const Velocity slowed = allowed({0.5, 0.8});
  EXPECT_NEAR(slowed.turn_rate / slowed.forward, 1.6, 1e-9);
}

TEST(VelocityGuard, CountsTheAgeOfTheRanges) {
  // 0.4 s ago the wall was far enough; since then it has been driving.
  const auto allowed = [](double age) {
    VelocityGuard guard({});
    guard.SetRanges(ScanOf(Wall(0.66), {}, 0.0));
    AllowedVelocity result;
    for (double t = 0.0; t <= age; t += 0.1) {
      result = guard.Allow(At(t), {0.4, 0.0});
    }
    return result.velocity.forward;
  };
  EXPECT_NEAR(allowed(0.0), 0.4, 1e-9);
  EXPECT_LT(allowed(0.45), 0.38);
}

TEST(VelocityGuard, DrivesBlindOnlySlowly) {
  VelocityGuard guard({});
  RangeScan front{At(0), -kPi / 2, kPi / 180, std::vector<double>(181, 4.0)};
  guard.SetRanges(front);
  EXPECT_EQ(guard.Allow(At(0), {0.5, 0.0}).velocity.forward, 0.5);
  const AllowedVelocity back = guard.Allow(At(0), {-0.4, 0.4});
  EXPECT_NEAR(back.velocity.forward, -0.1, 1e-12);
  EXPECT_NEAR(back.velocity.turn_rate, 0.1, 1e-12);
  EXPECT_EQ(back.reason, "no ranges in that direction");
  // Readings that say nothing are not seen either.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  front.ranges.assign(181, nan);
  guard.SetRanges(front);
  EXPECT_NEAR(guard.Allow(At(0), {0.5, 0.0}).velocity.forward, 0.1, 1e-12);
}

TEST(VelocityGuard, KnowsWhereTheSensorIs) {
  VelocityGuardOptions options;
  options.X_RS = {0.15, 0.0, kPi};  // Looks back.
  VelocityGuard guard(options);
  // Something 0.4 m in front of the sensor: 0.25 m behind R.
  RangeScan scan{At(0), -0.2, 0.01, std::vector<double>(41, 0.4)};
  guard.SetRanges(scan);
  EXPECT_EQ(guard.Allow(At(0), {-0.3, 0.0}).velocity.forward, 0.0);
  EXPECT_NEAR(guard.Allow(At(0), {0.1, 0.0}).velocity.forward, 0.1, 1e-12);
}

TEST(VelocityGuard, AWideEchoMayBeAnywhereInIt) {
  // 35 deg to the left, 0.6 m away: beside the way, unless the beam is wide.
  const auto allowed = [](double width_deg, double step_deg) {
    VelocityGuardOptions options;
    options.beam_width = RadiansFromDegrees(width_deg);
    VelocityGuard guard(options);
    RangeScan scan{At(0),
                   step_deg < 0.0 ? RadiansFromDegrees(70.0) : 0.0,
                   RadiansFromDegrees(step_deg),
                   {}};
    scan.ranges.assign(static_cast<std::size_t>(35.0 / std::abs(step_deg)) + 1,
                       5.0);
    scan.ranges.back() = 0.6;
    guard.SetRanges(scan);
    return guard.Allow(At(0), {0.5, 0.0}).velocity.forward;
  };
  EXPECT_EQ(allowed(0.0, 1.0), 0.5);
  EXPECT_EQ(allowed(0.0, 5.0), 0.5);
  EXPECT_LT(allowed(40.0, 5.0), 0.5);
  // Nothing is between two beams.
  EXPECT_LT(allowed(0.0, 35.0), 0.5);
  EXPECT_LT(allowed(0.0, -35.0), 0.5);
}

TEST(VelocityGuard, OnlyBackwardsAfterABumper) {
  VelocityGuardOptions options;
  options.ranges = RangeUse::kNone;
  VelocityGuard guard(options);
  guard.SetContact(At(0));
  EXPECT_EQ(guard.Allow(At(0.9), {0.3, 0.2}).velocity, (Velocity{0.0, 0.2}));
  EXPECT_EQ(guard.Allow(At(0.9), {0.3, 0.2}).reason, "bumper: only backwards");
  EXPECT_EQ(guard.Allow(At(0.9), {-0.3, 0.2}).velocity, (Velocity{-0.3, 0.2}));
  EXPECT_EQ(guard.Allow(At(1.0), {0.3, 0.2}).velocity, (Velocity{0.3, 0.2}));
}

TEST(VelocityGuard, ALongTimeWithoutCommandsCostsNoTime) {
  VelocityGuard guard({});
  guard.Stop(TimeFromMicroseconds(1));
  const double years = 50 * 3.2e7;  // As from the epoch to now.
  guard.SetRanges(ScanOf({}, {}, years));
  EXPECT_EQ(guard.Allow(At(years), {0.3, 0.1}).velocity, (Velocity{0.3, 0.1}));
}

TEST(VelocityGuard, RefusesOptionsThatMakeNoSense) {
  VelocityGuardOptions options;
  options.radius = 0.0;
  EXPECT_THROW(VelocityGuard{options}, std::invalid_argument);
  options = {};
  options.rates.braking = -1.0;
  EXPECT_THROW(VelocityGuard{options}, std::invalid_argument);
  options = {};
  options.beam_width = 4.0;
  EXPECT_THROW(VelocityGuard{options}, std::invalid_argument);
}

}  // namespace
}  // namespace waymark
