// Closed loops of the experiments: how often they succeed, and touch.
#include "processes/support/configuration.h"
#include "processes/tools/experiment/drive_experiment.h"
#include "processes/tools/experiment/ram_experiment.h"
#include "processes/tools/experiment/sweep_report.h"
#include "tests/bench/bench_report.h"

#include <chrono>
#include <string>
#include <vector>

namespace waymark {
namespace {

struct Sweep {
  SweepSummary summary;
  double times_real_time = 0.0;
};

Sweep RunAll(Experiment* experiment,
             const std::vector<std::string>& settings,
             int num_seeds) {
  const DescribeFunction describe = [&](Describer& d) {
    experiment->Describe(d);
  };
  for (const std::string& setting : settings) ApplySetting(setting, describe);
  experiment->Prepare();
  std::vector<RunResult> results;
  double simulated_s = 0.0;
  const auto start = std::chrono::steady_clock::now();
  for (int seed = 1; seed <= num_seeds; ++seed) {
    results.push_back(experiment->Run(static_cast<std::uint64_t>(seed), ""));
    simulated_s += results.back().duration_s;
  }
  const std::chrono::duration<double> took =
      std::chrono::steady_clock::now() - start;
  return {SummariseRuns(results), simulated_s / took.count()};
}

BenchRow Row(const std::string& id,
             const std::string& name,
             double value,
             const std::string& unit,
             const Sweep& sweep) {
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

// Of both experiments.
std::vector<BenchRow> TouchRows(const std::string& id,
                                const std::string& of,
                                const Sweep& sweep) {
  const SweepSummary& s = sweep.summary;
  const auto touches = static_cast<double>(s.num_touches);
  return {
      WithGoal(
          Row(id, of + ": touches", touches, "", sweep), "0", touches == 0.0),
      Row(id,
          of + ": runs with one, 95 % at most",
          100.0 * (1.0 - s.untouched.low),
          "%",
          sweep),
      // The least that lock-step is to have on a small machine.
      WithGoal(
          Row(id, of + ": times real time", sweep.times_real_time, "", sweep),
          ">= 3",
          sweep.times_real_time >= 3.0)};
}

std::vector<BenchRow> BenchDrive(bool full) {
  const std::string id = "experiment-drive";
  std::vector<BenchRow> rows;
  for (const std::string world : {"office_u", "corridor_office"}) {
    DriveExperiment drive;
    const Sweep sweep =
        RunAll(&drive, {"simulator.world=" + world}, full ? 200 : 10);
    const SweepSummary& s = sweep.summary;
    const auto share =
        static_cast<double>(s.num_successes) / static_cast<double>(s.num_runs);
    rows.push_back(Row(id, world + ": success", 100.0 * share, "%", sweep));
    rows.push_back(
        Row(id, world + ": 95 % at least", 100.0 * s.success.low, "%", sweep));
    rows.push_back(
        Row(id, world + ": 95 % at most", 100.0 * s.success.high, "%", sweep));
    rows.push_back(Row(id, world + ": SPL", s.spl, "", sweep));
    for (const BenchRow& row : TouchRows(id, world, sweep)) {
      rows.push_back(row);
    }
  }
  return rows;
}

std::vector<BenchRow> BenchRam(bool full) {
  const std::string id = "experiment-ram";
  std::vector<BenchRow> rows;
  for (const std::string kind : {"sonar", "lidar"}) {
    RamExperiment ram;
    const Sweep sweep =
        RunAll(&ram,
               {"simulator.world=random", "simulator.ranges.kind=" + kind},
               full ? 1000 : 20);
    for (const BenchRow& row :
         TouchRows(id, "random worlds by " + kind, sweep)) {
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  return waymark::RunBenches(
      argc,
      argv,
      "experiment",
      {{"experiment-drive",
        "to random goals through offices, without vision",
        waymark::BenchDrive},
       {"experiment-ram",
        "full speed in random directions through collision_guard",
        waymark::BenchRam}});
}
