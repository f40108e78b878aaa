#include "procman/sheriff/sheriff_table.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include <algorithm>
#include <cstring>

namespace waymark {
namespace {

constexpr double kMib = 1024.0 * 1024.0;

std::string FullName(const DeploymentCommand& command) {
  return command.group.empty() ? command.id : command.group + "/" + command.id;
}

// What else there is to say of its state.
std::string Remark(const SheriffCommand& command) {
  if (!command.report || command.report->pid != 0 ||
      command.report->exit_code == 0) {
    return "";
  }
  return ExitText(command.report->exit_code);
}

}  // namespace

std::string ExitText(std::int32_t exit_code) {
  if (WIFSIGNALED(exit_code)) {
    const char* name = strsignal(WTERMSIG(exit_code));
    return std::string("killed: ") + (name == nullptr ? "?" : name);
  }
  return "exit " + std::to_string(WEXITSTATUS(exit_code));
}

std::string StatusTable(const SheriffState& state, Duration now) {
  std::string text;
  std::size_t width = 10;
  for (const auto& [id, command] : state.commands()) {
    width = std::max(width, FullName(command.command).size());
  }
  if (state.deputies().empty()) text += "no deputies\n";
  for (const auto& [id, deputy] : state.deputies()) {
    const DeputyReport& report = deputy.report;
    text += fmt::format(
        "deputy {:<{}} cpu {:3.0f} %, memory {:.0f} of {:.0f} MB free, clock "
        "{:+.0f} ms, heard {:.1f} s ago\n",
        id,
        width > 7 ? width - 7 : 1,
        100.0 * report.cpu_load,
        static_cast<double>(report.memory_free_bytes) / kMib,
        static_cast<double>(report.memory_total_bytes) / kMib,
        1e3 * Seconds(deputy.clock_offset),
        Seconds(now - deputy.heard));
  }
  if (state.commands().empty()) return text + "no commands\n";
  text += fmt::format("{:<{}}  {:<12}{:<11}{:>8}{:>7}{:>9}  {}\n",
                      "command",
                      width,
                      "deputy",
                      "status",
                      "pid",
                      "cpu %",
                      "MB",
                      "last end");
  for (const auto& [id, command] : state.commands()) {
    const CommandReport report = command.report.value_or(CommandReport());
    const bool is_on = report.pid != 0;
    text += fmt::format(
        "{:<{}}  {:<12}{:<11}{:>8}{:>7}{:>9}  {}\n",
        FullName(command.command),
        width,
        command.command.deputy,
        NameOf(command.status()),
        is_on ? std::to_string(report.pid) : "-",
        is_on ? fmt::format("{:.1f}", 100.0 * report.cpu_share) : "-",
        is_on ? fmt::format("{:.1f}",
                            static_cast<double>(report.resident_bytes) / kMib)
              : "-",
        Remark(command));
  }
  return text;
}

std::string StatusJson(const SheriffState& state) {
  nlohmann::json result{{"deputies", nlohmann::json::array()},
                        {"commands", nlohmann::json::array()},
                        {"sheriff", state.other_sheriff()}};
  for (const auto& [id, deputy] : state.deputies()) {
    result["deputies"].push_back(
        {{"id", id},
         {"cpu_load", deputy.report.cpu_load},
         {"memory_total_bytes", deputy.report.memory_total_bytes},
         {"memory_free_bytes", deputy.report.memory_free_bytes},
         {"clock_offset_s", Seconds(deputy.clock_offset)}});
  }
  for (const auto& [id, command] : state.commands()) {
    const CommandReport report = command.report.value_or(CommandReport());
    result["commands"].push_back({{"id", id},
                                  {"group", command.command.group},
                                  {"deputy", command.command.deputy},
                                  {"exec", command.command.exec},
                                  {"status", NameOf(command.status())},
                                  {"pid", report.pid},
                                  {"run_id", report.actual_runid},
                                  {"wait_status", report.exit_code},
                                  {"cpu_share", report.cpu_share},
                                  {"resident_bytes", report.resident_bytes}});
  }
  // Names are others' text: never a reason to fail.
  return result.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

}  // namespace waymark
