// A small log as a run of pose_filter and batch_refiner would leave it, with
// estimates made from the truth, so that every score is known beforehand.
#pragma once

#include "estimation/filter/differential_drive.h"

#include <cstdint>
#include <string>

namespace waymark {

struct SyntheticLogOptions {
  WheelParameters true_parameters{1e-4, 1.02e-4, 0.27};
  WheelParameters nominal_parameters{1.03e-4, 1e-4, 0.25};
  double duration_s = 60.0;
  double pose_sigma_m = 0.01;  // Of POSE and POSE_SETTLED, each axis.
  double pose_sigma_rad = 0.01;
  double latency_s = 0.003;  // Log time minus utime of outputs.
  bool has_truth = true;
  bool has_truth_heading = true;
  bool has_estimates = true;
  // Why batch_refiner had no answer; empty: it had one.
  std::string no_batch{};
  std::string fix_source = "reference, every 10th";
  std::uint64_t seed = 1;
};

// Event times are utimes plus a day (a replay is recorded later than the run),
// plus the latency for outputs. With latency 0 the log is as made offline.
void WriteSyntheticLog(const std::string& path,
                       const SyntheticLogOptions& options);

}  // namespace waymark
