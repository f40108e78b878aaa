// Configuration of path_follower and tour_driver.
#pragma once

#include "planner/control/path_tracker.h"
#include "processes/support/describer.h"

#include <string>

namespace waymark {

struct TaskFollowerConfig {
  PathTrackerOptions tracker;
  double pose_timeout_s = 0.5;
  std::string task_file;
  double resume_within_s = 60.0;

  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const;
};

}  // namespace waymark
