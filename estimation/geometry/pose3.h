// Poses in space.
#pragma once

#include "estimation/geometry/pose2.h"

#include <Eigen/Geometry>

namespace waymark {

// The same pose on the plane z = 0.
[[nodiscard]] inline Eigen::Isometry3d SpatialPose(const Pose2& X_AB) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::AngleAxisd(X_AB.heading, Eigen::Vector3d::UnitZ())
                   .toRotationMatrix();
  X.translation() << X_AB.x, X_AB.y, 0.0;
  return X;
}

}  // namespace waymark
