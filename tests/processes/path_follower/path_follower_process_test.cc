#include "processes/path_follower/path_follower_process.h"

#include "planner/control/drive_model.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"
#include "tests/support/temporary_directory.h"

#include <waymark/task_status_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kStart = 1'000'000'000;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::int64_t Utime(double s) {
  return kStart + static_cast<std::int64_t>(s * 1e6 + 0.5);
}
Time At(double s) {
  return TimeFromMicroseconds(Utime(s));
}

task_t Task1(double s, std::vector<std::pair<double, double>> points) {
  task_t task;
  task.utime = Utime(s);
  task.source = "test";
  task.kind = "waypoints";
  for (const auto& [x, y] : points) {
    waypoint_t waypoint;
    waypoint.x = x;
    waypoint.y = y;
    task.waypoints.push_back(waypoint);
  }
  task.num_waypoints = static_cast<int>(points.size());
  return task;
}

pose_t PoseMessage(double s, const Pose2& X_WR) {
  pose_t pose;
  pose.utime = Utime(s);
  pose.is_known = 1;
  pose.pose_W[0] = X_WR.x;
  pose.pose_W[1] = X_WR.y;
  pose.pose_W[2] = X_WR.heading;
  return pose;
}

// The process and a robot that does what is asked.
class PathFollowerProcessTest : public testing::Test {
 protected:
  PathFollowerProcessTest() { config_.task_file = folder_ / "task"; }
  void Start() {
    world_ = std::make_unique<LocalBus>(At(t_));
    process_ = std::make_unique<PathFollowerProcess>(
        config_, world_->AddProcess("path_follower"));
  }
  // A pose each 0.1 s, and what is asked for in between.
  void Drive(double seconds) {
    for (const double end = t_ + seconds; t_ < end - 1e-6;) {
      t_ += 0.1;
      world_->Publish(kPose, PoseMessage(t_, state_.pose));
      world_->RunUntil(At(t_));
      const velocity_t request = LastRequest();
      EXPECT_EQ(request.utime, Utime(t_)) << "each pose is answered";
      state_ = Advance(
          state_, {request.forward, request.turn_rate}, DriveRates{}, 0.1);
    }
  }
  velocity_t LastRequest() {
    return world_->Messages<velocity_t>(kMotionRequest).back();
  }
  task_status_t LastStatus() {
    return world_->Messages<task_status_t>(kTaskStatus).back();
  }
  std::int64_t NumBad() { return world_->Status("path_follower").num_bad; }

  TemporaryDirectory folder_{TemporaryDirectory::FastParent()};
  TaskFollowerConfig config_;
  double t_ = 0.0;
  DriveState state_;
  std::unique_ptr<LocalBus> world_;
  std::unique_ptr<PathFollowerProcess> process_;
};

TEST_F(PathFollowerProcessTest, SaysThatThereIsNothingToDo) {
  Start();
  Drive(1.0);
  EXPECT_EQ(world_->Messages<velocity_t>(kMotionRequest).size(), 10u);
  EXPECT_EQ(LastRequest().forward, 0.0);
  EXPECT_EQ(LastRequest().source, "path_follower");
  EXPECT_EQ(LastRequest().reason, "idle");
  EXPECT_EQ(LastStatus().state, "idle");
  EXPECT_EQ(LastStatus().task_utime, 0);
}

TEST_F(PathFollowerProcessTest, DrivesToTheGoal) {
  Start();
  world_->Publish(kTask, Task1(0.05, {{2, 0}, {2, 1}}));
  Drive(2.0);
  EXPECT_EQ(LastStatus().state, "driving");
  EXPECT_EQ(LastStatus().task_utime, Utime(0.05));
  EXPECT_EQ(LastStatus().num_waypoints, 2);
  EXPECT_GT(LastStatus().distance_left, 1.0);
  Drive(30.0);
  EXPECT_EQ(LastStatus().state, "done");
  EXPECT_EQ(LastStatus().num_reached, 2);
  EXPECT_LT((state_.pose.position() - Eigen::Vector2d(2, 1)).norm(), 0.06);
  EXPECT_EQ(LastRequest().reason, "done");
  // The same task again is no new one.
  world_->PublishAt(At(t_ + 0.01), kTask, Task1(0.05, {{2, 0}, {2, 1}}));
  Drive(1.0);
  EXPECT_EQ(LastStatus().state, "done");
}

TEST_F(PathFollowerProcessTest, ANewTaskReplacesTheOldOne) {
  Start();
  world_->Publish(kTask, Task1(0.05, {{5, 0}}));
  Drive(2.0);
  world_->Publish(kTask, Task1(2.05, {{0, 2}}));
  Drive(1.0);
  EXPECT_EQ(LastStatus().task_utime, Utime(2.05));
  task_t none = Task1(3.05, {});
  none.kind = "none";
  world_->Publish(kTask, none);
  Drive(0.2);
  EXPECT_EQ(LastStatus().state, "idle");
  EXPECT_EQ(LastRequest().forward, 0.0);
  world_->Publish(kTask, Task1(4.05, {{5, 0}}));
  Drive(2.0);
  EXPECT_EQ(LastStatus().state, "driving");
  task_t tour = Task1(5.25, {{1, 1}});
  tour.kind = "tour";  // Somebody else's.
  world_->Publish(kTask, tour);
  Drive(0.2);
  EXPECT_EQ(LastStatus().state, "idle");
}

