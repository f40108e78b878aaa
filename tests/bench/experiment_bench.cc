// Closed loops of the experiments: how often they succeed, and touch.
#include "processes/tools/experiment/drive_experiment.h"
#include "processes/tools/experiment/ram_experiment.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/experiment_rows.h"

#include <string>
#include <vector>

namespace waymark {
namespace {

// Of both experiments.
std::vector<BenchRow> TouchRows(const std::string& id,
                                const std::string& of,
                                const BenchSweep& sweep) {
  const SweepSummary& s = sweep.summary;
  const auto touches = static_cast<double>(s.num_touches);
  return {
      WithGoal(SweepRow(id, of + ": touches", touches, "", sweep),
               "0",
               touches == 0.0),
      SweepRow(id,
               of + ": runs with one, 95 % at most",
               100.0 * (1.0 - s.untouched.low),
               "%",
               sweep),
      // The least that lock-step is to have on a small machine.
      WithGoal(
          SweepRow(
              id, of + ": times real time", sweep.times_real_time, "", sweep),
          ">= 3",
          sweep.times_real_time >= 3.0)};
}

std::vector<BenchRow> BenchDrive(bool full) {
  const std::string id = "experiment-drive";
  std::vector<BenchRow> rows;
  for (const std::string world : {"office_u", "corridor_office"}) {
    DriveExperiment drive;
    const BenchSweep sweep =
        RunSeeds(&drive, {"simulator.world=" + world}, full ? 200 : 10);
    const SweepSummary& s = sweep.summary;
    const auto share =
        static_cast<double>(s.num_successes) / static_cast<double>(s.num_runs);
    rows.push_back(
        SweepRow(id, world + ": success", 100.0 * share, "%", sweep));
    rows.push_back(SweepRow(
        id, world + ": 95 % at least", 100.0 * s.success.low, "%", sweep));
    rows.push_back(SweepRow(
        id, world + ": 95 % at most", 100.0 * s.success.high, "%", sweep));
    rows.push_back(SweepRow(id, world + ": SPL", s.spl, "", sweep));
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
    const BenchSweep sweep =
        RunSeeds(&ram,
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
