#include "processes/tools/wait/wait_tool.h"

#include "estimation/base/input_error.h"
#include "processes/support/channels.h"
#include "processes/support/decode.h"
#include "processes/support/lcm_url.h"
#include "processes/support/run_tool.h"

#include <waymark/status_t.hpp>

#include <CLI/CLI.hpp>
#include <lcm/lcm-cpp.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace waymark {
namespace {

using Steady = std::chrono::steady_clock;
using std::chrono::milliseconds;

struct WaitOptions {
  std::string url;
  double timeout_s = 10.0;
  std::vector<std::string> names;
  double idle_s = 1.0;
};

// What was seen so far.
struct Seen {
  std::set<std::string> processes;
  Steady::time_point last_message;

  void OnMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    if (channel == kStatus) {
      const auto status = DecodeMessage<status_t>(
          {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
      if (status) processes.insert(status->process);
    } else if (channel != kConfig) {
      last_message = Steady::now();
    }
  }
};

Steady::duration FromSeconds(double seconds) {
  return std::chrono::duration_cast<Steady::duration>(
      std::chrono::duration<double>(seconds));
}

// True once `is_done` says so, false once the time has passed.
template <typename IsDone>
bool WaitUntil(const WaitOptions& options, Seen* seen, const IsDone& is_done) {
  const std::string url = WithGrantedBuffer(LcmUrl(options.url));
  CheckLcmReachable(url);
  lcm::LCM lcm(url);
  if (!lcm.good()) throw InputError("LCM cannot be created with " + url);
  lcm.subscribe(".*", &Seen::OnMessage, seen);
  const Steady::time_point end = Steady::now() + FromSeconds(options.timeout_s);
  seen->last_message = Steady::now();
  while (!is_done()) {
    if (Steady::now() >= end) return false;
    constexpr milliseconds kLook(50);  // How late an answer may be.
    if (lcm.handleTimeout(static_cast<int>(kLook.count())) < 0) {
      throw std::runtime_error("LCM stopped working on " + url);
    }
  }
  return true;
}

int WaitForStatus(const WaitOptions& options) {
  Seen seen;
  const auto missing = [&] {
    std::string names;
    for (const std::string& name : options.names) {
      if (!seen.processes.contains(name)) names += " " + name;
    }
    return names;
  };
  if (WaitUntil(options, &seen, [&] { return missing().empty(); })) return 0;
  std::fprintf(stderr,
               "waymark-wait: no STATUS within %g s from:%s\n",
               options.timeout_s,
               missing().c_str());
  return 1;
}

int WaitForIdle(const WaitOptions& options) {
  Seen seen;
  const bool is_idle = WaitUntil(options, &seen, [&] {
    return Steady::now() - seen.last_message >= FromSeconds(options.idle_s);
  });
  if (is_idle) return 0;
  std::fprintf(stderr,
               "waymark-wait: messages still come after %g s\n",
               options.timeout_s);
  return 1;
}

void AddCommonOptions(CLI::App* command, WaitOptions* options) {
  command->add_option(
      "--lcm-url", options->url, "LCM network (else LCM_DEFAULT_URL)");
  RequireRange(command->add_option(
                   "--timeout", options->timeout_s, "Give up after so long, s"),
               0.0,
               1e6)
      ->capture_default_str();
}

}  // namespace

int RunWaitTool(int argc, char** argv) {
  const auto options = std::make_shared<WaitOptions>();
  return RunTool(
      argc,
      argv,
      "waymark-wait",
      "Waits for what happens on the bus; exit code 1 where it does not.",
      [options](CLI::App* app, int* exit_code) {
        app->require_subcommand(1);
        CLI::App* status = app->add_subcommand(
            "status", "Waits until each process was seen on STATUS");
        status->add_option("NAME", options->names, "Processes")->required();
        AddCommonOptions(status, options.get());
        status->callback(
            [options, exit_code] { *exit_code = WaitForStatus(*options); });
        CLI::App* idle = app->add_subcommand(
            "idle",
            "Waits until no message came for a while, STATUS and CONFIG "
            "aside");
        RequireRange(
            idle->add_option("--for", options->idle_s, "How long, s"), 0.0, 1e6)
            ->capture_default_str();
        AddCommonOptions(idle, options.get());
        idle->callback(
            [options, exit_code] { *exit_code = WaitForIdle(*options); });
      });
}

}  // namespace waymark
