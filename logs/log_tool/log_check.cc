#include "logs/log_tool/log_check.h"

#include "logs/log_tool/log_summary.h"
#include "logs/log_tool/text_table.h"
#include "processes/support/message_fields.h"
#include "processes/support/progress.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

namespace waymark {
namespace {

class Checker {
 public:
  explicit Checker(TypeTable* types) : types_(types) {}

  void Check(const LogEvent& event, std::int64_t offset) {
    offset_ = offset;
    if (num_events_ > 0 && event.time < last_event_time_) {
      AddStep(FindingKind::kEventTimeBackwards,
              "",
              SecondsBetween(event.time, last_event_time_));
    }
    last_event_time_ = event.time;
    CheckMessage(event);
    ++num_events_;
  }

  [[nodiscard]] std::vector<Finding> Findings() const {
    std::vector<Finding> result;
    for (const auto& [key, finding] : findings_) result.push_back(finding);
    return result;
  }

 private:
  void CheckMessage(const LogEvent& event) {
    const MessageTypeInfo& type = types_->Find(event.data);
    if (type.is_self_test) return;
    if (type.schema == nullptr) {
      Add(FindingKind::kUnknownType, event.channel, type.name);
      return;
    }
    std::optional<Time> utime;
    std::string sender;
    std::string not_finite;
    const std::string reason = VisitFields(
        *type.schema,
        event.data,
        [&](std::string_view name, const FieldValue& value) {
          if (const auto* integer = std::get_if<std::int64_t>(&value)) {
            if (name == "utime") utime = TimeFromMicroseconds(*integer);
          } else if (const auto* number = std::get_if<double>(&value)) {
            if (!std::isfinite(*number) && not_finite.empty()) {
              not_finite = std::string(name) + " is " + Fixed(*number, 0);
            }
          } else if (const auto* text = std::get_if<std::string_view>(&value)) {
            if (name == "source" || name == "process") sender = *text;
          }
        });
    if (!reason.empty()) {
      Add(FindingKind::kNotDecodable,
          event.channel,
          type.schema->name + ": " + reason);
      return;
    }
    // Ranges that are out of reach are infinite by custom, in others' types.
    if (type.is_ours && !not_finite.empty()) {
      Add(FindingKind::kNotFinite, event.channel, not_finite);
    }
    if (utime) CheckTime(event.channel, sender, *utime);
  }

  // Several senders may share a channel, each with a clock of its own.
  void CheckTime(const std::string& channel,
                 const std::string& sender,
                 Time utime) {
    const auto [last, is_first] =
        last_utime_.try_emplace({channel, sender}, utime);
    if (!is_first && utime < last->second) {
      AddStep(FindingKind::kTimeBackwards,
              channel,
              SecondsBetween(utime, last->second));
    }
    last->second = utime;
  }

  void AddStep(FindingKind kind, const std::string& channel, double step_s) {
    Finding& finding = Add(kind, channel, "by " + Fixed(step_s, 6) + " s");
    finding.worst_step_s = std::max(finding.worst_step_s, step_s);
  }

  Finding& Add(FindingKind kind,
               const std::string& channel,
               const std::string& detail) {
    // Unknown types are told apart by their fingerprint.
    const bool by_detail = kind == FindingKind::kUnknownType;
    Finding& finding =
        findings_[{channel, kind, by_detail ? detail : std::string()}];
    if (finding.num_events++ > 0) return finding;
    finding.kind = kind;
    finding.channel = channel;
    finding.first_event = num_events_;
    finding.first_offset = offset_;
    finding.detail = detail;
    return finding;
  }

  TypeTable* types_;
  std::map<std::tuple<std::string, FindingKind, std::string>, Finding>
      findings_;
  std::map<std::pair<std::string, std::string>, Time> last_utime_;
  Time last_event_time_;
  std::int64_t num_events_ = 0;
  std::int64_t offset_ = 0;
};

}  // namespace

bool Finding::is_fault() const {
  return kind == FindingKind::kEventTimeBackwards
             ? worst_step_s > kMaxEventStepBackS
             : kind != FindingKind::kUnknownType;
}

bool LogCheck::is_sound() const {
  return report.is_sound() &&
         std::none_of(findings.begin(), findings.end(), [](const Finding& f) {
           return f.is_fault();
         });
}

LogCheck CheckLog(const std::string& path, TypeTable* types) {
  LogReader reader(path);
  Progress progress("checking " + path, reader.report().num_file_bytes);
  Checker checker(types);
  while (const auto event = reader.Next()) {
    progress.Show(reader.offset());
    checker.Check(*event, reader.event_offset());
  }
  return {reader.report(), checker.Findings()};
}

}  // namespace waymark
