#include "logs/report/evaluation_commands.h"

#include "logs/evaluation/evaluation_text.h"
#include "logs/report/html_report.h"
#include "processes/support/output_file.h"
#include "processes/support/run_tool.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

struct ScoreOptions {
  double max_gap_s = AssociationOptions{}.max_gap_s;
  double rpe_m = 1.0;
  double rpe_s = 1.0;
  std::vector<double> parameters;

  void Declare(CLI::App* command) {
    const auto add =
        [command](const char* flag, auto* value, const char* description) {
          return RequireRange(
              command->add_option(flag, *value, description), 1e-6, 1e9);
        };
    add("--max-gap-s",
        &max_gap_s,
        "Widest gap of an estimate to interpolate across, s")
        ->capture_default_str();
    add("--rpe-m", &rpe_m, "Length of path of relative errors, m")
        ->capture_default_str();
    add("--rpe-s", &rpe_s, "Time of relative errors, s")->capture_default_str();
    add("--parameters",
        &parameters,
        "Known wheel parameters to compare with: k_right k_left "
        "(m per tick) wheel_base (m). Default: the batch result")
        ->expected(3);
  }

  [[nodiscard]] EvaluationOptions Build() const {
    EvaluationOptions options;
    options.association.max_gap_s = max_gap_s;
    options.relative_errors[0].delta = rpe_m;
    options.relative_errors[1].delta = rpe_s;
    if (!parameters.empty()) {
      options.known_parameters = {parameters[0], parameters[1], parameters[2]};
    }
    return options;
  }
};

LogEvaluation EvaluateFiles(const std::vector<std::string>& paths,
                            const ScoreOptions& score) {
  return EvaluateRecording(ReadRecording(paths), score.Build());
}

// What is written where; "-" is standard output.
struct Outputs {
  std::string json;
  std::string page;
  bool force = false;

  void Declare(CLI::App* command) {
    command->add_flag("-f,--force", force, "Replace outputs that exist");
  }
  [[nodiscard]] IfExists if_exists() const {
    return force ? IfExists::kReplace : IfExists::kFail;
  }
  // Before the work, so that it is not done in vain.
  void Check(const std::vector<std::string>& inputs) const {
    for (const std::string& path : {json, page}) {
      if (path.empty() || path == "-") continue;
      CheckOutput(path, if_exists(), inputs);
    }
  }
  void Write(const std::string& path, const std::string& text) const {
    if (path == "-") {
      std::fwrite(text.data(), 1, text.size(), stdout);
      return;
    }
    OutputFile file(path, if_exists());
    file.Write(text);
    file.Close();
  }
};

std::string Dump(const nlohmann::json& json) {
  // Names of channels and sources are bytes of others: never throw on them.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

}  // namespace

void AddEvaluateCommand(CLI::App* app, int* exit_code) {
  (void)exit_code;
  struct Options {
    std::string log;
    std::vector<std::string> inputs;
    Outputs outputs;
    ScoreOptions score;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app->add_subcommand(
      "evaluate",
      "Scores the estimates in a log against its TRUTH: absolute and relative "
      "error, NEES, parameters, latency, losses");
  command->add_option("LOG", options->log, "LCM log")->required();
  command->add_option("--inputs",
                      options->inputs,
                      "Further logs, read as if they were part of LOG: the "
                      "inputs where LOG holds outputs only");
  command->add_option("--json",
                      options->outputs.json,
                      "Write the evaluation as JSON too; - instead of the "
                      "table");
  options->outputs.Declare(command);
  options->score.Declare(command);
  command->callback([options] {
    std::vector<std::string> paths{options->log};
    paths.insert(paths.end(), options->inputs.begin(), options->inputs.end());
    const Outputs& outputs = options->outputs;
    outputs.Check(paths);
    const LogEvaluation evaluation = EvaluateFiles(paths, options->score);
    if (outputs.json != "-") outputs.Write("-", TableOf(evaluation));
    if (!outputs.json.empty()) {
      outputs.Write(outputs.json, Dump(JsonOf(evaluation)));
    }
  });
}

void AddReportCommand(CLI::App* app, int* exit_code) {
  (void)exit_code;
  struct Options {
    std::vector<std::string> logs;
    std::vector<std::pair<std::string, std::string>> pictures;
    Outputs outputs;
    ScoreOptions score;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app->add_subcommand(
      "report",
      "Evaluates logs and draws one HTML page that opens offline; prints the "
      "summary");
  command->add_option("LOG", options->logs, "LCM logs, a section each")
      ->required();
  command->add_option("--out", options->outputs.page, "The page")->required();
  command
      ->add_option("--picture",
                   options->pictures,
                   "A .png or .jpg to show above all, such as a plan, and its "
                   "caption; may be repeated")
      ->type_name("FILE CAPTION");
  command->add_option("--json",
                      options->outputs.json,
                      "Write the evaluations as a JSON list too; - instead of "
                      "the summary");
  options->outputs.Declare(command);
  options->score.Declare(command);
  command->callback([options] {
    const Outputs& outputs = options->outputs;
    outputs.Check(options->logs);
    std::vector<ReportPicture> pictures;
    for (const auto& [file, caption] : options->pictures) {
      pictures.push_back(LoadReportPicture(file, caption));
    }
    std::vector<LogEvaluation> evaluations;
    nlohmann::json list = nlohmann::json::array();
    for (const std::string& log : options->logs) {
      evaluations.push_back(EvaluateFiles({log}, options->score));
      list.push_back(JsonOf(evaluations.back()));
    }
    outputs.Write(outputs.page, HtmlReport(evaluations, pictures));
    if (!outputs.json.empty()) outputs.Write(outputs.json, Dump(list));
    if (outputs.json != "-") outputs.Write("-", SummaryTableOf(evaluations));
  });
}

}  // namespace waymark
