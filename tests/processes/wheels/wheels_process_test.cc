#include "processes/wheels/wheels_process.h"

#include "estimation/base/input_error.h"
#include "processes/support/channels.h"
#include "processes/support/configuration.h"
#include "processes/support/local_bus.h"
#include "processes/support/replay_bus.h"
#include "tests/support/create_on_pty.h"

#include <waymark/base_status_t.hpp>
#include <waymark/encoders_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

const Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

WheelsConfig Config(const std::string& device) {
  WheelsConfig config;
  config.create.device = device;
  config.create.watchdog_s = 60.0;  // Time is simulated.
  return config;
}

// The process and an emulated robot behind a pseudo-terminal, in lock-step.
struct World {
  World() : process(Config(pty.device()), local.AddProcess("wheels")) {}

  // What the kernel still carries arrives a step late at times.
  void Run(double seconds) {
    const Time end = local.now() + DurationFromSeconds(seconds);
    while (local.now() < end) {
      if (command) {
        velocity_t message = *command;
        message.utime = Microseconds(local.now());
        local.Publish(kMotionCommand, message);
      }
      local.RunUntil(local.now() + Duration(20'000));
      pty.Step(0.02);
    }
  }
  void Command(double forward, double turn_rate) {
    command.emplace();
    command->forward = forward;
    command->turn_rate = turn_rate;
  }
  void Robot(const std::function<void(CreateEmulator&)>& action) {
    pty.With(action);
  }
  [[nodiscard]] std::string Fault() { return local.Status("wheels").fault; }

  CreateOnPty pty;
  LocalBus local{kStart};
  WheelsProcess process;
  std::optional<velocity_t> command;
};

TEST(WheelsProcess, DrivesAndCounts) {
  World world;
  world.Run(0.5);
  world.Command(0.2, 0.4);
  world.Run(2.0);
  world.Robot([](CreateEmulator& robot) {
    EXPECT_EQ(robot.right_speed(), 247);  // 200 + 0.4 * 235 / 2.
    EXPECT_EQ(robot.left_speed(), 153);
  });
  const auto encoders = world.local.Messages<encoders_t>(kEncoders);
  // 50 Hz but for the greeting.
  EXPECT_GT(encoders.size(), 100u);
  for (std::size_t i = 0; i < encoders.size(); ++i) {
    EXPECT_EQ(encoders[i].seq, static_cast<std::int32_t>(i));
    EXPECT_EQ(encoders[i].counter_bits, 16);
    EXPECT_EQ(encoders[i].is_virtual, 0);
  }
  world.Robot([&](CreateEmulator& robot) {
    // What is still on its way: two periods at 250 mm/s and 2249 ticks/m.
    EXPECT_NEAR(static_cast<double>(encoders.back().left_ticks),
                robot.left_ticks(),
                25.0);
    EXPECT_NEAR(static_cast<double>(encoders.back().right_ticks),
                robot.right_ticks(),
                25.0);
  });
  const auto bases = world.local.Messages<base_status_t>(kBase);
  EXPECT_NEAR(static_cast<double>(bases.size()), 24.0, 2.0);
  EXPECT_NE(bases.back().is_command_current, 0);
  EXPECT_NE(bases.back().has_battery, 0);
  EXPECT_EQ(bases.back().battery, 0.8);
  EXPECT_EQ(world.Fault(), "");
}

TEST(WheelsProcess, StopsHalfASecondAfterTheLastCommand) {
  World world;
  world.Command(0.3, 0.0);
  world.Run(1.0);
  world.command.reset();
  world.Run(0.4);
  world.Robot([](CreateEmulator& robot) { EXPECT_TRUE(robot.is_moving()); });
  world.Run(0.2);
  world.Robot([](CreateEmulator& robot) { EXPECT_FALSE(robot.is_moving()); });
  const base_status_t base = world.local.Messages<base_status_t>(kBase).back();
  EXPECT_EQ(base.is_command_current, 0);
  EXPECT_EQ(base.num_timeouts, 1);
}

TEST(WheelsProcess, BumpersAreReportedAndStop) {
  World world;
  world.Command(0.2, 0.0);
  world.Run(1.0);
  world.Robot([](CreateEmulator& robot) { robot.SetBumpers(true, false); });
  world.Run(0.06);
  // Released before BASE is due again, and reported all the same.
  world.Robot([](CreateEmulator& robot) {
    EXPECT_FALSE(robot.is_moving());
    robot.SetBumpers(false, false);
  });
  world.Run(0.3);
  bool was_left = false;
  bool was_right = false;
  for (const auto& base : world.local.Messages<base_status_t>(kBase)) {
    was_left |= base.is_bumper_left != 0;
    was_right |= base.is_bumper_right != 0;
  }
  EXPECT_TRUE(was_left);
  EXPECT_FALSE(was_right);
  EXPECT_EQ(world.local.Messages<base_status_t>(kBase).back().num_contacts, 1);
}

TEST(WheelsProcess, SilenceIsAFaultAndNothingIsPublished) {
  World world;
  world.Command(0.2, 0.0);
  world.Run(1.0);
  world.Robot([](CreateEmulator& robot) { robot.SetSilent(true); });
  world.Run(1.0);
  EXPECT_THAT(world.Fault(), HasSubstr("does not answer"));
  const auto num = world.local.Messages<encoders_t>(kEncoders).size();
  world.Run(1.0);
  EXPECT_EQ(world.local.Messages<encoders_t>(kEncoders).size(), num);
  world.Robot([](CreateEmulator& robot) { robot.SetSilent(false); });
  world.Run(1.0);
  EXPECT_EQ(world.Fault(), "");
  EXPECT_GT(world.local.Messages<encoders_t>(kEncoders).size(), num);
}

TEST(WheelsProcess, PortThatGoesAndComesIsOpenedAnew) {
  World world;
  world.Command(0.2, 0.0);
  world.Run(0.5);
  world.pty.Unplug();
  world.Run(1.5);
  EXPECT_EQ(world.Fault(),
            world.pty.device() + ": cannot open: No such file or directory");
  world.pty.Plug();
  world.Run(2.0);
  EXPECT_EQ(world.Fault(), "");
  world.Robot([](CreateEmulator& robot) { EXPECT_TRUE(robot.is_moving()); });
}

TEST(WheelsProcess, FinishStopsTheWheels) {
  World world;
  world.Command(0.2, 0.0);
  world.Run(0.5);
  world.process.Finish();
  world.pty.Step(0.02);
  world.Robot([](CreateEmulator& robot) { EXPECT_FALSE(robot.is_moving()); });
}

TEST(WheelsProcess, ImpossibleCommandsAreReportedAndNotObeyed) {
  World world;
  world.Run(0.5);
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    world.Command(value, 0.0);
    world.Run(0.1);
    world.Command(0.0, value);
    world.Run(0.1);
  }
  world.Robot([](CreateEmulator& robot) { EXPECT_FALSE(robot.is_moving()); });
  for (const auto& channel : world.local.Status("wheels").channels) {
    if (channel.channel == kMotionCommand) {
      EXPECT_EQ(channel.num_bad, channel.num_received);
    }
  }
}

TEST(WheelsProcess, HasNoOfflineRun) {
  try {
    (void)RunReplay({{MakeProcessClass<WheelsProcess>(), "", {}}}, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "wheels: drives a device, so it cannot run on a log");
  }
}

TEST(WheelsProcess, SpeedsThatNoPortHasAreRefused) {
  WheelsConfig config;
  try {
    LoadConfiguration("", {"baud=12345"}, &config);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("baud = 12345 must be 9600, 19200"));
  }
}

}  // namespace
}  // namespace waymark
