// Estimates as values: what the filter and the batch refiner answer.
#pragma once

#include "estimation/base/time.h"
#include "estimation/filter/differential_drive.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>

namespace waymark {

// A start that somebody states.
struct InitialPose {
  Time time;
  std::int64_t seq = 0;
  std::string source;
  Pose2 X_WR;
  // Of (x, y, heading); positive semidefinite, zero = exactly known.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

// Pose of the robot at one time, or why there is none.
struct PoseEstimate {
  Time time;
  bool is_known = false;
  std::string reason;  // Empty where is_known.
  Pose2 X_WR;          // X_OR for dead reckoning.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // Of (x, y, heading).
  double forward_speed = 0.0;  // m/s over the last step.
  double turn_rate = 0.0;      // rad/s over the last step.
  std::int64_t num_accepted = 0;
  std::int64_t num_rejected = 0;
};

// Where a calibrated sensor S sits, and its clock.
struct SensorCalibration {
  std::string sensor;        // Its source name.
  Pose2 X_RS;                // Pose on the robot.
  double time_offset = 0.0;  // Sensor clock minus encoder clock, s.
  // Of (x, y, yaw, time_offset).
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
};

// Wheel parameters with their uncertainty; vectors and matrices in the order
// (k_right, k_left, wheel_base).
struct OdometryParameters {
  Time time;           // Of the newest input used.
  std::string source;  // "nominal", "online" or "batch".
  // False: there is no answer, because of reason; what follows is then the
  // prior, or 0 where there is none either.
  bool is_known = true;
  // Where is_known: which parameters the measurements do not show, if any.
  std::string reason;
  WheelParameters parameters;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  // 1 - posterior / prior variance per parameter, in [0, 1]: 0 where the
  // measurements said nothing about it, 1 where they said everything.
  Eigen::Vector3d observability = Eigen::Vector3d::Zero();
  std::int64_t num_measurements = 0;
  std::optional<SensorCalibration> sensor;
};

}  // namespace waymark
