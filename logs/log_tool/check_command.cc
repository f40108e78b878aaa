#include "logs/log_tool/commands.h"
#include "logs/log_tool/log_check.h"
#include "logs/log_tool/log_summary.h"
#include "logs/log_tool/text_table.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

namespace waymark {
namespace {

struct CheckOptions {
  std::string log;
  std::string types;
};

constexpr int kDamaged = 1;

const char* TextOf(FindingKind kind) {
  switch (kind) {
    case FindingKind::kNotDecodable:
      return "does not decode";
    case FindingKind::kNotFinite:
      return "not finite";
    case FindingKind::kTimeBackwards:
      return "utime goes backwards";
    case FindingKind::kMixedSenders:
      return "several senders of one name";
    case FindingKind::kRestart:
      return "its sender started again";
    case FindingKind::kEventTimeBackwards:
      return "event time goes backwards";
    case FindingKind::kUnknownType:
      return "type not known";
  }
  return "";
}

std::string WorstText(const Finding& finding) {
  if (finding.num_events < 2 || finding.worst_step_s == 0.0) return "";
  return ", the worst by " + Fixed(finding.worst_step_s, 6) + " s";
}

bool PrintCheck(const std::string& path, const LogCheck& check) {
  std::fputs(DamageText(path, check.report, check.report.gaps.size()).c_str(),
             stdout);
  for (const auto& finding : check.findings) {
    std::printf("%s%s%s%s: %lld events, the first is %lld at byte %lld: %s%s\n",
                finding.is_fault() ? "" : "note: ",
                finding.channel.c_str(),
                finding.channel.empty() ? "" : ": ",
                TextOf(finding.kind),
                static_cast<long long>(finding.num_events),
                static_cast<long long>(finding.first_event),
                static_cast<long long>(finding.first_offset),
                finding.detail.c_str(),
                WorstText(finding).c_str());
  }
  std::printf("%s: %lld events, %s\n",
              path.c_str(),
              static_cast<long long>(check.report.num_events),
              check.is_sound()          ? "sound"
              : check.report.is_sound() ? "whole, with the faults above"
                                        : "damaged");
  return check.is_sound();
}

}  // namespace

void AddCheckCommand(CLI::App* app, int* exit_code) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app->add_subcommand(
      "check",
      "Looks for damage, undecodable messages, times that go backwards, "
      "numbers that are not finite and senders of the same name; exit code 1 "
      "if there are any");
  command->add_option("log", options->log, "The log")->required();
  command->add_option(
      "--types", options->types, "Folder of .lcm files with further types");
  command->callback([options, exit_code] {
    TypeTable types(options->types);
    const LogCheck check = CheckLog(options->log, &types);
    if (!PrintCheck(options->log, check)) *exit_code = kDamaged;
  });
}

}  // namespace waymark
