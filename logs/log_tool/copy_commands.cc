#include "logs/log_tool/commands.h"
#include "logs/log_tool/log_copy.h"
#include "logs/log_tool/text_table.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

namespace waymark {
namespace {

struct CopyOptions {
  std::string in;
  std::string out;
  std::string start;
  std::string end;
  std::string channels;
  bool invert = false;
  bool force = false;
};

CLI::App* AddCopy(CLI::App* app,
                  const char* name,
                  const char* description,
                  CopyOptions* options) {
  CLI::App* command = app->add_subcommand(name, description);
  command->add_option("in", options->in, "The log to read")->required();
  command->add_option("out", options->out, "The log to write")->required();
  command->add_flag(
      "-f,--force", options->force, "Replace the output if it exists");
  return command;
}

IfExists WhatIfExists(const CopyOptions& options) {
  return options.force ? IfExists::kReplace : IfExists::kFail;
}

void PrintCopy(const CopyOptions& options, const LogCopyReport& report) {
  std::printf("%s: %lld of %lld events, %s\n",
              options.out.c_str(),
              static_cast<long long>(report.num_events),
              static_cast<long long>(report.read.num_events),
              ReadableBytes(static_cast<double>(report.num_bytes)).c_str());
}

}  // namespace

void AddRepairCommand(CLI::App* app, int* /*exit_code*/) {
  auto options = std::make_shared<CopyOptions>();
  CLI::App* command =
      AddCopy(app,
              "repair",
              "Saves every whole record of a damaged log into a new one",
              options.get());
  command->callback([options] {
    LogCopyOptions copy;
    copy.if_exists = WhatIfExists(*options);
    const LogCopyReport report = CopyLog(options->in, options->out, copy);
    PrintCopy(*options, report);
    std::printf("%s were lost\n", report.read.SkippedText().c_str());
  });
}

void AddCutCommand(CLI::App* app, int* /*exit_code*/) {
  auto options = std::make_shared<CopyOptions>();
  CLI::App* command = AddCopy(
      app, "cut", "Copies a stretch of time or some channels", options.get());
  const char* moment =
      "in seconds from the log's first event, or in microseconds since the "
      "epoch with 'us' at the end";
  command->add_option("--start",
                      options->start,
                      std::string("First moment to keep, ") + moment);
  command->add_option("--end",
                      options->end,
                      std::string("First moment to leave out, ") + moment);
  command->add_option("-c,--channels",
                      options->channels,
                      "Regular expression that the whole name must match, "
                      "such as 'POSE|IMAGE_.*'");
  command->add_flag("-v,--invert",
                    options->invert,
                    "Leave out the channels that match instead");
  command->callback([options] {
    LogCopyOptions copy;
    if (!options->start.empty()) copy.start = {"--start", options->start};
    if (!options->end.empty()) copy.end = {"--end", options->end};
    copy.channels = options->channels;
    copy.invert_channels = options->invert;
    copy.if_exists = WhatIfExists(*options);
    PrintCopy(*options, CopyLog(options->in, options->out, copy));
  });
}

}  // namespace waymark
