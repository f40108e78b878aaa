#include "estimation/base/input_error.h"
#include "logs/log_tool/commands.h"
#include "logs/log_tool/csv_export.h"
#include "logs/log_tool/picture_export.h"
#include "logs/log_tool/tum_export.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <cstdio>
#include <memory>

namespace waymark {
namespace {

struct ExportOptions {
  std::string log;
  std::string csv;
  std::string tum;
  std::string pictures;
  std::string channel;
  std::int64_t max_pictures = 1000;
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

void RunPictures(const ExportOptions& options) {
  const PictureReport report = ExportPictures(
      options.log,
      options.pictures,
      {options.channel, options.max_pictures, options.if_exists()});
  for (const auto& channel : report.channels) {
    std::printf("%s: %lld pictures\n",
                channel.name.c_str(),
                static_cast<long long>(channel.num_files));
    if (channel.num_bad == 0) continue;
    std::printf("left out: %s: %lld images, the first: %s\n",
                channel.name.c_str(),
                static_cast<long long>(channel.num_bad),
                channel.reason.c_str());
  }
  if (report.num_left_out > 0) {
    std::printf("left out: %lld images more than --max-pictures %lld\n",
                static_cast<long long>(report.num_left_out),
                static_cast<long long>(options.max_pictures));
  }
}

}  // namespace

void AddExportCommand(CLI::App* app, int* /*exit_code*/) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app->add_subcommand(
      "export",
      "Writes a log's messages as CSV tables, a TUM trajectory, or pictures");
  command->add_option("log", options->log, "The log")->required();
  command->add_option(
      "--csv", options->csv, "Folder for one CSV file per channel");
  command->add_option(
      "--tum",
      options->tum,
      "File for the poses of --channel: time x y z qx qy qz qw");
  command->add_option("--channel",
                      options->channel,
                      "Channel of the trajectory, such as POSE or TRUTH; of "
                      "the pictures, if not all");
  command->add_option("--pictures",
                      options->pictures,
                      "Folder for a file per image, CHANNEL_UTIME: .jpg as it "
                      "was sent, .png of raw ones");
  command
      ->add_option("--max-pictures",
                   options->max_pictures,
                   "Leave out what comes after so many")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000}))
      ->capture_default_str();
  command->add_flag("--event-time",
                    options->by_event_time,
                    "Trajectory by the times of receipt, not by utime");
  command->add_option(
      "--types", options->types, "Folder of .lcm files with further types");
  command->add_flag("-f,--force", options->force, "Replace outputs that exist");
  command->callback([options] {
    if (!options->csv.empty() + !options->tum.empty() +
            !options->pictures.empty() !=
        1) {
      throw InputError(
          "export: give one of --csv DIR, --tum FILE and --pictures DIR");
    }
    if (!options->pictures.empty()) return RunPictures(*options);
    if (options->tum.empty() != options->channel.empty()) {
      throw InputError("export: --tum and --channel belong together");
    }
    TypeTable types(options->types);
    options->tum.empty() ? RunCsv(*options, &types) : RunTum(*options, &types);
  });
}

}  // namespace waymark
