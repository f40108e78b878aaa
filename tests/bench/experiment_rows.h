// Rows of benchmarks from experiments.
#pragma once

#include "processes/tools/experiment/experiment.h"
#include "processes/tools/experiment/sweep_report.h"
#include "tests/bench/bench_report.h"

#include <string>
#include <vector>

namespace waymark {

struct BenchSweep {
  std::vector<RunResult> results;
  SweepSummary summary;
  double times_real_time = 0.0;

  // Of all runs, in order. Throws std::logic_error where there is none of that
  // name.
  [[nodiscard]] std::vector<double> Figure(const std::string& name) const;
};

// Seeds 1 to num_seeds, after `settings` (key=value).
[[nodiscard]] BenchSweep RunSeeds(Experiment* experiment,
                                  const std::vector<std::string>& settings,
                                  int num_seeds);

// The same, for runs that take minutes: on all cores, with progress. Each
// result is on disk as soon as it is there, under out/bench, and a bench that
// was stopped goes on from it, as long as its executable is the same.
// times_real_time is not known. `name`: of the file. Throws std::runtime_error
// where it is interrupted or a run crashes.
[[nodiscard]] BenchSweep RunSeedsInParts(
    Experiment* experiment,
    const std::vector<std::string>& settings,
    int num_seeds,
    const std::string& name);

[[nodiscard]] BenchRow SweepRow(const std::string& id,
                                const std::string& name,
                                double value,
                                const std::string& unit,
                                const BenchSweep& sweep);
[[nodiscard]] BenchRow WithGoal(BenchRow row,
                                const std::string& goal,
                                bool holds);

}  // namespace waymark
