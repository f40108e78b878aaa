// What of a recording's reference an estimator may see, and what is kept to
// judge it by.
#pragma once

#include "estimation/filter/measurement_types.h"
#include "logs/import/recording.h"

#include <cstdint>
#include <vector>

namespace waymark {

enum class ReferenceUse {
  // Every k-th sample, with added noise, is a measurement; the others are the
  // truth. Results are 'reference-aided'.
  kRunning,
  // Every sample is a measurement as recorded, none is truth: what is
  // calibrated with it is scored on other runs.
  kCalibration,
};

struct ReferenceSplitOptions {
  ReferenceUse use = ReferenceUse::kRunning;
  int every = 10;           // kRunning: samples 0, every, 2 every... are fixes.
  double noise_m = 0.02;    // kRunning: added to x and y each, sigma.
  double noise_rad = 0.01;  // kRunning: added to the heading, sigma.
  std::uint64_t seed = 1;
  bool use_heading = false;  // Fixes carry the reference's heading too.

  // Throws std::invalid_argument naming the first field out of range: every
  // in [1, 1e6], noises in [0, 10].
  void Check() const;
};

struct ReferenceSplit {
  std::vector<AbsoluteFix> fixes;
  std::vector<TruthSample> truth;
};

// Splits by the options. A fix's covariance is that of the reference plus that
// of the added noise; its source starts with "reference" and says which
// samples and what noise. Same input and options, same result. Throws as Check
// does, and std::invalid_argument where headings are asked for and there are
// none.
[[nodiscard]] ReferenceSplit SplitReference(
    const Reference& reference, const ReferenceSplitOptions& options);

}  // namespace waymark
