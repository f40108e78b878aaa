// What waymark-refine says.
#pragma once

#include "estimation/batch/batch_types.h"

#include <string>
#include <vector>

namespace waymark {

// One solved problem.
struct RefineOutcome {
  std::vector<std::string> logs;  // Paths.
  WheelParameters nominal;
  BatchResult result;
  // The problem with all parameters held at their nominal values: what the
  // residuals were before. Same measurements.
  double nominal_cost = 0.0;
  int num_bad = 0;  // Messages that could not be used.
};

[[nodiscard]] std::string RefineTable(const RefineOutcome& outcome);
[[nodiscard]] std::string RefineJson(const std::vector<RefineOutcome>& all);

}  // namespace waymark
