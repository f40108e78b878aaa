#include "logs/log_tool/log_summary.h"

#include "logs/log_tool/message_sequence.h"
#include "logs/log_tool/text_table.h"
#include "processes/support/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>

namespace waymark {
namespace {

// Collects one channel; mean and variance of its intervals by Welford's
// method, because sums of squares of long logs lose digits.
class ChannelCollector {
 public:
  void Add(const LogEvent& event, const MessageTypeInfo& type) {
    if (std::find(types_.begin(), types_.end(), &type) == types_.end()) {
      types_.push_back(&type);
      summary_.types.push_back(type.name);
    }
    if (const auto sequence = SequenceOfMessage(type, event.data)) {
      sequences_.Add(*sequence);
    }
    if (summary_.num_events == 0) {
      summary_.first = event.time;
    } else {
      AddInterval(summary_.last, event.time);
    }
    ++summary_.num_events;
    summary_.num_bytes += static_cast<std::int64_t>(event.data.size());
    summary_.last = event.time;
  }

  [[nodiscard]] ChannelSummary Finish(const std::string& channel) const {
    ChannelSummary result = summary_;
    result.channel = channel;
    result.num_lost = sequences_.num_lost();
    if (num_intervals_ > 0 && mean_s_ > 0.0) {
      result.rate_hz = 1.0 / mean_s_;
      result.jitter_s =
          std::sqrt(sum_squares_ / static_cast<double>(num_intervals_));
    }
    return result;
  }

 private:
  void AddInterval(Time from, Time to) {
    const double interval_s = SecondsBetween(from, to);
    constexpr double kMostSeconds = 9e12;  // As much as a Duration holds.
    const bool is_longer =
        std::abs(interval_s) < kMostSeconds && to - from > summary_.longest_gap;
    if (is_longer) summary_.longest_gap = to - from;
    if (is_longer || summary_.num_events == 1) {
      summary_.longest_gap_start = from;
    }
    // An appended log starts over: no interval.
    if (interval_s < 0.0) return;
    ++num_intervals_;
    const double step = interval_s - mean_s_;
    mean_s_ += step / static_cast<double>(num_intervals_);
    sum_squares_ += step * (interval_s - mean_s_);
  }

  ChannelSummary summary_;
  std::vector<const MessageTypeInfo*> types_;
  SequenceCounter sequences_;
  std::int64_t num_intervals_ = 0;
  double mean_s_ = 0.0;
  double sum_squares_ = 0.0;
};

}  // namespace

LogSummary SummariseLog(const std::string& path, TypeTable* types) {
  LogReader reader(path);
  Progress progress("reading " + path, reader.report().num_file_bytes);
  LogSummary summary;
  summary.path = path;
  std::map<std::string, ChannelCollector> channels;
  bool is_first = true;
  while (const auto event = reader.Next()) {
    progress.Show(reader.offset());
    channels[event->channel].Add(*event, types->Find(event->data));
    summary.first =
        is_first ? event->time : std::min(summary.first, event->time);
    summary.last = is_first ? event->time : std::max(summary.last, event->time);
    is_first = false;
  }
  summary.report = reader.report();
  for (const auto& [name, channel] : channels) {
    summary.channels.push_back(channel.Finish(name));
  }
  return summary;
}

std::string DamageText(const std::string& path,
                       const LogReadReport& report,
                       std::size_t max_lines) {
  if (report.is_sound()) return "";
  std::string text =
      "damaged: " + report.SkippedText() + " belong to no record\n";
  const std::size_t num_lines = std::min(max_lines, report.gaps.size());
  for (std::size_t i = 0; i < num_lines; ++i) {
    const auto& gap = report.gaps[i];
    const bool is_end =
        report.torn_end && gap.offset + gap.num_bytes == report.num_file_bytes;
    text += "  byte " + std::to_string(gap.offset) + " to " +
            std::to_string(gap.offset + gap.num_bytes - 1) + ": " +
            std::to_string(gap.num_bytes) + " bytes after " +
            std::to_string(gap.num_events_before) + " events" +
            (is_end ? " (torn end)" : "") + "\n";
  }
  if (static_cast<std::int64_t>(num_lines) < report.num_gaps) {
    text +=
        "  and " +
        std::to_string(report.num_gaps - static_cast<std::int64_t>(num_lines)) +
        " more\n";
  }
  return text + "  save the rest with: waymark-log repair " + path + " OUT\n";
}

std::string DateText(Time time) {
  const std::int64_t utime = Microseconds(time);
  const std::int64_t seconds = utime / 1'000'000 - (utime % 1'000'000 < 0);
  const std::int64_t micros =
      utime % 1'000'000 + (utime % 1'000'000 < 0 ? 1'000'000 : 0);
  const auto calendar_seconds = static_cast<std::time_t>(seconds);
  std::tm calendar{};
  if (gmtime_r(&calendar_seconds, &calendar) == nullptr) {
    return std::to_string(utime) + " us";
  }
  char text[64];
  std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M:%S", &calendar);
  char result[96];
  std::snprintf(result,
                sizeof(result),
                "%s.%03d UTC",
                text,
                static_cast<int>(micros / 1000));
  return result;
}

}  // namespace waymark
