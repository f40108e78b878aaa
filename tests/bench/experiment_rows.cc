#include "tests/bench/experiment_rows.h"

#include "processes/support/configuration.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>

namespace waymark {

std::vector<double> BenchSweep::Figure(const std::string& name) const {
  std::vector<double> values;
  for (const RunResult& result : results) {
    const auto found = std::find_if(
        result.figures.begin(), result.figures.end(), [&](const auto& figure) {
          return figure.first == name;
        });
    if (found == result.figures.end()) throw std::logic_error("no " + name);
    values.push_back(found->second);
  }
  return values;
}

BenchSweep RunSeeds(Experiment* experiment,
                    const std::vector<std::string>& settings,
                    int num_seeds) {
  const DescribeFunction describe = [&](Describer& d) {
    experiment->Describe(d);
  };
  for (const std::string& setting : settings) ApplySetting(setting, describe);
  experiment->Prepare();
  BenchSweep sweep;
  double simulated_s = 0.0;
  const auto start = std::chrono::steady_clock::now();
  for (int seed = 1; seed <= num_seeds; ++seed) {
    sweep.results.push_back(
        experiment->Run(static_cast<std::uint64_t>(seed), ""));
    simulated_s += sweep.results.back().duration_s;
  }
  const std::chrono::duration<double> took =
      std::chrono::steady_clock::now() - start;
  sweep.summary = SummariseRuns(sweep.results);
  sweep.times_real_time = simulated_s / took.count();
  return sweep;
}

BenchRow SweepRow(const std::string& id,
                  const std::string& name,
                  double value,
                  const std::string& unit,
                  const BenchSweep& sweep) {
  BenchRow row;
  row.id = id;
  row.name = name;
  row.value = value;
  row.unit = unit;
  row.runs = sweep.summary.num_runs;
  return row;
}

BenchRow WithGoal(BenchRow row, const std::string& goal, bool holds) {
  row.goal = goal;
  row.holds = holds;
  return row;
}

}  // namespace waymark
