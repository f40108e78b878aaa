// Camera on a pan-tilt head.
#pragma once

#include <Eigen/Geometry>

namespace waymark {

// The head's base H has x forward, y left, z up; pan turns about H's z,
// positive to the left, then tilt about the panned y, positive downward. At pan
// and tilt 0 the camera looks along H's x with its own x to the right.
struct PanTiltMount {
  Eigen::Isometry3d X_RH = Eigen::Isometry3d::Identity();
  // From the crossing of the two axes to the camera's centre, in the axes of
  // the camera at pan and tilt 0 turned to H's (x forward, y left, z up), m.
  Eigen::Vector3d lever_arm = Eigen::Vector3d::Zero();

  // Pose of the camera on the robot. Angles in rad.
  [[nodiscard]] Eigen::Isometry3d CameraOnRobot(double pan, double tilt) const;
};

// Rotation from axes x forward, y left, z up (of a robot or a head) to those of
// a camera that looks forward: R_RC.
[[nodiscard]] Eigen::Matrix3d ForwardCameraRotation();

}  // namespace waymark
