// Drives along way-points by the estimated pose.
#pragma once

#include "processes/path_follower/task_follower.h"

#include <waymark/pose_t.hpp>

#include <string_view>

namespace waymark {

// TASK (kind "waypoints"), POSE -> MOTION_REQUEST, TASK_STATUS.
class PathFollowerProcess {
 public:
  using Config = TaskFollowerConfig;
  static constexpr std::string_view kName = "path_follower";
  static constexpr std::string_view kAbout =
      "Drives along way-points by the estimated pose: TASK, POSE -> "
      "MOTION_REQUEST, TASK_STATUS.";

  // Throws InputError where the task file cannot be written.
  PathFollowerProcess(const Config& config, Bus* bus);

 private:
  void OnPose(const pose_t& message);

  TaskFollower follower_;
};

}  // namespace waymark
