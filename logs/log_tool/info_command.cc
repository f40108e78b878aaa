#include "logs/log_tool/commands.h"
#include "logs/log_tool/log_summary.h"
#include "logs/log_tool/text_table.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <memory>

namespace waymark {
namespace {

struct InfoOptions {
  std::string log;
  std::string types;
  bool as_json = false;
};

constexpr std::size_t kMaxDamageLines = 10;

std::string SecondsSince(Time start, Time time) {
  return Fixed(SecondsBetween(start, time), 1);
}

std::string Join(const std::vector<std::string>& parts) {
  std::string text;
  for (const auto& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

void PrintText(const LogSummary& log) {
  std::printf(
      "%s: %lld events on %zu channels, %.1f s, %s\n",
      log.path.c_str(),
      static_cast<long long>(log.report.num_events),
      log.channels.size(),
      SecondsBetween(log.first, log.last),
      ReadableBytes(static_cast<double>(log.report.num_file_bytes)).c_str());
  if (!log.channels.empty()) {
    std::printf("from %s to %s\n",
                DateText(log.first).c_str(),
                DateText(log.last).c_str());
  }
  const std::string damage = DamageText(log.path, log.report, kMaxDamageLines);
  std::printf("%s\n", damage.empty() ? "no damage\n" : damage.c_str());
  TextTable table({"<channel",
                   "<type",
                   "count",
                   "Hz",
                   "jitter ms",
                   "longest gap s",
                   "at s",
                   "first s",
                   "last s",
                   "lost",
                   "size"});
  for (const auto& channel : log.channels) {
    const bool has_rate = channel.num_events > 1;
    table.AddRow(
        {channel.channel,
         Join(channel.types),
         std::to_string(channel.num_events),
         has_rate ? Fixed(channel.rate_hz, 1) : "-",
         has_rate ? Fixed(1e3 * channel.jitter_s, 1) : "-",
         has_rate ? Fixed(Seconds(channel.longest_gap), 3) : "-",
         has_rate ? SecondsSince(log.first, channel.longest_gap_start) : "-",
         SecondsSince(log.first, channel.first),
         SecondsSince(log.first, channel.last),
         channel.num_lost < 0 ? "-" : std::to_string(channel.num_lost),
         ReadableBytes(static_cast<double>(channel.num_bytes))});
  }
  std::fputs(table.Text().c_str(), stdout);
  for (const auto& channel : log.channels) {
    if (Join(channel.types).find("? ") == std::string::npos) continue;
    std::puts(
        "\n?: a type that is not known by its fingerprint; --types DIR reads "
        "the .lcm files of others");
    break;
  }
}

void PrintJson(const LogSummary& log) {
  nlohmann::ordered_json channels = nlohmann::ordered_json::array();
  for (const auto& channel : log.channels) {
    channels.push_back(
        {{"channel", channel.channel},
         {"types", channel.types},
         {"count", channel.num_events},
         {"bytes", channel.num_bytes},
         {"rate_hz", channel.rate_hz},
         {"jitter_s", channel.jitter_s},
         {"longest_gap_s", Seconds(channel.longest_gap)},
         {"longest_gap_utime", Microseconds(channel.longest_gap_start)},
         {"first_utime", Microseconds(channel.first)},
         {"last_utime", Microseconds(channel.last)},
         {"lost", channel.num_lost}});
  }
  const nlohmann::ordered_json json = {
      {"path", log.path},
      {"bytes", log.report.num_file_bytes},
      {"events", log.report.num_events},
      {"first_utime", Microseconds(log.first)},
      {"last_utime", Microseconds(log.last)},
      {"gaps", log.report.num_gaps},
      {"skipped_bytes", log.report.num_skipped_bytes},
      {"torn_end", log.report.torn_end},
      {"channels", channels}};
  // A channel's name may be no valid UTF-8.
  std::puts(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
                .c_str());
}

}  // namespace

void AddInfoCommand(CLI::App* app, int* /*exit_code*/) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app->add_subcommand(
      "info", "Shows what a log holds: channels, types, rates, gaps, damage");
  command->add_option("log", options->log, "The log")->required();
  command->add_option(
      "--types", options->types, "Folder of .lcm files with further types");
  command->add_flag("--json", options->as_json, "Print JSON");
  command->callback([options] {
    TypeTable types(options->types);
    const LogSummary summary = SummariseLog(options->log, &types);
    options->as_json ? PrintJson(summary) : PrintText(summary);
  });
}

}  // namespace waymark
