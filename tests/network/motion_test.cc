// Guard, follower and the task tool as processes of their own, around a robot
// of this test's: driven, stopped, killed, and started again.
#include "estimation/geometry/angle.h"
#include "planner/control/drive_model.h"
#include "processes/support/channels.h"
#include "processes/support/lcm_bus.h"
#include "processes/support/lcm_url.h"
#include "tests/network/network_test.h"
#include "tests/network/stall_watch.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_directory.h"

#include <waymark/planar_lidar_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/velocity_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace waymark {
namespace {

using testing::HasSubstr;
using Steady = std::chrono::steady_clock;
using std::chrono::milliseconds;

// A base that obeys MOTION_COMMAND for half a second, with POSE and RANGES in
// an empty hall, at 20 Hz, in a thread.
class Robot {
 public:
  Robot() : thread_([this] { Run(); }) {}
  ~Robot() {
    is_over_ = true;
    thread_.join();
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  [[nodiscard]] DriveState state() {
    const std::lock_guard lock(mutex_);
    return state_;
  }
  [[nodiscard]] std::string last_command() {
    const std::lock_guard lock(mutex_);
    return last_command_;
  }
  [[nodiscard]] bool is_moving() { return !state().velocity.is_zero(); }
  [[nodiscard]] static bool Until(const std::function<bool()>& done,
                                  double seconds = 20.0) {
    const auto end = Steady::now() + std::chrono::duration<double>(seconds);
    while (!done()) {
      if (Steady::now() > end) return false;
      std::this_thread::sleep_for(milliseconds(10));
    }
    return true;
  }

 private:
  void Run() {
    LcmBus bus("robot", LcmUrl(""));
    bus.Advertise<pose_t>(kPose);
    bus.Advertise<planar_lidar_t>(kRanges);
    Velocity command;
    Steady::time_point commanded = Steady::now();
    bus.Subscribe<velocity_t>(
        kMotionCommand, Keep::Latest(), [&](const velocity_t& m, Time) {
          command = {m.forward, m.turn_rate};
          commanded = Steady::now();
          const std::lock_guard lock(mutex_);
          last_command_ = "MOTION_COMMAND " + std::to_string(m.seq) + " of '" +
                          m.source + "': " + std::to_string(m.forward) +
                          " m/s, '" + m.reason + "'\n";
        });
    bus.Every(Duration(50'000), [&](Time now) {
      if (Steady::now() - commanded > milliseconds(500)) command = {};
      const std::lock_guard lock(mutex_);
      state_ = Advance(state_, command, DriveRates{}, 0.05);
      PublishState(&bus, now);
    });
    bus.Start();
    while (!is_over_) {
      bus.RunTimers();
      pollfd wait{bus.wake_fd(), POLLIN, 0};
      if (!bus.HandleOne()) ::poll(&wait, 1, 5);
    }
  }
  void PublishState(LcmBus* bus, Time now) const {
    planar_lidar_t ranges;
    ranges.utime = Microseconds(now);
    ranges.nranges = 36;
    ranges.ranges.assign(36, 5.0f);
    ranges.nintensities = 0;
    ranges.radstep = static_cast<float>(kPi / 18);
    bus->Publish(kRanges, ranges);
    pose_t pose;
    pose.utime = Microseconds(now);
    pose.is_known = 1;
    pose.pose_W[0] = state_.pose.x;
    pose.pose_W[1] = state_.pose.y;
    pose.pose_W[2] = state_.pose.heading;
    bus->Publish(kPose, pose);
  }

  std::mutex mutex_;
  DriveState state_;
  std::string last_command_ = "no MOTION_COMMAND\n";
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

class MotionNetworkTest : public NetworkTest {
 protected:
  std::unique_ptr<ChildProcess> StartGuard() {
    return std::make_unique<ChildProcess>(
        std::vector<std::string>{BuildPath("bin/collision_guard"),
                                 "--set",
                                 "stop_file=" + folder_ / "stop"});
  }
  std::unique_ptr<ChildProcess> StartFollower() {
    return std::make_unique<ChildProcess>(
        std::vector<std::string>{BuildPath("bin/path_follower"),
                                 "--set",
                                 "task_file=" + folder_ / "task"});
  }
  static std::vector<std::string> Tool(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), BuildPath("bin/waymark-task"));
    return arguments;
  }
  TemporaryDirectory folder_;
};

TEST_F(MotionNetworkTest, DrivesATaskAndSaysHowFarItIs) {
  Robot robot;
  const auto guard = StartGuard();
  const auto follower = StartFollower();
  const ChildResult result =
      RunChild(Tool({"waypoints", "0.5,0", "0.5,0.3,180", "--follow"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("driving: 0 of 2 way-points"));
  EXPECT_THAT(result.out, HasSubstr("done: 2 of 2 way-points, 0.0 m left"));
  EXPECT_NEAR(robot.state().pose.x, 0.5, 0.06);
  EXPECT_NEAR(robot.state().pose.y, 0.3, 0.06);
  EXPECT_NEAR(std::abs(robot.state().pose.heading), kPi, 0.1);
}

TEST_F(MotionNetworkTest, ItStandsWithoutItsGuardAndGoesOnWithANewOne) {
  Robot robot;
  auto guard = StartGuard();
  const auto follower = StartFollower();
  ChildProcess task(Tool({"waypoints", "1.5,0", "--follow"}));
  ASSERT_TRUE(Robot::Until([&] { return robot.state().pose.x > 0.2; }))
      << robot.last_command() << guard->ErrSoFar() << follower->ErrSoFar()
      << task.ErrSoFar();
  guard->Signal(SIGKILL);
  const auto killed = Steady::now();
  const StallWatch stalls;
  ASSERT_TRUE(Robot::Until([&] { return !robot.is_moving(); }));
  // The base's time-out, and braking from 0.4 m/s at 0.5 m/s^2.
  EXPECT_LT(Steady::now() - killed - stalls.longest(), milliseconds(1600));
  guard = StartGuard();
  const ChildResult result = task.Wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NEAR(robot.state().pose.x, 1.5, 0.06);
}

TEST_F(MotionNetworkTest, ItStandsWithoutItsFollowerWhoGoesOnAfterARestart) {
  Robot robot;
  const auto guard = StartGuard();
  auto follower = StartFollower();
  ChildProcess task(Tool({"waypoints", "1.5,0", "--follow"}));
  ASSERT_TRUE(Robot::Until([&] { return robot.state().pose.x > 0.2; }))
      << robot.last_command() << guard->ErrSoFar() << follower->ErrSoFar()
      << task.ErrSoFar();
  follower->Signal(SIGKILL);
  ASSERT_TRUE(Robot::Until([&] { return !robot.is_moving(); }, 3.0));
  follower = StartFollower();
  const ChildResult result = task.Wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NEAR(robot.state().pose.x, 1.5, 0.06);
}

TEST_F(MotionNetworkTest, AStopHoldsOverTheDeathOfTheGuard) {
  Robot robot;
  auto guard = StartGuard();
  const auto follower = StartFollower();
  ChildProcess task(Tool({"waypoints", "1.0,0", "--follow"}));
  ASSERT_TRUE(Robot::Until([&] { return robot.state().pose.x > 0.1; }))
      << robot.last_command() << guard->ErrSoFar() << follower->ErrSoFar()
      << task.ErrSoFar();
  const ChildResult stop = RunChild(Tool({"stop"}));
  EXPECT_EQ(stop.exit_code, 0) << stop.err;
  EXPECT_EQ(stop.out, "stopped\n");
  ASSERT_TRUE(Robot::Until([&] { return !robot.is_moving(); }, 3.0));
  guard->Signal(SIGKILL);
  guard = StartGuard();
  const double x = robot.state().pose.x;
  std::this_thread::sleep_for(milliseconds(1000));
  EXPECT_EQ(robot.state().pose.x, x);
  const ChildResult go = RunChild(Tool({"go"}));
  EXPECT_EQ(go.exit_code, 0) << go.err;
  EXPECT_EQ(go.out, "let go\n");
  EXPECT_EQ(task.Wait().exit_code, 0);
}

TEST_F(MotionNetworkTest, CancelGivesUpWhatIsUnderWay) {
  Robot robot;
  const auto guard = StartGuard();
  const auto follower = StartFollower();
  ChildProcess task(Tool({"waypoints", "3.0,0", "--follow"}));
  ASSERT_TRUE(Robot::Until([&] { return robot.state().pose.x > 0.1; }))
      << robot.last_command() << guard->ErrSoFar() << follower->ErrSoFar()
      << task.ErrSoFar();
  EXPECT_EQ(RunChild(Tool({"cancel"})).exit_code, 0);
  const ChildResult result = task.Wait();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("the task was given up"));
  EXPECT_FALSE(robot.is_moving());
}

TEST_F(MotionNetworkTest, TheToolSaysWhereNobodyAnswers) {
  ChildResult result = RunChild(Tool({"waypoints", "1,2", "--timeout", "0.5"}));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("does path_follower run"));
  result = RunChild(Tool({"tour", "1,2", "--timeout", "0.5"}));
  EXPECT_THAT(result.err, HasSubstr("does tour_driver run"));
  result = RunChild(Tool({"stop", "--timeout", "0.5"}));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("collision_guard has not answered"));
  for (const char* place : {"1", "1,2,3,4", "a,b", "1,nan", "1,,2", "1e9,0"}) {
    result = RunChild(Tool({"waypoints", place}));
    EXPECT_EQ(result.exit_code, 2) << place;
    EXPECT_THAT(result.err, HasSubstr("is no place: x,y or x,y,heading"));
  }
  EXPECT_EQ(RunChild(Tool({"waypoints"})).exit_code, 2);
  EXPECT_EQ(RunChild(Tool({"dance"})).exit_code, 2);
}

}  // namespace
}  // namespace waymark
