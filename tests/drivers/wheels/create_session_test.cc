#include "drivers/wheels/create_session.h"

#include "tests/support/create_emulator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

// Session and robot, byte by byte in lock-step of 10 ms.
struct World {
  explicit World(const CreateSessionOptions& options = {}) : session(options) {
    session.Open(now);
  }

  // Lets time pass; the command, if any, is renewed all the while.
  void Run(double seconds) {
    for (int i = 0; i < std::lround(seconds / 0.01); ++i) {
      now += DurationFromSeconds(0.01);
      if (commands) session.Command(now, forward, turn_rate);
      robot.Receive(session.Send(now));
      session.Receive(now, robot.Step(0.01));
      if (auto reading = session.TakeReading()) readings.push_back(*reading);
    }
  }
  void Command(double v, double w) {
    commands = true;
    forward = v;
    turn_rate = w;
  }

  Time now = TimeFromMicroseconds(1'700'000'000'000'000);
  CreateSession session;
  CreateEmulator robot;
  std::vector<CreateReading> readings;
  bool commands = false;
  double forward = 0.0;
  double turn_rate = 0.0;
};

TEST(CreateSession, GreetsStopsThenDrives) {
  World world;
  // Someone else had left it driving.
  world.robot.SetMode(CreateEmulator::kSafe);
  world.robot.Receive(EncodeDriveDirect(400, 400));
  EXPECT_THAT(world.session.Fault(), HasSubstr("does not answer"));
  world.Run(0.02);
  EXPECT_FALSE(world.robot.is_moving());
  world.Command(0.2, 0.5);
  world.Run(0.5);
  EXPECT_EQ(world.session.Fault(), "");
  EXPECT_EQ(world.robot.mode(), CreateEmulator::kSafe);
  // 200 mm/s, and 0.5 rad/s times half of 235 mm.
  EXPECT_EQ(world.robot.right_speed(), 259);
  EXPECT_EQ(world.robot.left_speed(), 141);
  EXPECT_EQ(world.session.parser().num_skipped(), 0);
  ASSERT_FALSE(world.readings.empty());
  EXPECT_EQ(world.readings.back().battery, 0.8);
}

TEST(CreateSession, TicksAreTheWayAndWrap) {
  World world;
  world.robot.SetTicks(65000.0, 65000.0);
  world.Run(0.2);
  world.Command(0.25, 0.0);
  world.Run(8.0);
  world.commands = false;
  world.Run(1.0);
  EXPECT_EQ(world.robot.left_speed(), 0);
  const CreateReading& last = world.readings.back();
  EXPECT_LT(last.sensors.left_ticks, 10000);  // Wrapped.
  const auto way = static_cast<std::uint16_t>(last.sensors.left_ticks - 65000);
  // 8 s, and the half second until the command has worn out, but for braking
  // in the last 0.125 s of it; a period of either side.
  EXPECT_NEAR(way * kCreateMetersPerTick,
              (8.5 - 0.5 * 0.125) * 0.25,
              0.02 * 0.25 + 0.001);
  EXPECT_EQ(world.session.base().num_timeouts(), 1);
}

TEST(CreateSession, FastCommandsKeepTheCurveWithinTheRobotsLimit) {
  World world;
  world.Command(1.0, 4.0);  // Radius 0.25 m.
  world.Run(0.5);
  EXPECT_EQ(world.robot.right_speed(), 500);
  // (r - B/2) / (r + B/2) of the outer wheel; mm/s are whole.
  EXPECT_NEAR(world.robot.left_speed(), 500.0 * 0.1325 / 0.3675, 0.5);
}

TEST(CreateSession, LostAndWrongBytesCostFramesOnly) {
  World world;
  world.Command(0.2, 0.0);
  world.Run(0.5);
  world.robot.SetNoise(0.005, 0.005, 0.005);
  world.readings.clear();
  std::uint16_t last = 0;
  for (int i = 0; i < 1000; ++i) {
    world.Run(0.01);
    EXPECT_TRUE(world.robot.is_moving());
    if (world.readings.empty()) continue;
    const CreateSensors& sensors = world.readings.back().sensors;
    // No count is made up: steps of 10 ms, some of them lost.
    if (last != 0) {
      EXPECT_LT(static_cast<std::uint16_t>(sensors.left_ticks - last), 100);
    }
    last = sensors.left_ticks;
  }
  EXPECT_EQ(world.session.Fault(), "");
  EXPECT_GT(world.session.parser().num_skipped(), 1000);
  // One and a half percent of 33 bytes: a little over half of them arrive.
  EXPECT_GT(world.readings.size(), 250u);
}

TEST(CreateSession, SilenceIsAFaultAndIsAddressedAnew) {
  World world;
  world.Command(0.2, 0.0);
  world.Run(0.5);
  world.robot.SetSilent(true);
  world.Run(0.4);
  EXPECT_EQ(world.session.Fault(), "");
  world.Run(0.3);
  EXPECT_THAT(world.session.Fault(), HasSubstr("does not answer"));
  world.Run(5.0);
  // Back from a reset: off, deaf to all but the start command.
  world.robot.SetSilent(false);
  world.robot.SetMode(CreateEmulator::kOff);
  world.Run(1.0);
  EXPECT_EQ(world.session.Fault(), "");
  EXPECT_EQ(world.robot.left_speed(), 200);
}

TEST(CreateSession, BumpersBetweenTwoReadingsAreNotMissed) {
  World world;
  world.Run(0.5);
  (void)world.session.TakeReading();
  world.robot.SetBumpers(false, true);
  world.session.Receive(world.now, world.robot.Step(0.03));
  world.robot.SetBumpers(false, false);
  world.session.Receive(world.now, world.robot.Step(0.03));
  const auto reading = world.session.TakeReading();
  ASSERT_TRUE(reading);
  EXPECT_TRUE(reading->sensors.is_bumper_right);
  EXPECT_FALSE(reading->sensors.is_bumper_left);
  EXPECT_FALSE(world.session.TakeReading());
}

TEST(CreateSession, BumperStopsForwardMotion) {
  World world;
  world.Command(0.2, 0.0);
  world.Run(0.5);
  world.robot.SetBumpers(true, true);
  world.Run(0.04);
  EXPECT_FALSE(world.robot.is_moving());
  world.Command(-0.1, 0.0);
  world.Run(0.1);
  EXPECT_EQ(world.robot.left_speed(), -100);
  EXPECT_EQ(world.session.base().num_contacts(), 1);
}

TEST(CreateSession, AfterItsOwnStopTheRobotWaitsForACommandToStand) {
  World world;
  world.Command(0.2, 0.0);
  world.Run(0.5);
  world.robot.SetWheelDrop(true);
  world.Run(3.0);
  EXPECT_EQ(world.robot.mode(), CreateEmulator::kPassive);
  EXPECT_THAT(world.session.Fault(), HasSubstr("a wheel hangs down"));
  world.robot.SetWheelDrop(false);
  world.Run(1.5);
  EXPECT_EQ(world.robot.mode(), CreateEmulator::kSafe);
  EXPECT_FALSE(world.robot.is_moving());
  EXPECT_THAT(world.session.Fault(),
              HasSubstr("stopped until a command asks for no motion"));
  world.Command(0.0, 0.0);
  world.Run(0.1);
  world.Command(0.2, 0.0);
  world.Run(0.1);
  EXPECT_TRUE(world.robot.is_moving());
  EXPECT_EQ(world.session.Fault(), "");
}

TEST(CreateSession, CliffAndUnknownModesAreStopsToo) {
  World world;
  world.Command(0.2, 0.0);
  world.Run(0.5);
  world.robot.SetCliff(true);
  world.Run(0.1);
  EXPECT_THAT(world.session.Fault(), HasSubstr("a cliff"));
  world.robot.SetCliff(false);
  world.Run(1.5);
  // As seen on real robots.
  world.robot.SetMode(32);
  world.Run(0.1);
  EXPECT_THAT(world.session.Fault(), HasSubstr("mode 32"));
}

TEST(CreateSession, ReturningToSafeModeCanBeForbidden) {
  CreateSessionOptions options;
  options.returns_to_mode = false;
  World world(options);
  world.Run(0.5);
  world.robot.SetWheelDrop(true);
  world.Run(0.1);
  world.robot.SetWheelDrop(false);
  world.Run(10.0);
  EXPECT_EQ(world.robot.mode(), CreateEmulator::kPassive);
  EXPECT_THAT(world.session.Fault(), HasSubstr("until restarted"));
}

TEST(CreateSession, OptionsOutOfRangeAreNamed) {
  CreateSessionOptions options;
  options.base.max_wheel_speed = 0.6;
  EXPECT_THROW(CreateSession{options}, std::invalid_argument);
  options = {};
  options.silence_s = 0.1;
  EXPECT_THROW(CreateSession{options}, std::invalid_argument);
  options = {};
  options.mode = CreateMode::kPassive;
  EXPECT_THROW(CreateSession{options}, std::invalid_argument);
}

}  // namespace
}  // namespace waymark
