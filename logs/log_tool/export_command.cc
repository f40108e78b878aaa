#include "estimation/base/input_error.h"
#include "logs/log_tool/commands.h"
#include "logs/log_tool/csv_export.h"
#include "logs/log_tool/tum_export.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

namespace waymark {
namespace {

struct ExportOptions {
  std::string log;
  std::string csv;
  std::string tum;
  std::string channel;
  std::string types;
  bool by_event_time = false;
  bool force = false;

  [[nodiscard]] IfExists if_exists() const {
    return force ? IfExists::kReplace : IfExists::kFail;
  }
};

void RunCsv(const ExportOptions& options, TypeTable* types) {
  const CsvReport report =
      ExportCsv(options.log, options.csv, types, options.if_exists());
  for (const auto& file : report.files) {
    std::printf("%s: %lld rows\n",
                file.path.c_str(),
                static_cast<long long>(file.num_rows));
  }
  for (const auto& reason : report.left_out) {
    std::printf("left out: %s\n", reason.c_str());
  }
  if (report.num_undecodable > 0) {
    std::printf("left out: %lld messages that do not decode\n",
                static_cast<long long>(report.num_undecodable));
  }
}

void RunTum(const ExportOptions& options, TypeTable* types) {
  const TumReport report = ExportTum(options.log,
                                     options.channel,
                                     options.tum,
                                     options.by_event_time,
                                     types,
                                     options.if_exists());
  std::printf("%s: %lld poses",
              options.tum.c_str(),
              static_cast<long long>(report.num_poses));
  if (report.num_unknown > 0) {
    std::printf(", %lld messages without a pose left out",
                static_cast<long long>(report.num_unknown));
  }
  if (report.num_no_heading > 0) {
    std::printf(", %lld without heading",
                static_cast<long long>(report.num_no_heading));
  }
  std::printf("\n");
}

}  // namespace

void AddExportCommand(CLI::App* app, int* /*exit_code*/) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app->add_subcommand(
      "export", "Writes a log's messages as CSV tables or a TUM trajectory");
  command->add_option("log", options->log, "The log")->required();
  command->add_option(
      "--csv", options->csv, "Folder for one CSV file per channel");
  command->add_option(
      "--tum",
      options->tum,
      "File for the poses of --channel: time x y z qx qy qz qw");
  command->add_option("--channel",
                      options->channel,
                      "Channel of the trajectory, such as POSE or TRUTH");
  command->add_flag("--event-time",
                    options->by_event_time,
                    "Trajectory by the times of receipt, not by utime");
  command->add_option(
      "--types", options->types, "Folder of .lcm files with further types");
  command->add_flag("-f,--force", options->force, "Replace outputs that exist");
  command->callback([options] {
    if (options->csv.empty() == options->tum.empty()) {
      throw InputError("export: give either --csv DIR or --tum FILE");
    }
    if (options->tum.empty() != options->channel.empty()) {
      throw InputError("export: --tum and --channel belong together");
    }
    TypeTable types(options->types);
    options->tum.empty() ? RunCsv(*options, &types) : RunTum(*options, &types);
  });
}

}  // namespace waymark
