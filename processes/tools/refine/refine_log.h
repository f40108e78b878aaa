// A recorded log as a batch problem.
#pragma once

#include "estimation/batch/batch_types.h"

#include <optional>
#include <string>

namespace waymark {

struct RefineLog {
  std::string path;
  BatchLog log;
  std::optional<WheelParameters> nominal;  // As the log states them.
  int num_bad = 0;                         // Messages that could not be used.
};

// Collects ENCODERS, POSITION_FIX, CORRIDOR_POSE, RELATIVE_MOTION, INITIAL_POSE
// and nominal ODOMETRY_PARAMETERS. Throws InputError where the log cannot be
// read or holds no encoder readings.
[[nodiscard]] RefineLog ReadRefineLog(const std::string& path,
                                      double max_wheel_speed);

}  // namespace waymark
