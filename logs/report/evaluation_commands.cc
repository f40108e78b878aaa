#include "logs/report/evaluation_commands.h"

#include "logs/evaluation/evaluation_text.h"
#include "logs/report/html_report.h"
#include "processes/support/input_error.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>

namespace waymark {
namespace {

struct ScoreOptions {
  double max_gap_s = AssociationOptions{}.max_gap_s;
  double rpe_m = 1.0;
  double rpe_s = 1.0;
  std::vector<double> parameters;

  void Declare(CLI::App* command) {
    const CLI::Range positive(1e-6, 1e9);
    command
        ->add_option("--max-gap-s",
                     max_gap_s,
                     "Widest gap of an estimate to interpolate across, s")
        ->check(positive)
        ->capture_default_str();
    command
        ->add_option("--rpe-m", rpe_m, "Length of path of relative errors, m")
        ->check(positive)
        ->capture_default_str();
    command->add_option("--rpe-s", rpe_s, "Time of relative errors, s")
        ->check(positive)
        ->capture_default_str();
    command
        ->add_option("--parameters",
                     parameters,
                     "Known wheel parameters to compare with: k_right k_left "
                     "(m per tick) wheel_base (m). Default: the batch result")
        ->expected(3)
        ->check(positive);
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

void WriteText(const std::string& path, const std::string& text) {
  if (path == "-") {
    std::fwrite(text.data(), 1, text.size(), stdout);
    return;
  }
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  if (!file) {
    throw InputError(path + ": cannot write: " + std::strerror(errno));
  }
}

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
    std::string json;
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
                      options->json,
                      "Write the evaluation as JSON too; - instead of the "
                      "table. An existing file is replaced");
  options->score.Declare(command);
  command->callback([options] {
    std::vector<std::string> paths{options->log};
    paths.insert(paths.end(), options->inputs.begin(), options->inputs.end());
    const LogEvaluation evaluation = EvaluateFiles(paths, options->score);
    if (options->json != "-") WriteText("-", TableOf(evaluation));
    if (!options->json.empty()) {
      WriteText(options->json, Dump(JsonOf(evaluation)));
    }
  });
}

void AddReportCommand(CLI::App* app, int* exit_code) {
  (void)exit_code;
  struct Options {
    std::vector<std::string> logs;
    std::string out;
    std::string json;
    ScoreOptions score;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app->add_subcommand(
      "report",
      "Evaluates logs and draws one HTML page that opens offline; prints the "
      "summary");
  command->add_option("LOG", options->logs, "LCM logs, a section each")
      ->required();
  command
      ->add_option(
          "--out", options->out, "The page; an existing file is replaced")
      ->required();
  command->add_option(
      "--json", options->json, "Write the evaluations as a JSON list too");
  options->score.Declare(command);
  command->callback([options] {
    std::vector<LogEvaluation> evaluations;
    nlohmann::json list = nlohmann::json::array();
    for (const std::string& log : options->logs) {
      evaluations.push_back(EvaluateFiles({log}, options->score));
      list.push_back(JsonOf(evaluations.back()));
    }
    WriteText(options->out, HtmlReport(evaluations));
    if (!options->json.empty()) WriteText(options->json, Dump(list));
    if (options->json != "-") WriteText("-", SummaryTableOf(evaluations));
  });
}

}  // namespace waymark
