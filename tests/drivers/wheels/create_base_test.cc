#include "drivers/wheels/create_base.h"

#include "tests/support/create_on_pty.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <memory>
#include <stdexcept>
#include <thread>

namespace waymark {
namespace {

using testing::HasSubstr;

CreateBaseOptions Options(const std::string& device) {
  CreateBaseOptions options;
  options.device = device;
  options.reopen_s = 0.1;
  options.watchdog_s = 60.0;  // A loaded machine must not look like a hang.
  return options;
}

struct World {
  World() : base(std::make_unique<CreateBase>(Options(pty.device()))) {}

  // Steps of 20 ms of the robot's time, until `done` or for 20 s of it.
  [[nodiscard]] bool Until(const std::function<bool()>& done) {
    for (int i = 0; i < 1000; ++i) {
      if (done()) return true;
      now += Duration(20'000);
      if (base && forward) base->Command(now, *forward, 0.0);
      if (base) {
        if (auto reading = base->Poll(now)) newest = *reading;
      }
      pty.Step(0.02);
    }
    return false;
  }
  [[nodiscard]] int Speed() {
    int speed = 0;
    pty.With([&](CreateEmulator& robot) { speed = robot.left_speed(); });
    return speed;
  }

  CreateOnPty pty;
  Time now = TimeFromMicroseconds(1'700'000'000'000'000);
  std::unique_ptr<CreateBase> base;
  std::optional<double> forward;
  CreateReading newest;
};

TEST(CreateBase, DrivesThroughASerialPortAndStopsWhenItGoes) {
  World world;
  world.forward = 0.2;
  ASSERT_TRUE(world.Until([&] { return world.Speed() == 200; }));
  ASSERT_TRUE(
      world.Until([&] { return world.newest.sensors.left_ticks > 500; }));
  EXPECT_EQ(world.base->Fault(), "");
  world.base.reset();
  EXPECT_TRUE(world.Until([&] { return world.Speed() == 0; }));
}

TEST(CreateBase, UnpluggedIsOneLineAndPluggedInAgainItGoesOn) {
  World world;
  world.forward = 0.2;
  ASSERT_TRUE(world.Until([&] { return world.Speed() == 200; }));
  world.pty.Unplug();
  ASSERT_TRUE(world.Until([&] { return !world.base->Fault().empty(); }));
  EXPECT_THAT(world.base->Fault(), HasSubstr(world.pty.device() + ": "));
  ASSERT_TRUE(world.Until([&] {
    return world.base->Fault().find("cannot open: No such file") !=
           std::string::npos;
  }));
  world.pty.With([](CreateEmulator& robot) {
    robot.SetMode(CreateEmulator::kOff);
    robot.Receive(EncodeStart());
  });
  ASSERT_EQ(world.Speed(), 0);
  world.pty.Plug();
  EXPECT_TRUE(world.Until([&] { return world.Speed() == 200; }));
  EXPECT_EQ(world.base->Fault(), "");
}

TEST(CreateBase, WhatIsNoSerialPortIsOneLine) {
  const TemporaryDirectory directory;
  WriteBytes(directory / "file", {});
  const Time now = TimeFromMicroseconds(1);
  CreateBase file(Options(directory / "file"));
  EXPECT_FALSE(file.Poll(now));
  EXPECT_EQ(file.Fault(),
            (directory / "file") +
                ": is no serial port: Inappropriate ioctl for device");
  CreateBase missing(Options("/dev/ttyNone"));
  EXPECT_FALSE(missing.Poll(now));
  EXPECT_EQ(missing.Fault(),
            "/dev/ttyNone: cannot open: No such file or directory");
  CreateBaseOptions options;
  options.baud = 12345;
  EXPECT_THROW(CreateBase{options}, std::invalid_argument);
}

TEST(CreateBase, SecondUserIsRefused) {
  World world;
  ASSERT_TRUE(world.Until([&] { return world.base->Fault().empty(); }));
  CreateBase second(Options(world.pty.device()));
  EXPECT_FALSE(second.Poll(world.now));
  EXPECT_EQ(second.Fault(), world.pty.device() + ": another process uses it");
}

TEST(CreateBase, KilledProcessStopsItsRobot) {
  World world;
  world.base.reset();
  const pid_t child = ::fork();
  if (child == 0) {
    // A driver in a process of its own, its clock by its steps.
    CreateBase base(Options(world.pty.device()));
    for (Time now = world.now;; now += Duration(20'000)) {
      base.Command(now, 0.3, 0.0);
      (void)base.Poll(now);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  ASSERT_TRUE(world.Until([&] { return world.Speed() == 300; }));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(world.Until([&] { return world.Speed() == 0; }));
  world.pty.With([](CreateEmulator& robot) {
    EXPECT_EQ(robot.mode(), CreateEmulator::kPassive);
  });
  // And the port is free again.
  world.base = std::make_unique<CreateBase>(Options(world.pty.device()));
  world.forward = 0.1;
  EXPECT_TRUE(world.Until([&] { return world.Speed() == 100; }));
}

TEST(CreateBase, ProcessThatHangsStopsItsRobot) {
  CreateOnPty pty;
  CreateBaseOptions options = Options(pty.device());
  options.watchdog_s = 0.1;
  CreateBase base(options);
  const Time now = TimeFromMicroseconds(1'700'000'000'000'000);
  (void)base.Poll(now);
  // Any mode in which it can move, whatever the greeting has come to.
  pty.Step(0.02);
  pty.With([](CreateEmulator& robot) {
    robot.SetMode(CreateEmulator::kSafe);
    robot.Receive(EncodeDriveDirect(200, 200));
    ASSERT_TRUE(robot.is_moving());
  });
  // And no further call.
  bool is_moving = true;
  for (int i = 0; i < 5000 && is_moving; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    pty.Step(0.001);
    pty.With([&](CreateEmulator& robot) { is_moving = robot.is_moving(); });
  }
  EXPECT_FALSE(is_moving);
}

TEST(CreateBase, DriverThatIsNotReadLosesCommandsNotTheirBounds) {
  World world;
  world.forward = 0.2;
  ASSERT_TRUE(world.Until([&] { return world.Speed() == 200; }));
  // The robot takes nothing until its buffer is full, for 80 s.
  for (int i = 0; i < 4000; ++i) {
    world.now += Duration(20'000);
    world.base->Command(world.now, 0.2, 0.0);
  }
  world.forward = 0.25;
  EXPECT_TRUE(world.Until([&] { return world.Speed() == 250; }));
  world.pty.With([](CreateEmulator& robot) {
    EXPECT_EQ(robot.num_unknown_commands(), 0);
  });
}

}  // namespace
}  // namespace waymark
