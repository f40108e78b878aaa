// Information on wheels and sensors, with all poses eliminated.
#pragma once

#include "estimation/batch/batch_graph.h"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <vector>

namespace waymark {

struct BatchMarginal {
  // Of (wheels; estimated components of each sensor, in order), wheels as
  // multiples of their initial values.
  Eigen::MatrixXd covariance;
  // Column of each sensor component in the covariance; -1: held.
  std::vector<std::array<int, 4>> sensor_columns;
  double weighted_squares = 0.0;  // Sum over all factors but priors.
  double num_residuals = 0.0;     // Of those, weighted likewise.
};

// Gauss-Newton information of the factors at the state they point into: weight
// 1 for residuals inside the inlier gate, the loss's derivative outside, so
// that the result is the covariance of a least-squares fit to the inliers.
// Nullopt where it is not positive definite.
[[nodiscard]] std::optional<BatchMarginal> ComputeMarginal(
    const BatchInput& input,
    const BatchState& state,
    const std::vector<BatchFactor>& factors);

}  // namespace waymark
