#include "processes/tools/replay/replay_tool.h"

#include "estimation/base/input_error.h"
#include "processes/support/progress.h"
#include "processes/support/replay_bus.h"
#include "processes/support/run_process.h"
#include "processes/support/run_tool.h"
#include "processes/support/signals.h"

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

namespace waymark {
namespace {

struct Request {
  std::vector<std::string> processes;  // "name" or "name=file".
  std::vector<std::string> settings;   // "name.key=value".
  std::string in;
  std::string out;
  bool force = false;
  bool list = false;
};

std::string NamesOf(const std::vector<ProcessClass>& classes) {
  std::string text;
  for (const auto& c : classes) {
    if (!c.is_live_only) text += (text.empty() ? "" : ", ") + c.name;
  }
  return text.empty() ? "none" : text;
}

// "a=b" as a and b; b is empty without '='.
std::pair<std::string, std::string> SplitAt(char mark,
                                            const std::string& text) {
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) return {text, ""};
  return {text.substr(0, at), text.substr(at + 1)};
}

std::vector<ReplayProcess> MakeProcesses(const std::vector<ProcessClass>& known,
                                         const Request& request) {
  std::vector<ReplayProcess> result;
  for (const std::string& text : request.processes) {
    auto [name, file] = SplitAt('=', text);
    // Named in the capture: clang 14 takes no structured binding otherwise.
    const auto found = std::find_if(
        known.begin(), known.end(), [&name = name](const ProcessClass& c) {
          return c.name == name;
        });
    if (found == known.end()) {
      throw InputError(
          fmt::format("--process {}: there is no process '{}', but: {}",
                      text,
                      name,
                      NamesOf(known)));
    }
    if (file.empty()) file = ShippedConfiguration(name);
    result.push_back({*found, file, {}});
  }
  for (const std::string& text : request.settings) {
    const auto [name, setting] = SplitAt('.', text);
    const auto found = std::find_if(
        result.begin(), result.end(), [&name = name](const auto& process) {
          return process.process_class.name == name;
        });
    if (found == result.end() || setting.empty()) {
      throw InputError("--set " + text +
                       ": must start with the name of a --process and a dot, "
                       "such as pose_filter.key=value");
    }
    found->settings.push_back(setting);
  }
  return result;
}

void PrintReport(const Request& request, const ReplayReport& report) {
  std::printf("%s: %lld events; of the %lld in %s, %lld were left out\n",
              request.out.c_str(),
              static_cast<long long>(report.num_written),
              static_cast<long long>(report.read.num_events),
              request.in.c_str(),
              static_cast<long long>(report.num_left_out));
  for (const auto& status : report.statuses) {
    std::printf("%s: %lld received, %lld lost, %lld bad, %lld published%s%s\n",
                status.process.c_str(),
                static_cast<long long>(status.num_received),
                static_cast<long long>(status.num_lost),
                static_cast<long long>(status.num_bad),
                static_cast<long long>(status.num_published),
                status.fault.empty() ? "" : "; fault: ",
                status.fault.c_str());
  }
  if (!report.read.is_sound()) {
    std::printf("%s is damaged: %s were skipped\n",
                request.in.c_str(),
                report.read.SkippedText().c_str());
  }
}

void Replay(const std::vector<ProcessClass>& known, const Request& request) {
  if (request.processes.empty() || request.in.empty() || request.out.empty()) {
    throw InputError(
        "needs at least one --process, the log to read and the log to write "
        "(see --help)");
  }
  Signals signals;
  std::error_code missing;  // RunReplay says so.
  const auto size = std::filesystem::file_size(request.in, missing);
  Progress progress("replaying " + request.in,
                    missing ? 0 : static_cast<std::int64_t>(size));
  ReplayOptions options;
  options.log_in = request.in;
  options.log_out = request.out;
  options.if_exists = request.force ? IfExists::kReplace : IfExists::kFail;
  options.stop = [&signals] { return signals.Take(); };
  options.progress = [&progress](std::int64_t offset) {
    progress.Show(offset);
  };
  const ReplayReport report = RunReplay(MakeProcesses(known, request), options);
  progress.Clear();
  PrintReport(request, report);
  if (report.was_stopped) throw std::runtime_error("interrupted");
}

}  // namespace

int RunReplayTool(const std::vector<ProcessClass>& known,
                  int argc,
                  char** argv) {
  Request request;
  return RunTool(
      argc,
      argv,
      "waymark-replay",
      "Runs processes on a recorded log, as fast as the machine goes. OUT is "
      "IN without what these processes recorded and with what they publish "
      "now; the same log gives the same bytes. Processes: " +
          NamesOf(known),
      [&](CLI::App* app, int* /*exit_code*/) {
        app->add_option("-p,--process",
                        request.processes,
                        "A process and, if not the shipped one, its "
                        "configuration; may be repeated")
            ->type_name("NAME[=FILE]")
            ->allow_extra_args(false);
        app->add_option("--set",
                        request.settings,
                        "One value of one process; may be repeated")
            ->type_name("NAME.KEY=VALUE")
            ->allow_extra_args(false);
        app->add_option("in", request.in, "The log to read");
        app->add_option("out", request.out, "The log to write");
        app->add_flag(
            "-f,--force", request.force, "Replace the output if it exists");
        app->add_flag("--list", request.list, "Print the processes there are");
        app->final_callback([&] {
          if (!request.list) return Replay(known, request);
          for (const auto& c : known) {
            if (!c.is_live_only) std::puts(c.name.c_str());
          }
        });
      });
}

}  // namespace waymark
