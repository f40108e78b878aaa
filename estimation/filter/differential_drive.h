// Motion of a differential drive from its wheel ticks, with its Jacobians and
// the distance-driven error model.
#pragma once

#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

namespace waymark {

// Order everywhere: (k_right, k_left, wheel_base).
struct WheelParameters {
  double k_right = 0.0;     // Travel per tick of the right wheel, m.
  double k_left = 0.0;      // Travel per tick of the left wheel, m.
  double wheel_base = 0.0;  // Effective wheel separation B, m.

  [[nodiscard]] Eigen::Vector3d vector() const {
    return {k_right, k_left, wheel_base};
  }
  [[nodiscard]] static WheelParameters FromVector(const Eigen::Vector3d& v) {
    return {v(0), v(1), v(2)};
  }
  friend bool operator==(const WheelParameters&,
                         const WheelParameters&) = default;
};

// Ticks counted between two readings. Not integers, because readings may be
// interpolated.
struct WheelTicks {
  double right = 0.0;
  double left = 0.0;
};

// Distance-driven noise [1, section IV.A]: variances proportional to travel,
// so that the covariance of a path does not depend on how often it is sampled.
struct DriveNoise {
  // Variance of one wheel's travel per metre travelled, m^2/m.
  double wheel_variance = 1e-5;
  // The wheel base of a step is off by b with variance base_variance / ds, ds
  // the mean absolute wheel travel of the step, m^2 * m. Division by ds (not
  // the product that [1] suggests) is what keeps a turn's variance independent
  // of the number of steps: the errors dtheta * b / B of n substeps are
  // independent and n times smaller.
  double base_variance = 1e-7;
};

enum class DriveIntegration {
  kMidpoint,  // Equation 4 of [1].
  kArc,       // Exact for constant wheel speeds within the step.
};

// One step X_R0R1 of the robot in its own previous frame.
struct DriveStep {
  Pose2 X_R0R1;
  // Derivative of (x, y, heading) of X_R0R1 by (k_right, k_left, wheel_base).
  Eigen::Matrix3d d_parameters = Eigen::Matrix3d::Zero();
  // Covariance of (x, y, heading) of X_R0R1 under DriveNoise. Rank <= 2.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

// X_WR1 = X_WR0 * X_R0R1 is equation 5 of [1], with l_r = k_right * right and
// l_l = k_left * left. Throws std::logic_error unless wheel_base > 0 and all
// inputs are finite.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] DriveStep IntegrateTicks(const WheelTicks& ticks,
                                       const WheelParameters& parameters,
                                       const DriveNoise& noise,
                                       DriveIntegration integration);

}  // namespace waymark
