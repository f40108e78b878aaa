// Which estimate belongs to which reference sample.
#pragma once

#include "logs/evaluation/trajectory_types.h"

#include <span>
#include <vector>

namespace waymark {

struct AssociationOptions {
  // A reference sample is used where the two estimates around it are at most
  // this far apart.
  double max_gap_s = 1.0;

  // Throws std::invalid_argument naming the field out of range.
  void Check() const;
};

struct AssociatedPair {
  TruthSample truth;
  EstimatedPose estimate;  // At truth.time.

  // Where the estimate puts the reference's point S: p_WS.
  [[nodiscard]] Eigen::Vector2d EstimatedPoint() const {
    return estimate.X_WR * truth.p_RS;
  }
};

struct Association {
  std::vector<AssociatedPair> pairs;  // In order of time.
  int num_outside = 0;  // Reference samples before the first estimate or after
                        // the last: never extrapolated.
  int num_in_gaps = 0;  // Reference samples in a gap of the estimates.
};

// Gives every reference sample the estimate at its time: the estimate with
// that very time where there is one (the last given of several), otherwise
// linear interpolation of x, y and covariance between the two estimates
// around it, and of the heading along the shorter arc. Neither input needs to
// be sorted; equal times keep their order.
[[nodiscard]] Association Associate(std::span<const TruthSample> truth,
                                    std::span<const EstimatedPose> estimates,
                                    const AssociationOptions& options);

}  // namespace waymark
