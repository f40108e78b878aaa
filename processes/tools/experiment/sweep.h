// Runs an experiment over many seeds, in several processes at a time.
#pragma once

#include "processes/tools/experiment/experiment.h"
#include "processes/tools/experiment/results_file.h"

#include <cstdint>
#include <vector>

namespace waymark {

struct SweepOptions {
  std::vector<std::uint64_t> seeds;
  int num_jobs = 1;
};

struct SweepReport {
  std::vector<RunResult> results;  // Of all seeds asked for, in their order.
  bool is_complete = true;         // False: interrupted by a signal.
  bool has_crashed = false;        // Any of them.
};

// Runs what `file` does not hold yet, each seed in a process of its own, so
// that one that crashes is a failed run and no more, and adds each result to
// `file` as it comes. Shows how far it is. What comes out does not depend on
// num_jobs. The calling process has no other threads. `experiment` is prepared.
[[nodiscard]] SweepReport RunSweep(const Experiment& experiment,
                                   const SweepOptions& options,
                                   ResultsFile* file);

}  // namespace waymark
