// Two ways to write the wheel parameters inside an estimator.
#pragma once

#include "estimation/filter/differential_drive.h"

#include <Eigen/Core>

namespace waymark {

enum class ParameterForm {
  // (k_right, k_left, B): equation 5 of [1] as published.
  kTravel,
  // (a, b, s) = (k_right / B, k_left / B, (k_right + k_left) / 2). Heading is
  // linear in a and b, travel nearly linear in s and nearly independent of a
  // and b, so an estimator that starts far off still linearises well. Back:
  // B = 2 s / (a + b), k_right = a B, k_left = b B.
  kTurn,
};

// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] inline Eigen::Vector3d FormFromParameters(
    const WheelParameters& p, ParameterForm form) {
  if (form == ParameterForm::kTravel) return p.vector();
  return {p.k_right / p.wheel_base,
          p.k_left / p.wheel_base,
          0.5 * (p.k_right + p.k_left)};
}

[[nodiscard]] inline WheelParameters ParametersFromForm(
    const Eigen::Vector3d& q, ParameterForm form) {
  if (form == ParameterForm::kTravel) return WheelParameters::FromVector(q);
  const double base = 2.0 * q(2) / (q(0) + q(1));
  return {q(0) * base, q(1) * base, base};
}

// Derivative of (k_right, k_left, B) by the form, at q.
[[nodiscard]] inline Eigen::Matrix3d ParametersByForm(const Eigen::Vector3d& q,
                                                      ParameterForm form) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  if (form == ParameterForm::kTurn) {
    const double sum = q(0) + q(1);
    const double base = 2.0 * q(2) / sum;
    const double slope = base / sum;                     // -dB/da = -dB/db.
    J << slope * q(1), -slope * q(0), 2.0 * q(0) / sum,  //
        -slope * q(1), slope * q(0), 2.0 * q(1) / sum,   //
        -slope, -slope, 2.0 / sum;
  }
  return J;
}

// Derivative of the form by (k_right, k_left, B), at q.
[[nodiscard]] inline Eigen::Matrix3d FormByParameters(const Eigen::Vector3d& q,
                                                      ParameterForm form) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  if (form == ParameterForm::kTurn) {
    const double base = 2.0 * q(2) / (q(0) + q(1));
    J << 1.0 / base, 0.0, -q(0) / base,  //
        0.0, 1.0 / base, -q(1) / base,   //
        0.5, 0.5, 0.0;
  }
  return J;
}

}  // namespace waymark
