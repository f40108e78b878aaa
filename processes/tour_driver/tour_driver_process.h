// Drives a tour as a person would: by where the robot truly is.
#pragma once

#include "processes/path_follower/task_follower.h"

#include <waymark/truth_t.hpp>

#include <string_view>

namespace waymark {

// TASK (kind "tour"), TRUTH -> MOTION_REQUEST, TASK_STATUS. For teaching and
// experiments only: on a real robot there is no TRUTH.
class TourDriverProcess {
 public:
  using Config = TaskFollowerConfig;
  static constexpr std::string_view kName = "tour_driver";
  static constexpr std::string_view kAbout =
      "Drives tours by the true pose of a simulation: TASK, TRUTH -> "
      "MOTION_REQUEST, TASK_STATUS.";

  // Throws InputError where the task file cannot be written.
  TourDriverProcess(const Config& config, Bus* bus);

 private:
  void OnTruth(const truth_t& message);

  TaskFollower follower_;
};

}  // namespace waymark
