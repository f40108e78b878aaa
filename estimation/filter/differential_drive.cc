#include "estimation/filter/differential_drive.h"

#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"

#include <cmath>

namespace waymark {
namespace {

// sin(h) / h and its derivative.
struct Sinc {
  double value;
  double derivative;
};

Sinc SincOf(double h) {
  // Below this the series is exact to double precision (next term h^4 / 120).
  constexpr double kSeriesBelow = 1e-3;
  if (std::abs(h) < kSeriesBelow) {
    return {1.0 - h * h / 6.0 + h * h * h * h / 120.0,
            -h / 3.0 + h * h * h / 30.0};
  }
  return {std::sin(h) / h, (h * std::cos(h) - std::sin(h)) / (h * h)};
}

}  // namespace

DriveStep IntegrateTicks(const WheelTicks& ticks,
                         const WheelParameters& parameters,
                         const DriveNoise& noise,
                         DriveIntegration integration) {
  const double base = parameters.wheel_base;
  WAYMARK_CHECK(base > 0.0 && std::isfinite(base), base);
  WAYMARK_CHECK(std::isfinite(parameters.k_right) &&
                    std::isfinite(parameters.k_left) &&
                    std::isfinite(ticks.right) && std::isfinite(ticks.left),
                parameters.k_right,
                parameters.k_left,
                ticks.right,
                ticks.left);
  const double l_right = parameters.k_right * ticks.right;
  const double l_left = parameters.k_left * ticks.left;
  const double distance = 0.5 * (l_right + l_left);
  const double turn = (l_right - l_left) / base;
  const double half = 0.5 * turn;
  const double c = std::cos(half);
  const double s = std::sin(half);
  const Sinc sinc =
      integration == DriveIntegration::kArc ? SincOf(half) : Sinc{1.0, 0.0};

  DriveStep step;
  step.X_R0R1 = {
      distance * sinc.value * c, distance * sinc.value * s, WrapAngle(turn)};

  // By (distance, turn); the factor 0.5 is d half / d turn.
  Eigen::Matrix<double, 3, 2> d_motion;
  d_motion << sinc.value * c,
      0.5 * distance * (sinc.derivative * c - sinc.value * s), sinc.value * s,
      0.5 * distance * (sinc.derivative * s + sinc.value * c), 0.0, 1.0;
  // (distance, turn) by (l_right, l_left, wheel_base).
  Eigen::Matrix<double, 2, 3> d_travel;
  d_travel << 0.5, 0.5, 0.0, 1.0 / base, -1.0 / base, -turn / base;
  const Eigen::Matrix3d d_wheels = d_motion * d_travel;

  step.d_parameters = d_wheels;
  step.d_parameters.col(0) *= ticks.right;
  step.d_parameters.col(1) *= ticks.left;

  const double travel = 0.5 * (std::abs(l_right) + std::abs(l_left));
  if (travel > 0.0) {
    const Eigen::Vector3d variances(noise.wheel_variance * std::abs(l_right),
                                    noise.wheel_variance * std::abs(l_left),
                                    noise.base_variance / travel);
    step.covariance = d_wheels * variances.asDiagonal() * d_wheels.transpose();
  }
  return step;
}

}  // namespace waymark
