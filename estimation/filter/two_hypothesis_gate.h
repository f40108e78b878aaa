// Is a measurement a regular one? Two hypotheses weighed by Bayes' rule.
#pragma once

#include "estimation/filter/odometry_ekf.h"

#include <array>

namespace waymark {

struct GateOptions {
  // A measurement is accepted where P(regular | measurement) exceeds this.
  double min_regular = 0.95;
  // Share of regular measurements. Above min_regular, so that a filter that
  // knows too little to tell still accepts.
  double prior_regular = 0.98;
  // Error of a faulty measurement: far beyond the regular one's.
  double faulty_position_sigma = 1.0;  // m.
  double faulty_heading_sigma = 0.5;   // rad.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// P(regular | innovation) by [1, section III.D]: both hypotheses expect the
// innovation to be normal about 0, the regular one with covariance HPH + R,
// the faulty one with HPH + R + diag(faulty sigma^2). `has` says which of
// (x, y, heading) the innovation is of. 0 where the covariance
// is not positive definite or the innovation is not finite.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] double RegularProbability(const std::array<bool, 3>& has,
                                        const Innovation& innovation,
                                        const GateOptions& options);

}  // namespace waymark
