// Measurement model of an absolute fix.
#pragma once

#include "estimation/filter/measurement_types.h"

#include <Eigen/Core>

namespace waymark {

// As many rows as the fix has components: 1 to 3. No heap.
using FixVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;
using FixMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;

struct FixPrediction {
  FixVector residual;  // Measured minus expected; heading wrapped.
  FixMatrix d_pose;    // Derivative of what is expected by (x, y, heading).
  FixMatrix covariance;
};

// What the present components of X_FS = X_WF^-1 * X_WR * X_RS should be.
[[nodiscard]] FixPrediction PredictFix(const AbsoluteFix& fix,
                                       const Pose2& X_WR);

}  // namespace waymark
