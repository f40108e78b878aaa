// What the filter learned of its wheels in a run, and what it could have.
#pragma once

#include "drivers/simulator/robot.h"
#include "estimation/filter/estimate_types.h"
#include "processes/pose_filter/pose_filter_config.h"
#include "processes/tools/experiment/corridor_bound.h"

#include <vector>

namespace waymark {

struct LearnedWheels {
  double ratio_error = 0.0;   // Of the ratio of right and left, as a share.
  double base_error = 0.0;    // Of the wheel base, as a share.
  double ratio_sigmas = 0.0;  // The same in what was stated.
  double base_sigmas = 0.0;
  double num_to_ratio = 0.0;  // Measurements until within 1 % for good.
  double num_to_base = 0.0;
};

// `all`: in their order. The errors are those of the last.
[[nodiscard]] LearnedWheels LearnedOf(
    const std::vector<OdometryParameters>& all, const RobotOptions& robot);

// Sigmas, as shares, below which no estimator's errors can be on this way.
struct WheelBound {
  double ratio = 0.0;
  double base = 0.0;
};

// `filter`: what was known before.
[[nodiscard]] WheelBound BoundOf(const CorridorBound& run,
                                 const PoseFilterConfig& filter,
                                 const RobotOptions& robot);

}  // namespace waymark
