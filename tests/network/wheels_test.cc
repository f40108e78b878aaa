// The driver of the base as a process of its own: what becomes of the robot
// when it is asked to end, killed, and started again.
#include "processes/support/channels.h"
#include "processes/support/lcm_bus.h"
#include "processes/support/lcm_url.h"
#include "tests/network/network_test.h"
#include "tests/network/stall_watch.h"
#include "tests/support/child_process.h"
#include "tests/support/create_on_pty.h"

#include <waymark/encoders_t.hpp>
#include <waymark/velocity_t.hpp>

#include <gtest/gtest.h>
#include <poll.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <memory>

namespace waymark {
namespace {

using Steady = std::chrono::steady_clock;

// Sends MOTION_COMMAND at 20 Hz while it waits for something.
class Driver {
 public:
  Driver() : bus_("driver", LcmUrl("")) {
    bus_.Advertise<velocity_t>(kMotionCommand);
    bus_.Subscribe<encoders_t>(
        kEncoders, Keep::All(), [this](const encoders_t&, Time) {
          ++num_encoders;
        });
    bus_.Start();
    robot.RunLive();
  }

  [[nodiscard]] bool Until(const std::function<bool()>& done) {
    const auto deadline = Steady::now() + std::chrono::seconds(20);
    while (!done()) {
      if (Steady::now() > deadline) return false;
      velocity_t message;
      message.utime = Microseconds(bus_.now());
      message.seq = seq_++;
      message.source = "driver";
      message.forward = forward;
      bus_.Publish(kMotionCommand, message);
      pollfd wait{bus_.wake_fd(), POLLIN, 0};
      ::poll(&wait, 1, 50);
      while (bus_.HandleOne()) {
      }
    }
    return true;
  }
  [[nodiscard]] bool UntilMoving(bool wanted) {
    return Until([&] {
      bool is_moving = false;
      robot.With([&](CreateEmulator& r) { is_moving = r.is_moving(); });
      return is_moving == wanted;
    });
  }
  [[nodiscard]] std::unique_ptr<ChildProcess> StartWheels() {
    return std::make_unique<ChildProcess>(std::vector<std::string>{
        BuildPath("bin/wheels"), "--set", "device=" + robot.device()});
  }

  CreateOnPty robot;
  int num_encoders = 0;
  double forward = 0.2;

 private:
  LcmBus bus_;
  std::int32_t seq_ = 0;
};

class WheelsNetworkTest : public NetworkTest {};

TEST_F(WheelsNetworkTest, SigtermStopsTheRobotAlthoughCommandsGoOn) {
  Driver driver;
  const auto wheels = driver.StartWheels();
  ASSERT_TRUE(driver.UntilMoving(true));
  ASSERT_TRUE(driver.Until([&] { return driver.num_encoders > 20; }));
  wheels->Signal(SIGTERM);
  EXPECT_EQ(wheels->Wait().exit_code, 0);
  EXPECT_TRUE(driver.UntilMoving(false));
}

TEST_F(WheelsNetworkTest, SigkillStopsTheRobotAndAfterARestartItGoesOn) {
  Driver driver;
  auto wheels = driver.StartWheels();
  ASSERT_TRUE(driver.UntilMoving(true));
  const StallWatch stalls;
  const auto begin = Steady::now();
  wheels->Signal(SIGKILL);
  ASSERT_TRUE(driver.UntilMoving(false));
  // The robot itself would have gone on for ever; as soon as any time-out.
  EXPECT_LT(Steady::now() - begin - stalls.longest(),
            std::chrono::milliseconds(500));
  EXPECT_EQ(wheels->Wait().exit_code, 128 + SIGKILL);
  const int num_before = driver.num_encoders;
  wheels = driver.StartWheels();
  EXPECT_TRUE(driver.UntilMoving(true));
  EXPECT_TRUE(driver.Until([&] { return driver.num_encoders > num_before; }));
}

TEST_F(WheelsNetworkTest, SigstopStopsTheRobotUntilACommandToStand) {
  Driver driver;
  const auto wheels = driver.StartWheels();
  ASSERT_TRUE(driver.UntilMoving(true));
  wheels->Signal(SIGSTOP);
  EXPECT_TRUE(driver.UntilMoving(false));
  // The commands that it finds on waking are old, and the robot has stopped.
  const int num_before = driver.num_encoders;
  wheels->Signal(SIGCONT);
  ASSERT_TRUE(
      driver.Until([&] { return driver.num_encoders > num_before + 100; }));
  driver.robot.With([](CreateEmulator& r) { EXPECT_FALSE(r.is_moving()); });
  driver.forward = 0.0;
  const int num_again = driver.num_encoders;
  ASSERT_TRUE(
      driver.Until([&] { return driver.num_encoders > num_again + 10; }));
  driver.forward = 0.2;
  EXPECT_TRUE(driver.UntilMoving(true));
}

}  // namespace
}  // namespace waymark
