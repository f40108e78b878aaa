// What many runs of an experiment come to.
#pragma once

#include "estimation/base/statistics.h"
#include "processes/tools/experiment/experiment.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace waymark {

struct SweepSummary {
  std::int64_t num_runs = 0;
  std::int64_t num_successes = 0;
  Interval success;                // 95 %, as a share.
  std::int64_t num_touches = 0;    // In all runs.
  std::int64_t num_untouched = 0;  // Runs without any.
  Interval untouched;
  bool has_goals = false;     // Any shortest_m above 0; else the next two say
                              // nothing.
  double spl = 0.0;           // Success weighted by path length.
  Summary way_over_shortest;  // Of successful runs.
  Summary way_m;              // Of all.
  Summary duration_s;         // Of successful runs.
  // Of all runs that have them.
  std::vector<std::pair<std::string, Summary>> figures;
  std::map<std::string, std::int64_t> reasons;  // Of what was no success.
};

[[nodiscard]] SweepSummary SummariseRuns(std::span<const RunResult> results);

// Seeds, worst run first: without success before with, then more touches, then
// the longer detour; at most `num`. None that succeeded without a touch.
[[nodiscard]] std::vector<std::uint64_t> WorstSeeds(
    std::span<const RunResult> results, int num);

// Both end with a line end. The JSON has the configuration, the summary and
// every run; neither says when or how fast it was made: same runs, same bytes.
[[nodiscard]] std::string SweepTable(const std::string& name,
                                     const SweepSummary& summary);
[[nodiscard]] std::string SweepJson(const std::string& name,
                                    const std::string& configuration,
                                    const SweepSummary& summary,
                                    std::span<const RunResult> results);

}  // namespace waymark
