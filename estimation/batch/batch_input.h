// Logs made ready for the batch problem: tracks, usable measurements, sensors.
#pragma once

#include "estimation/batch/batch_types.h"
#include "estimation/batch/tick_track.h"

#include <span>
#include <string>
#include <vector>

namespace waymark {

// One mounting of one sensor, as a block of (x, y, yaw, time offset).
struct BatchSensorSlot {
  std::string source;
  int log = -1;  // -1: shared by all logs.
  BatchSensorOptions options;
  Eigen::Vector4d nominal = Eigen::Vector4d::Zero();
  [[nodiscard]] std::array<bool, 4> IsEstimated() const {
    return {
        options.position, options.position, options.yaw, options.time_offset};
  }
  [[nodiscard]] Eigen::Vector4d PriorSigma() const {
    return {options.sigma_position_m,
            options.sigma_position_m,
            options.sigma_yaw_rad,
            options.sigma_time_offset_s};
  }
};

// Measurements point into the caller's logs.
struct BatchFixInput {
  const AbsoluteFix* fix = nullptr;
  int sensor = 0;
  double time = 0.0;  // Sensor clock, s of the track.
};
struct BatchMotionInput {
  const RelativeMotion* motion = nullptr;
  int sensor = 0;
  double from = 0.0;  // Sensor clock, s of the track.
  double time = 0.0;
};

struct BatchLogInput {
  TickTrack track;
  std::vector<BatchFixInput> fixes;       // In time order.
  std::vector<BatchMotionInput> motions;  // In time order.
  std::optional<StartPose> start;
};

struct BatchInput {
  std::vector<BatchLogInput> logs;  // Same length as the caller's.
  std::vector<BatchSensorSlot> sensors;
  int num_measurements = 0;
  int num_refused = 0;
  double travel_m = 0.0;
  Time newest;
};

// Leaves out, and counts, readings that go back in time and measurements that
// are not finite, have no positive definite covariance, nothing present, or
// lie outside the time of the readings.
[[nodiscard]] BatchInput PrepareBatch(std::span<const BatchLog> logs,
                                      const BatchOptions& options);

}  // namespace waymark
