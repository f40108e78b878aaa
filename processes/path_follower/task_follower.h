// Carries out tasks of one kind by poses of one channel.
#pragma once

#include "planner/control/path_tracker.h"
#include "processes/path_follower/task_file.h"
#include "processes/path_follower/task_follower_config.h"
#include "processes/support/bus.h"
#include "processes/support/state_saver.h"

#include <waymark/task_t.hpp>
#include <waymark/velocity_t.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace waymark {

// TASK and poses -> MOTION_REQUEST and TASK_STATUS: one of each for every pose,
// with its utime, also where there is nothing to do; and by a timer (10 Hz),
// as zero, while poses are missing. A task of another kind ends what is under
// way. What is under way goes on after a restart by the task file.
class TaskFollower {
 public:
  struct Role {
    std::string_view name;  // Of the process.
    std::string_view kind;  // Of tasks.
    std::string_view pose_channel;
  };
  TaskFollower(const TaskFollowerConfig& config, const Role& role, Bus* bus);

  // nullopt: the message cannot be used, because of `reason`.
  void OnPose(std::int64_t utime,
              const std::optional<Pose2>& X_WR,
              const std::string& reason);
  // The message says that there is none.
  void OnNoPose(Time t, const std::string& reason);

 private:
  void OnTask(const task_t& message);
  void OnCommand(const velocity_t& message);
  void OnTimer(Time now);
  [[nodiscard]] bool IsLate(Time t);
  void Resume(Time t);
  void Finish(Time t, TrackReport report);
  void Save(Time t);
  void ShowFault();

  TaskFollowerConfig config_;
  Role role_;
  Bus* bus_;
  PathTracker tracker_;
  StateSaver saver_;
  std::optional<Task> task_;          // Under way, done or failed.
  std::optional<TaskProgress> kept_;  // From before a restart.
  std::optional<Time> pose_time_;
  Time pose_arrived_;
  std::string guard_reason_;  // Why less than was asked for is allowed.
  TrackState state_ = TrackState::kIdle;
  int num_reached_ = 0;
  std::optional<Time> saved_;
  std::string load_fault_;  // Of the task file, until it is written anew.
  std::int32_t request_seq_ = 0;
  std::int32_t status_seq_ = 0;
};

}  // namespace waymark
