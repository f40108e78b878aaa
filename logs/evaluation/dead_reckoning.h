// Dead reckoning over recorded encoder readings with given parameters, to see
// offline what another set of parameters would have made of the same ticks.
#pragma once

#include "estimation/filter/differential_drive.h"
#include "estimation/filter/measurement_types.h"
#include "logs/evaluation/trajectory_types.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace waymark {

// X_OR at every reading, O the robot's pose at the first; arcs between
// readings (exact for constant wheel speeds). Readings are in order of time.
// Throws std::logic_error unless parameters.wheel_base > 0.
[[nodiscard]] std::vector<EstimatedPose> DeadReckon(
    std::span<const EncoderReading> readings,
    const WheelParameters& parameters);

// The same path moved rigidly so that it passes through X_WR at `time`
// (interpolated; the first or last pose where `time` lies outside).
[[nodiscard]] std::vector<EstimatedPose> Anchor(std::vector<EstimatedPose> path,
                                                Time time,
                                                const Pose2& X_WR);

// A set of parameters as published.
struct ParameterSample {
  Time time;
  WheelParameters parameters;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector3d observability = Eigen::Vector3d::Zero();  // As published.
};

// How an estimate of the parameters came to rest.
struct ParameterConvergence {
  WheelParameters final;
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  // Of the final ones.
  Eigen::Vector3d observability = Eigen::Vector3d::Zero();  // Likewise.
  bool has_reference = false;
  Eigen::Vector3d relative_error = Eigen::Vector3d::Zero();  // final/ref - 1.
  // |final - reference| / sigma; 0 where sigma is 0.
  Eigen::Vector3d normalised_error = Eigen::Vector3d::Zero();
  // Seconds after the first sample from which on the estimate stays within
  // 1 % of the reference; absent: not by the end.
  std::array<std::optional<double>, 3> settled_s;
};

// `samples` in order of time, at least one.
[[nodiscard]] ParameterConvergence EvaluateConvergence(
    std::span<const ParameterSample> samples,
    const std::optional<WheelParameters>& reference);

}  // namespace waymark
