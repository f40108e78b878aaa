#include "estimation/geometry/pose2.h"

#include "estimation/geometry/angle.h"

#include <cmath>

namespace waymark {

Pose2 Pose2::FromVector(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), WrapAngle(v.z())};
}

Pose2 operator*(const Pose2& X_AB, const Pose2& X_BC) {
  const double c = std::cos(X_AB.heading);
  const double s = std::sin(X_AB.heading);
  return {X_AB.x + c * X_BC.x - s * X_BC.y,
          X_AB.y + s * X_BC.x + c * X_BC.y,
          WrapAngle(X_AB.heading + X_BC.heading)};
}

Eigen::Vector2d operator*(const Pose2& X_AB, const Eigen::Vector2d& p_BQ) {
  const double c = std::cos(X_AB.heading);
  const double s = std::sin(X_AB.heading);
  return {X_AB.x + c * p_BQ.x() - s * p_BQ.y(),
          X_AB.y + s * p_BQ.x() + c * p_BQ.y()};
}

Pose2 Inverse(const Pose2& X_AB) {
  const double c = std::cos(X_AB.heading);
  const double s = std::sin(X_AB.heading);
  return {-c * X_AB.x - s * X_AB.y,
          s * X_AB.x - c * X_AB.y,
          WrapAngle(-X_AB.heading)};
}

Pose2 Between(const Pose2& X_AB, const Pose2& X_AC) {
  const double c = std::cos(X_AB.heading);
  const double s = std::sin(X_AB.heading);
  const double dx = X_AC.x - X_AB.x;
  const double dy = X_AC.y - X_AB.y;
  return {c * dx + s * dy,
          -s * dx + c * dy,
          WrapAngle(X_AC.heading - X_AB.heading)};
}

ComposeJacobians JacobiansOfCompose(const Pose2& X_AB, const Pose2& X_BC) {
  const double c = std::cos(X_AB.heading);
  const double s = std::sin(X_AB.heading);
  ComposeJacobians jacobians;
  jacobians.d_AB << 1.0, 0.0, -s * X_BC.x - c * X_BC.y,  //
      0.0, 1.0, c * X_BC.x - s * X_BC.y,                 //
      0.0, 0.0, 1.0;
  jacobians.d_BC << c, -s, 0.0,  //
      s, c, 0.0,                 //
      0.0, 0.0, 1.0;
  return jacobians;
}

BetweenJacobians JacobiansOfBetween(const Pose2& X_AB, const Pose2& X_AC) {
  const Pose2 X_BC = Between(X_AB, X_AC);
  const double c = std::cos(X_AB.heading);
  const double s = std::sin(X_AB.heading);
  BetweenJacobians jacobians;
  jacobians.d_AB << -c, -s, X_BC.y,  //
      s, -c, -X_BC.x,                //
      0.0, 0.0, -1.0;
  jacobians.d_AC << c, s, 0.0,  //
      -s, c, 0.0,               //
      0.0, 0.0, 1.0;
  return jacobians;
}

}  // namespace waymark