TEST_F(PathFollowerProcessTest, StandsWithoutAPose) {
  Start();
  world_->Publish(kTask, Task1(0.05, {{3, 0}}));
  world_->RunUntil(At(0.2));
  EXPECT_EQ(LastStatus().state, "waiting");
  EXPECT_EQ(LastStatus().reason, "no pose yet");
  t_ = 0.2;
  Drive(2.0);
  EXPECT_GT(LastRequest().forward, 0.1);
  const double last = t_;
  world_->RunUntil(At(t_ + 0.45));
  EXPECT_GT(LastRequest().forward, 0.1);
  world_->RunUntil(At(t_ + 0.61));
  EXPECT_EQ(LastRequest().forward, 0.0);
  EXPECT_EQ(LastRequest().utime, Utime(last));
  EXPECT_THAT(LastRequest().reason, HasSubstr("no POSE for 0."));
  EXPECT_EQ(LastStatus().state, "waiting");
  t_ += 1.0;
  pose_t unknown = PoseMessage(t_, {});
  unknown.is_known = 0;
  unknown.reason = "lost";
  world_->Publish(kPose, unknown);
  world_->RunUntil(At(t_));
  EXPECT_EQ(LastRequest().utime, Utime(t_));
  EXPECT_EQ(LastRequest().reason, "pose unknown: lost");
  Drive(20.0);
  EXPECT_EQ(LastStatus().state, "done");
}

TEST_F(PathFollowerProcessTest, SaysWhyItWaits) {
  Start();
  world_->Publish(kTask, Task1(0.05, {{3, 0}}));
  velocity_t command;
  command.utime = Utime(0.1);
  command.source = "path_follower";
  command.reason = "obstacle at 0.10 m, 3 deg";
  world_->Publish(kMotionCommand, command);
  for (int i = 1; i < 80; ++i) {  // It does not move.
    world_->Publish(kPose, PoseMessage(0.1 * i, {}));
  }
  world_->RunUntil(At(8.0));
  EXPECT_EQ(LastStatus().state, "waiting");
  EXPECT_THAT(LastStatus().reason, HasSubstr("no progress for"));
  EXPECT_THAT(LastStatus().reason, HasSubstr(": obstacle at 0.10 m"));
  EXPECT_GT(LastRequest().forward, 0.0);
}

TEST_F(PathFollowerProcessTest, GoesOnAfterItsRestart) {
  Start();
  world_->Publish(kTask, Task1(0.05, {{1, 0}, {1, 1}, {3, 1}}));
  Drive(0.1);
  while (LastStatus().num_reached < 1 && t_ < 30.0) Drive(0.1);
  process_.reset();  // As killed: it has no last words.
  Start();
  Drive(1.0);
  EXPECT_EQ(LastStatus().state, "driving");
  EXPECT_EQ(LastStatus().num_reached, 1);
  EXPECT_EQ(LastStatus().task_utime, Utime(0.05));
  Drive(40.0);
  EXPECT_EQ(LastStatus().state, "done");
  EXPECT_LT((state_.pose.position() - Eigen::Vector2d(3, 1)).norm(), 0.06);
  // What is done is not taken up again.
  Start();
  Drive(0.5);
  EXPECT_EQ(LastStatus().state, "idle");
}

TEST_F(PathFollowerProcessTest, DoesNotTakeUpAnOldTask) {
  Start();
  world_->Publish(kTask, Task1(0.05, {{3, 0}}));
  Drive(1.0);
  t_ += 100.0;  // More than resume_within_s.
  Start();
  Drive(0.5);
  EXPECT_EQ(LastStatus().state, "idle");
}

TEST_F(PathFollowerProcessTest, ABrokenTaskFileIsAFaultAndNoTask) {
  for (const char* text : {"kind: waypoints\nwaypoints: [1, 2, 3]\n",
                           "kind: dance\n",
                           "kind: waypoints\ntask_utime: 5\n",
                           "no yaml"}) {
    std::ofstream(config_.task_file) << text;
    Start();
    EXPECT_THAT(world_->Status("path_follower").fault,
                HasSubstr(config_.task_file))
        << text;
    Drive(0.3);
    EXPECT_EQ(LastStatus().state, "idle");
  }
}

TEST_F(PathFollowerProcessTest, BadMessagesAreCounted) {
  Start();
  task_t task = Task1(0.01, {{1, 0}});
  task.kind = "dance";
  world_->Publish(kTask, task);
  task = Task1(0.02, {{1, kNan}});
  world_->Publish(kTask, task);
  task = Task1(0.03, {});
  world_->Publish(kTask, task);
  task = Task1(0.04, {{1, 0}});
  task.max_speed = -1.0;
  world_->Publish(kTask, task);
  task.max_speed = kNan;
  world_->Publish(kTask, task);
  world_->RunUntil(At(0.05));
  EXPECT_EQ(NumBad(), 5);
  world_->Publish(kPose, PoseMessage(0.1, {kNan, 0, 0}));
  world_->RunUntil(At(0.1));
  EXPECT_EQ(NumBad(), 6);
  EXPECT_TRUE(world_->Messages<velocity_t>(kMotionRequest).empty());
  world_->Publish(kPose, PoseMessage(0.5, {}));
  world_->RunUntil(At(0.5));
  world_->PublishAt(At(0.6), kPose, PoseMessage(0.3, {}));  // Overtaken.
  world_->RunUntil(At(0.6));
  EXPECT_EQ(NumBad(), 7);
  EXPECT_EQ(world_->Messages<velocity_t>(kMotionRequest).size(), 1u);
  t_ = 0.6;
  Drive(0.2);
  EXPECT_EQ(LastStatus().state, "idle");
}

}  // namespace
}  // namespace waymark
