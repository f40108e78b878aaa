// What no estimator of pose and wheel parameters can be better than.
#pragma once

#include "estimation/filter/differential_drive.h"
#include "estimation/filter/measurement_types.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

namespace waymark {

// Posterior Cramer-Rao bound [1] of (x, y, heading, k_right, k_left, B): the
// Riccati recursion of the extended Kalman filter with all Jacobians at the
// true states, given the true errors of wheels and measurements. For whoever
// knows the truth: simulations.
//
// [1] P. Tichavsky, C. H. Muravchik, A. Nehorai. Posterior Cramer-Rao bounds
//     for discrete-time nonlinear filtering. IEEE Trans. Signal Processing
//     46(5), 1386-1396, 1998.
class PosteriorBound {
 public:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  // `parameters`: the true ones. `prior`: covariance at the start.
  PosteriorBound(const WheelParameters& parameters,
                 const DriveNoise& noise,
                 DriveIntegration integration,
                 const Matrix6& prior);

  // A step from the true pose X_WR that counted `ticks`.
  void Predict(const Pose2& X_WR, const WheelTicks& ticks);
  // A measurement at the true pose X_WR: what it has, its covariance, frame and
  // sensor count, its value does not. Its covariance is the true one.
  void Update(const Pose2& X_WR, const AbsoluteFix& fix);

  [[nodiscard]] const Matrix6& covariance() const { return P_; }
  // Of the wheels: k_right, k_left, B.
  [[nodiscard]] Eigen::Matrix3d parameter_covariance() const {
    return P_.bottomRightCorner<3, 3>();
  }

 private:
  WheelParameters parameters_;
  DriveNoise noise_;
  DriveIntegration integration_;
  Matrix6 P_;
};

// Variance of the ratio k_right / k_left, to first order.
[[nodiscard]] double RatioVariance(const WheelParameters& parameters,
                                   const Eigen::Matrix3d& covariance);

}  // namespace waymark
