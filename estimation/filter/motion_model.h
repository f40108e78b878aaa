// Measurement model of a relative motion.
#pragma once

#include "estimation/filter/measurement_types.h"

#include <Eigen/Core>

namespace waymark {

struct MotionPrediction {
  Eigen::Vector3d residual;  // Measured minus expected; heading wrapped.
  // Derivatives of what is expected by (x, y, heading) of X_WR at its start,
  // at its end, and of X_RS.
  Eigen::Matrix3d d_from;
  Eigen::Matrix3d d_to;
  Eigen::Matrix3d d_mounting;
};

// What X_S0S1 = (X_WR0 * X_RS)^-1 * X_WR1 * X_RS should be.
[[nodiscard]] MotionPrediction PredictMotion(const RelativeMotion& motion,
                                             const Pose2& X_WR0,
                                             const Pose2& X_WR1);

}  // namespace waymark
