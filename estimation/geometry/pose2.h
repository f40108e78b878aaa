// Planar poses.
#pragma once

#include <Eigen/Core>

namespace waymark {

// Pose X_AB of frame B in frame A: p = p_AB in m, heading = angle from A's x
// axis to B's x axis, rad, counter-clockwise, in (-pi, pi].
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double heading = 0.0;

  [[nodiscard]] Eigen::Vector2d position() const { return {x, y}; }
  [[nodiscard]] Eigen::Vector3d vector() const { return {x, y, heading}; }
  [[nodiscard]] static Pose2 FromVector(const Eigen::Vector3d& v);

  friend bool operator==(const Pose2&, const Pose2&) = default;
};

// X_AC = X_AB * X_BC.
[[nodiscard]] Pose2 operator*(const Pose2& X_AB, const Pose2& X_BC);

// p_AQ = X_AB * p_BQ.
[[nodiscard]] Eigen::Vector2d operator*(const Pose2& X_AB,
                                        const Eigen::Vector2d& p_BQ);

// X_BA.
[[nodiscard]] Pose2 Inverse(const Pose2& X_AB);

// X_BC = X_AB^-1 * X_AC, heading wrapped.
[[nodiscard]] Pose2 Between(const Pose2& X_AB, const Pose2& X_AC);

// Derivatives of X_AB * X_BC, as (x, y, heading), with respect to each factor.
struct ComposeJacobians {
  Eigen::Matrix3d d_AB;
  Eigen::Matrix3d d_BC;
};
[[nodiscard]] ComposeJacobians JacobiansOfCompose(const Pose2& X_AB,
                                                  const Pose2& X_BC);

// Derivatives of Between(X_AB, X_AC), as (x, y, heading), with respect to each
// pose.
struct BetweenJacobians {
  Eigen::Matrix3d d_AB;
  Eigen::Matrix3d d_AC;
};
[[nodiscard]] BetweenJacobians JacobiansOfBetween(const Pose2& X_AB,
                                                  const Pose2& X_AC);

}  // namespace waymark
