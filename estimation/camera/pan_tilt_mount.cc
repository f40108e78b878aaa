#include "estimation/camera/pan_tilt_mount.h"

namespace waymark {

Eigen::Matrix3d ForwardCameraRotation() {
  Eigen::Matrix3d R_RC;
  R_RC << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,     //
      0.0, -1.0, 0.0;
  return R_RC;
}

Eigen::Isometry3d PanTiltMount::CameraOnRobot(double pan, double tilt) const {
  // About y (left) a positive turn takes x (forward) to -z: downward.
  const Eigen::Matrix3d turned =
      (Eigen::AngleAxisd(pan, Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  Eigen::Isometry3d X_HC = Eigen::Isometry3d::Identity();
  X_HC.linear() = turned * ForwardCameraRotation();
  X_HC.translation() = turned * lever_arm;
  return X_RH * X_HC;
}

}  // namespace waymark
