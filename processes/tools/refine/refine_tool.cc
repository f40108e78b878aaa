#include "processes/tools/refine/refine_tool.h"

#include "estimation/base/input_error.h"
#include "estimation/batch/batch_refiner.h"
#include "processes/batch_refiner/batch_refiner_process.h"
#include "processes/pose_filter/parameter_file.h"
#include "processes/support/configuration.h"
#include "processes/support/output_file.h"
#include "processes/support/run_tool.h"
#include "processes/tools/refine/refine_log.h"
#include "processes/tools/refine/refine_report.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace waymark {
namespace {

// Keys of --set: those of batch_refiner's solver, and the wheels.
struct RefineConfig {
  std::vector<double> nominal;
  double max_wheel_speed = 5.0;
  BatchSolverConfig solver;

  void Describe(Describer& d) {
    d.Numbers(
        "nominal",
        &nominal,
        3,
        "k_right m/tick, k_left m/tick, wheel base m; empty: from the log");
    d.Number("max_wheel_speed",
             &max_wheel_speed,
             kPositive,
             "A faster count is an encoder jump, m/s");
    solver.Describe(d);
  }
  void Check() const {
    if (!nominal.empty() &&
        *std::min_element(nominal.begin(), nominal.end()) <= 0.0) {
      throw std::invalid_argument("nominal: all three must be positive");
    }
    solver.Check();
  }
};

struct Request {
  std::vector<std::string> logs;
  std::vector<std::string> settings;
  bool is_joint = false;
  bool replace = false;
  std::string json;
  std::string out;
};

WheelParameters NominalOf(const RefineConfig& config, const RefineLog& log) {
  if (!config.nominal.empty()) {
    return {config.nominal[0], config.nominal[1], config.nominal[2]};
  }
  if (!log.nominal) {
    throw InputError(log.path +
                     ": states no nominal wheel parameters; give them with "
                     "--set nominal=[k_right,k_left,wheel_base]");
  }
  return *log.nominal;
}

RefineOutcome Refine(const std::vector<const RefineLog*>& logs,
                     const RefineConfig& config) {
  RefineOutcome outcome;
  outcome.nominal = NominalOf(config, *logs[0]);
  std::vector<BatchLog> problem;
  for (const RefineLog* log : logs) {
    outcome.logs.push_back(log->path);
    outcome.num_bad += log->num_bad;
    problem.push_back(log->log);
  }
  // Robots are re-fitted between logs; within one nothing moves.
  BatchOptions options = config.solver.Options(outcome.nominal, false);
  outcome.result = RefineBatch(problem, options);
  // Before: the same with everything held where it is nominal.
  constexpr double kHeld = 1e-9;
  options.relative_sigma.setConstant(kHeld);
  for (BatchSensorOptions& sensor : options.sensors) {
    sensor.position = sensor.yaw = sensor.time_offset = false;
  }
  outcome.nominal_cost = RefineBatch(problem, options).final_cost;
  return outcome;
}

void Run(const Request& request, int* exit_code) {
  RefineConfig config;
  LoadConfiguration("", request.settings, &config);
  if (!request.out.empty() && request.logs.size() > 1 && !request.is_joint) {
    throw InputError("--out takes one result: give one log, or --joint");
  }
  const IfExists if_exists =
      request.replace ? IfExists::kReplace : IfExists::kFail;
  for (const std::string& path : {request.json, request.out}) {
    if (!path.empty()) CheckOutput(path, if_exists, request.logs);
  }
  std::vector<RefineLog> logs;
  for (const std::string& path : request.logs) {
    logs.push_back(ReadRefineLog(path, config.max_wheel_speed));
  }
  std::vector<RefineOutcome> outcomes;
  if (request.is_joint) {
    std::vector<const RefineLog*> all;
    for (const RefineLog& log : logs) all.push_back(&log);
    outcomes.push_back(Refine(all, config));
  } else {
    for (const RefineLog& log : logs)
      outcomes.push_back(Refine({&log}, config));
  }
  for (const RefineOutcome& outcome : outcomes) {
    std::fputs(RefineTable(outcome).c_str(), stdout);
  }
  if (!request.json.empty()) {
    OutputFile file(request.json, if_exists);
    file.Write(RefineJson(outcomes));
    file.Close();
  }
  const BatchResult& first = outcomes[0].result;
  if (!request.out.empty() && HasAnswer(first.status)) {
    SaveParameterFile(request.out, ParametersFromResult(first));
  }
  for (const RefineOutcome& outcome : outcomes) {
    if (!HasAnswer(outcome.result.status)) {
      throw InputError(outcome.logs[0] +
                       ": no answer: " + outcome.result.reason);
    }
  }
  *exit_code = 0;
}

}  // namespace

int RunRefineTool(int argc, char** argv) {
  Request request;
  RefineConfig defaults;
  return RunTool(
      argc,
      argv,
      "waymark-refine",
      "Wheel parameters, sensor mounting and time offset from recorded logs.\n"
      "Keys of --set:\n" +
          PrintConfiguration([&](Describer& d) { defaults.Describe(d); }),
      [&](CLI::App* app, int* exit_code) {
        app->add_option("LOG", request.logs, "Recorded logs")->required();
        app->add_flag("--joint",
                      request.is_joint,
                      "One solution over all logs: same wheels, a mounting of "
                      "each sensor per log");
        app->add_option("--set", request.settings, "key=value; may be repeated")
            ->take_all()
            ->allow_extra_args(false);
        app->add_option("--json", request.json, "Results as JSON");
        app->add_option("--out",
                        request.out,
                        "Wheel parameters as YAML that pose_filter loads "
                        "(parameters_file)");
        app->add_flag(
            "-f,--force", request.replace, "Replace outputs that exist");
        app->callback([&, exit_code] { Run(request, exit_code); });
      });
}

}  // namespace waymark
