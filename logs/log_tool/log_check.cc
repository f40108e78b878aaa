#include "logs/log_tool/log_check.h"

#include "logs/log_tool/log_summary.h"
#include "logs/log_tool/text_table.h"
#include "processes/support/channels.h"
#include "processes/support/message_fields.h"
#include "processes/support/progress.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace waymark {
namespace {

// Whose messages are whose, where several may bear one name: each sender counts
// for itself.
class SenderNumbers {
 public:
  enum class Event { kNone, kRestart, kMixed };
  struct Step {
    Event event = Event::kNone;
    std::optional<Time> before;  // The utime of this sender's last message.
  };

  Step Add(std::int64_t number, Time utime) {
    ++num_messages_;
    if (counts_.empty()) {
      counts_.push_back({number, utime, num_messages_});
      return {};
    }
    const Numbered current = counts_[current_];
    if (const auto continued = Continued(number)) {
      Step step;
      // Back to a count that another one had taken the place of.
      if (*continued != current_) step.event = Event::kMixed;
      current_ = *continued;
      step.before = counts_[current_].utime;
      counts_[current_] = {number, utime, num_messages_};
      return step;
    }
    const bool is_restart = number < kFirstNumbers && number < current.number;
    if (!is_restart && number <= current.number &&
        current.number - number <= kMaxLate) {
      return AddLate(number, utime);
    }
    if (counts_.size() == kMaxSenders) counts_.erase(counts_.begin());
    current_ = counts_.size();
    counts_.push_back({number, utime, num_messages_});
    if (is_restart) return {Event::kRestart, std::nullopt};
    return {Event::kNone, current.utime};
  }

 private:
  // Overtaken on its way, or come twice; or, where all come so, one after the
  // other, another sender that started at about the same time.
  Step AddLate(std::int64_t number, Time utime) {
    Step step;
    num_late_in_order_ = number == last_late_ + 1 ? num_late_in_order_ + 1 : 0;
    last_late_ = number;
    if (num_late_in_order_ >= kManyLate) {
      step.event = Event::kMixed;
    } else {
      step.before = counts_[current_].utime;
      counts_[current_].utime = utime;
    }
    return step;
  }

  struct Numbered {
    std::int64_t number = 0;
    Time utime;
    std::int64_t at = 0;  // Of all messages, the last one that it counted.
  };

  // The nearest count that `number` goes on with: any that it is close behind,
  // or the one of the last message, whatever was lost on the way.
  [[nodiscard]] std::optional<std::size_t> Continued(
      std::int64_t number) const {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      const std::int64_t last = counts_[i].number;
      if (number <= last) continue;
      const bool is_current = i == current_;
      const bool is_close = number - last <= kMaxLost &&
                            num_messages_ - counts_[i].at <= kMaxSilence;
      if (!is_close && !is_current) continue;
      const std::int64_t nearest = best ? counts_[*best].number : last - 1;
      if (last > nearest || (last == nearest && is_current)) best = i;
    }
    return best;
  }

