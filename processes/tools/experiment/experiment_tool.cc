#include "processes/tools/experiment/experiment_tool.h"

#include "estimation/base/input_error.h"
#include "processes/support/configuration.h"
#include "processes/support/output_file.h"
#include "processes/support/run_tool.h"
#include "processes/support/state_file.h"
#include "processes/tools/experiment/results_file.h"
#include "processes/tools/experiment/sweep.h"
#include "processes/tools/experiment/sweep_report.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <set>
#include <string>
#include <system_error>

namespace waymark {
namespace {

struct Request {
  std::string config;
  std::vector<std::string> settings;
  std::int64_t num_seeds = 20;
  std::int64_t first_seed = 1;
  int num_jobs = 1;
  int num_worst = 3;
  std::string out;
  std::string json;
  bool prints_config = false;
};

// Behind the name of a log until its run has ended.
constexpr const char* kUnfinished = ".part";

std::string WorstFolder(const Request& request) {
  return request.out + "/worst";
}

void MakeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw InputError(path + ": " + error.message());
}

std::string LogOf(const std::string& folder, std::uint64_t seed) {
  return folder + "/seed_" + std::to_string(seed) + ".lcm";
}

// Removes the logs of all other seeds, and what a run that was stopped left.
void KeepLogsOf(const std::set<std::uint64_t>& seeds,
                const std::string& folder) {
  std::set<std::string> kept;
  for (const std::uint64_t seed : seeds) {
    kept.insert(std::filesystem::path(LogOf(folder, seed)).filename().string());
  }
  std::error_code ignored;
  for (const auto& entry :
       std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool is_ours =
        name.starts_with("seed_") &&
        (name.ends_with(".lcm") || name.ends_with(kUnfinished));
    if (is_ours && !kept.contains(name)) {
      std::filesystem::remove(entry.path(), ignored);
    }
  }
}

// The worst runs once more, with a log: they come out the same. A log that is
// there is whole, and of this result; logs of runs that are no longer among the
// worst go.
void KeepWorst(const Experiment& experiment,
               const std::vector<RunResult>& results,
               const Request& request) {
  const std::string folder = WorstFolder(request);
  const auto worst = WorstSeeds(results, request.num_worst);
  KeepLogsOf({worst.begin(), worst.end()}, folder);
  for (const std::uint64_t seed : worst) {
    const std::string log = LogOf(folder, seed);
    const auto result = std::find_if(
        results.begin(), results.end(), [seed](const RunResult& r) {
          return r.seed == seed;
        });
    std::string reason = result->reason;
    if (!std::filesystem::exists(log)) {
      MakeFolder(folder);
      const std::string unfinished = log + kUnfinished;
      try {
        reason = experiment.Run(seed, unfinished).reason;
      } catch (const std::exception& error) {
        reason = error.what();  // The log ends where it failed.
      }
      std::error_code error;
      // It may have failed before the first message.
      if (std::filesystem::exists(unfinished)) {
        std::filesystem::rename(unfinished, log, error);
      }
      if (error) throw InputError(log + ": " + error.message());
    }
    std::printf(
        "  %s%s%s\n", log.c_str(), reason.empty() ? "" : ": ", reason.c_str());
  }
}

void RunExperiment(const ExperimentClass& experiment_class,
                   Request request,
                   int* exit_code) {
  const std::unique_ptr<Experiment> experiment = experiment_class.make();
  const DescribeFunction describe = [&](Describer& d) {
    experiment->Describe(d);
  };
  if (!request.config.empty()) LoadConfigurationFile(request.config, describe);
  for (const std::string& setting : request.settings) {
    ApplySetting(setting, describe);
  }
  const std::string configuration = PrintConfiguration(describe);
  if (request.prints_config) {
    std::fputs(configuration.c_str(), stdout);
    return;
  }
  try {
    experiment->Prepare();
  } catch (const std::invalid_argument& error) {
    throw InputError(experiment_class.name + ": " + error.what());
  }
  if (request.out.empty()) {
    request.out = "out/experiments/" + experiment_class.name;
  }
  if (!request.json.empty()) {
    CheckOutput(request.json, IfExists::kReplace, {});
  }
  MakeFolder(request.out);
  SweepOptions options;
  options.seeds.resize(static_cast<std::size_t>(request.num_seeds));
  std::iota(options.seeds.begin(),
            options.seeds.end(),
            static_cast<std::uint64_t>(request.first_seed));
  options.num_jobs = request.num_jobs;
  ResultsFile file(request.out + "/runs.jsonl",
                   experiment_class.name,
                   configuration + experiment->Subject() + ", Waymark " +
                       WAYMARK_VERSION + "\n");
  // A log without its result is of another configuration.
  std::set<std::uint64_t> known;
  for (const auto& [seed, result] : file.results()) known.insert(seed);
  KeepLogsOf(known, WorstFolder(request));
  const SweepReport sweep = RunSweep(*experiment, options, &file);
  const SweepSummary summary = SummariseRuns(sweep.results);
  const std::string json =
      SweepJson(experiment_class.name, configuration, summary, sweep.results);
  SaveStateFile(request.out + "/report.json", json);
  if (!request.json.empty()) SaveStateFile(request.json, json);
  std::fputs(SweepTable(experiment_class.name, summary).c_str(), stdout);
  if (!sweep.is_complete) {
    std::printf("interrupted after %zu of %zu runs; the same command goes on\n",
                sweep.results.size(),
                options.seeds.size());
    *exit_code = 1;
    return;
  }
  KeepWorst(*experiment, sweep.results, request);
  if (sweep.has_crashed) *exit_code = 1;
}

}  // namespace

int RunExperimentTool(int argc,
                      char** argv,
                      const std::vector<ExperimentClass>& experiments) {
  Request request;
  return RunTool(
      argc,
      argv,
      "waymark-experiment",
      "Runs a closed loop in the simulator once per seed, in lock-step, and "
      "counts what comes of it. A run that was stopped goes on where it was "
      "when it is started again.",
      [&](CLI::App* app, int* exit_code) {
        app->require_subcommand(1);
        for (const ExperimentClass& experiment : experiments) {
          CLI::App* command =
              app->add_subcommand(experiment.name, experiment.help);
          command->add_option("--seeds", request.num_seeds, "How many runs")
              ->check(CLI::Range(1, 1'000'000))
              ->capture_default_str();
          command
              ->add_option("--first-seed", request.first_seed, "Of the first")
              ->check(CLI::Range(0, 1'000'000'000))
              ->capture_default_str();
          command
              ->add_option("--jobs",
                           request.num_jobs,
                           "Runs at a time; changes no result")
              ->check(CLI::Range(1, 256))
              ->capture_default_str();
          command->add_option("--out",
                              request.out,
                              "Folder of the results (default: "
                              "out/experiments/" +
                                  experiment.name + ")");
          command
              ->add_option("--keep-worst",
                           request.num_worst,
                           "Logs of so many of the worst runs that failed or "
                           "touched something")
              ->check(CLI::Range(0, 1000))
              ->capture_default_str();
          command->add_option(
              "--json", request.json, "The report there too (replaced)");
          command->add_option("--config", request.config, "Configuration file");
          command
              ->add_option("--set", request.settings, "key=value, repeatable")
              ->allow_extra_args(false);
          command->add_flag(
              "--print-config", request.prints_config, "All values, no run");
          command->callback([&request, experiment, exit_code] {
            RunExperiment(experiment, request, exit_code);
          });
        }
      });
}

}  // namespace waymark
