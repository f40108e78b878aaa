// Estimated and reference paths as values.
#pragma once

#include "estimation/base/time.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace waymark {

// An estimate X_WR; covariance is of (x, y, heading), as in pose_t.
struct EstimatedPose {
  Time time;
  Pose2 X_WR;
  std::optional<Eigen::Matrix3d> covariance;
};

// One sample of the reference: where the point S of the robot was, and where
// the reference knows it, which way the robot faced.
struct TruthSample {
  Time time;
  Eigen::Vector2d p_WS = Eigen::Vector2d::Zero();
  std::optional<double> heading;                   // Of the robot, rad.
  Eigen::Vector2d p_RS = Eigen::Vector2d::Zero();  // S on the robot, m.
};

}  // namespace waymark