  static constexpr std::size_t kMaxSenders = 4;
  // The first ones of who starts may be lost.
  static constexpr std::int64_t kFirstNumbers = 20;
  static constexpr std::int64_t kMaxLost = 20;
  static constexpr std::int64_t kMaxLate = 5;
  // A count that nobody has gone on with is that of who started again.
  static constexpr std::int64_t kMaxSilence = 100;
  static constexpr int kManyLate = 3;
  std::vector<Numbered> counts_;
  std::size_t current_ = 0;
  std::int64_t num_messages_ = 0;
  std::int64_t last_late_ = -1;
  int num_late_in_order_ = 0;
};

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
    for (const auto& [key, finding] : findings_) {
      // What looks like one sender's restarts or steps of its clock is the
      // other one's turn.
      const bool is_mixed =
          findings_.contains({finding.channel, FindingKind::kMixedSenders, ""});
      if (is_mixed && (finding.kind == FindingKind::kRestart ||
                       finding.kind == FindingKind::kTimeBackwards)) {
        continue;
      }
      result.push_back(finding);
    }
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
    std::optional<std::int64_t> number;
    std::string sender;
    std::string not_finite;
    const std::string reason = VisitFields(
        *type.schema,
        event.data,
        [&](std::string_view name, const FieldValue& value) {
          if (const auto* integer = std::get_if<std::int64_t>(&value)) {
            if (name == "utime") utime = TimeFromMicroseconds(*integer);
            // Hostile ones may be as far apart as numbers are.
            constexpr std::int64_t kMost = std::int64_t{1} << 60;
            if (name == "seq" && *integer >= 0 && *integer <= kMost) {
              number = *integer;
            }
          } else if (const auto* real = std::get_if<double>(&value)) {
            if (!std::isfinite(*real) && not_finite.empty()) {
              not_finite = std::string(name) + " is " + Fixed(*real, 0);
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
    if (utime) CheckTime(event.channel, sender, number, *utime);
  }

  void CheckTime(const std::string& channel,
                 const std::string& sender,
                 std::optional<std::int64_t> number,
                 Time utime) {
    if (channel == kMotionRequest) NoteAsked(utime, sender);
    std::optional<Time> before;
    if (number) before = CheckNumber(channel, sender, *number, utime);
    if (!number) before = LastTime(channel, sender, utime);
    // It carries the time of what it answers, and who asks has a clock of his
    // own: the times of one sender's commands go up and down between those.
    if (channel == kMotionCommand && asked_.contains(utime)) {
      before = LastTime(channel, asked_.at(utime), utime);
    }
    if (before.value_or(utime) <= utime) return;
    AddStep(
        FindingKind::kTimeBackwards, channel, SecondsBetween(utime, *before));
  }

  // Puts `utime` in its place.
  std::optional<Time> LastTime(const std::string& channel,
                               const std::string& sender,
                               Time utime) {
    const auto [last, is_first] =
        last_utime_.try_emplace({channel, sender}, utime);
    if (is_first) return std::nullopt;
    return std::exchange(last->second, utime);
  }

  // Several senders may share a channel, each with a clock of its own. Returns
  // the time of the sender's last message.
  std::optional<Time> CheckNumber(const std::string& channel,
                                  const std::string& sender,
                                  std::int64_t number,
                                  Time utime) {
    const SenderNumbers::Step step =
        numbers_[{channel, sender}].Add(number, utime);
    const std::string detail =
        "number " + std::to_string(number) + " of " +
        (sender.empty() ? "who names no source" : "'" + sender + "'");
    if (step.event == SenderNumbers::Event::kRestart) {
      Add(FindingKind::kRestart, channel, detail);
    } else if (step.event == SenderNumbers::Event::kMixed) {
      Add(FindingKind::kMixedSenders, channel, detail);
    }
    return step.before;
  }

  // For as long as an answer takes, and some more.
  void NoteAsked(Time utime, const std::string& sender) {
    constexpr std::size_t kMaxAsked = 1000;
    asked_[utime] = sender;
    if (asked_.size() > kMaxAsked) asked_.erase(asked_.begin());
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
  // Keys: channel, sender.
  std::map<std::pair<std::string, std::string>, Time> last_utime_;
  std::map<std::pair<std::string, std::string>, SenderNumbers> numbers_;
  std::map<Time, std::string> asked_;  // Who asked, by the request's utime.
  Time last_event_time_;
  std::int64_t num_events_ = 0;
  std::int64_t offset_ = 0;
};

}  // namespace

bool Finding::is_fault() const {
  return kind == FindingKind::kEventTimeBackwards
             ? worst_step_s > kMaxEventStepBackS
             : kind != FindingKind::kUnknownType &&
                   kind != FindingKind::kRestart;
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
