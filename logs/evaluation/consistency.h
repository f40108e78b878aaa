// Does an estimate's covariance tell the truth? Normalised estimation error
// squared (NEES) and its chi-square bands.
#pragma once

#include "logs/evaluation/association.h"

#include <optional>
#include <span>
#include <vector>

namespace waymark {

// The x with P(X <= x) = probability for a chi-square variable with `dof`
// degrees of freedom, to 1e-10 relative. Throws std::logic_error unless
// 0 < probability < 1 and dof > 0.
[[nodiscard]] double ChiSquareQuantile(double probability, double dof);

struct Band {
  double low = 0.0;
  double high = 0.0;
};
// Two-sided band that holds the mean of `num_runs` independent NEES values of
// `dof` dimensions with `probability` [1, section 5.4.2].
//
// [1] Y. Bar-Shalom, X. R. Li, T. Kirubarajan. Estimation with applications to
//     tracking and navigation. Wiley, 2001.
[[nodiscard]] Band NeesBand(int dof, int num_runs, double probability = 0.95);

// NEES of one path: e' P^-1 e with e the error of (p_WS) or of (p_WS, heading)
// and P its covariance, the pose's carried to S. Without alignment: an
// estimate that needs one is not consistent.
struct Nees {
  int dof = 0;  // 2: position; 3: pose.
  std::vector<Time> times;
  std::vector<double> values;
  Band band;  // For one run.
  // Shares of the steps; they sum to 1.
  double share_inside = 0.0;
  double share_below = 0.0;  // Covariance larger than the error calls for.
  double share_above = 0.0;  // Over-confident.
  double mean = 0.0;         // Consistent: dof.
  int num_unusable = 0;      // Pairs whose covariance is not positive definite.
};

// nullopt where no pair has a usable covariance (and, for dof 3, a heading).
[[nodiscard]] std::optional<Nees> EvaluateNees(
    std::span<const AssociatedPair> pairs, int dof);

}  // namespace waymark
