#include "processes/support/run_process.h"

#include "estimation/base/input_error.h"
#include "processes/support/lcm_bus.h"
#include "processes/support/lcm_url.h"
#include "processes/support/replay_bus.h"
#include "processes/support/signals.h"
#include "processes/support/status_reporter.h"

#include <CLI/CLI.hpp>
#include <poll.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>
#include <system_error>

namespace waymark {
namespace {

using Steady = std::chrono::steady_clock;

constexpr int kFault = 1;
constexpr int kBadInput = 2;

struct Flags {
  std::string config;
  std::vector<std::string> settings;
  std::string lcm_url;
  std::string log_in;
  std::string log_out;
  bool force = false;
  bool check_config = false;
  bool print_config = false;
  bool describe_config = false;
};

void AddFlags(CLI::App* app, Flags* flags) {
  app->add_option("--config", flags->config, "Configuration, a YAML file")
      ->type_name("FILE");
  app->add_option("--set", flags->settings, "One value, after the file")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  auto* lcm_url =
      app->add_option(
             "--lcm-url",
             flags->lcm_url,
             "Run live on this LCM network (default: LCM_DEFAULT_URL, else "
             "udpm://239.255.76.67:7667?ttl=0)")
          ->type_name("URL");
  auto* log_in =
      app->add_option("--log-in", flags->log_in, "Run offline on this log")
          ->type_name("LOG")
          ->excludes(lcm_url);
  auto* log_out = app->add_option("--log-out",
                                  flags->log_out,
                                  "Its copy with this process's outputs")
                      ->type_name("LOG")
                      ->needs(log_in);
  app->add_flag("-f,--force", flags->force, "Replace the file at --log-out")
      ->needs(log_out);
  app->add_flag("--check-config",
                flags->check_config,
                "Load and check the configuration and the files that it "
                "names, then exit");
  app->add_flag("--print-config",
                flags->print_config,
                "Print all values as YAML, then exit");
  app->add_flag("--describe-config",
                flags->describe_config,
                "Print all keys with default, allowed range and meaning, then "
                "exit");
  app->set_version_flag("--version", WAYMARK_VERSION);
}

void LogToStderr(const std::string& name) {
  auto logger = std::make_shared<spdlog::logger>(
      name, std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
  spdlog::set_default_logger(std::move(logger));
}

Duration SteadyNow() {
  return std::chrono::duration_cast<Duration>(Steady::now().time_since_epoch());
}

// Waits for a message, a signal, the next timer or the time of the next STATUS.
void Wait(const LcmBus& bus, const Signals& signals, Duration next_status) {
  Duration until = next_status - SteadyNow();
  if (const auto timer = bus.UntilNextTimer()) until = std::min(until, *timer);
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until);
  std::array<pollfd, 2> waits{pollfd{bus.wake_fd(), POLLIN, 0},
                              pollfd{signals.fd(), POLLIN, 0}};
  ::poll(waits.data(),
         waits.size(),
         static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
}

int RunLive(const ProcessClass& process_class,
            ProcessSetup* setup,
            const Flags& flags) {
  // Before LCM makes its threads, which inherit what is blocked.
  Signals signals;
  const std::string url = LcmUrl(flags.lcm_url);
  LcmBus bus(process_class.name, url);
  const std::unique_ptr<RunningProcess> process = setup->Construct(&bus);
  const std::string channels = bus.ChannelsText();
  bus.WatchForTwins();
  StatusReporter reporter(
      &bus, PrintConfiguration([setup](Describer& d) { setup->Describe(d); }));
  bus.Start();
  const LcmBus::Socket socket = bus.socket();
  spdlog::info("live on {}: {}{}",
               url,
               channels,
               socket.granted_bytes < socket.wanted_bytes
                   ? fmt::format(", with {} of {} KiB of receive buffer",
                                 socket.granted_bytes / 1024,
                                 socket.wanted_bytes / 1024)
                   : "");
  try {
    while (!signals.Take()) {
      reporter.Report(SteadyNow());
      bus.RunTimers();
      if (!bus.HandleOne()) Wait(bus, signals, *reporter.next_status());
    }
    bus.Stop();
    while (!signals.Take() && bus.HandleOne()) {
    }
    bus.PaceLastWords();
    process->Finish();
  } catch (const std::exception& error) {
    // The last word on the bus says why.
    bus.SetFault(error.what());
    reporter.ReportStatus(SteadyNow());
    throw;
  }
  reporter.ReportStatus(SteadyNow());
  return 0;
}

int RunOffline(const ProcessClass& process_class, const Flags& flags) {
  Signals signals;
  ReplayOptions options;
  options.log_in = flags.log_in;
  options.log_out = flags.log_out;
  options.if_exists = flags.force ? IfExists::kReplace : IfExists::kFail;
  options.stop = [&signals] { return signals.Take(); };
  const ReplayReport report = RunReplay(
      {ReplayProcess{process_class, flags.config, flags.settings}}, options);
  if (!report.read.is_sound()) {
    spdlog::warn("{}: {} are no log records, skipped",
                 flags.log_in,
                 report.read.SkippedText());
  }
  if (report.was_stopped) {
    spdlog::error("interrupted after {} events", report.read.num_events);
    return kFault;
  }
  return 0;
}

int Run(const ProcessClass& process_class, const Flags& flags) {
  const std::unique_ptr<ProcessSetup> setup = process_class.make_setup();
  const DescribeFunction describe = [&](Describer& d) { setup->Describe(d); };
  if (flags.describe_config) {
    std::fputs(DescribeConfiguration(describe).c_str(), stdout);
    return 0;
  }
  setup->Load(flags.config, flags.settings);
  if (flags.print_config) {
    std::fputs(PrintConfiguration(describe).c_str(), stdout);
    return 0;
  }
  if (flags.check_config) {
    setup->CheckFiles();
    return 0;
  }
  return flags.log_in.empty() ? RunLive(process_class, setup.get(), flags)
                              : RunOffline(process_class, flags);
}

// A text as lines of a terminal, each behind a line end.
std::string Lines(const std::string& text) {
  constexpr std::size_t kWidth = 80;
  std::istringstream words(text);
  std::string lines;
  std::size_t width = kWidth;
  for (std::string word; words >> word; width += 1 + word.size()) {
    const bool fits = width + 1 + word.size() <= kWidth;
    lines += (fits ? ' ' : '\n') + word;
    if (!fits) width = 0;
  }
  return lines;
}

// An error of many lines, made one.
std::string OneLine(std::string text) {
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

int Fail(const std::string& name, const std::string& what, int exit_code) {
  std::fprintf(stderr, "%s: %s\n", name.c_str(), OneLine(what).c_str());
  return exit_code;
}

}  // namespace

std::string ShippedConfiguration(const std::string& process) {
  std::error_code error;
  const auto executable =
      std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return {};
  const auto prefix = executable.parent_path().parent_path();
  for (const char* folder : {"config", "share/waymark/config"}) {
    const auto path = prefix / folder / (process + ".yaml");
    if (std::filesystem::is_regular_file(path, error)) return path.string();
  }
  return {};
}

int RunProcessClass(const ProcessClass& process_class, int argc, char** argv) {
  const std::string& name = process_class.name;
  LogToStderr(name);
  Flags flags;
  CLI::App app("Process " + name + " of Waymark." + Lines(process_class.about),
               name);
  app.footer(
      "Configuration keys: --describe-config. What is on each channel: "
      "lcmtypes/README.md.");
  AddFlags(&app, &flags);
  try {
    app.parse(argc, argv);
    if (app.count("--config") == 0) flags.config = ShippedConfiguration(name);
    return Run(process_class, flags);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    return Fail(name, error.what(), kBadInput);
  } catch (const InputError& error) {
    return Fail(name, error.what(), kBadInput);
  } catch (const std::exception& error) {
    return Fail(name, error.what(), kFault);
  }
}

}  // namespace waymark
