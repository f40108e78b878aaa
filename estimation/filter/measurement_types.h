// Measurements as values, shared by the online filter and the batch refiner.
#pragma once

#include "estimation/base/time.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string>

namespace waymark {

// Cumulative ticks, counter wraps already removed.
struct EncoderReading {
  Time time;
  std::int64_t seq = 0;
  std::int64_t right = 0;
  std::int64_t left = 0;
};

// Absolute measurement of (part of) X_FS = X_WF^-1 * X_WR * X_RS: position,
// pose, heading or one coordinate (lateral: y in a frame along a corridor).
struct AbsoluteFix {
  Time time;
  std::int64_t seq = 0;
  std::string source;
  std::array<bool, 3> has{};                        // x, y, heading.
  Eigen::Vector3d value = Eigen::Vector3d::Zero();  // m, m, rad, in F.
  // Of value; rows and columns of absent components are ignored. The block of
  // the present ones is positive definite.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Pose2 X_WF;  // Frame of the measurement in the world.
  Pose2 X_RS;  // Sensor on the robot.

  [[nodiscard]] bool has_any() const { return has[0] || has[1] || has[2]; }
};

// Motion X_S0S1 of a sensor between two times, measured by the sensor.
struct RelativeMotion {
  Time from;
  Time time;
  std::int64_t seq = 0;
  std::string source;
  Pose2 X_S0S1;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  Pose2 X_RS;  // Nominal mounting.
};

}  // namespace waymark
