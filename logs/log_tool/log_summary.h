// What a log holds: channels, types, rates, gaps.
#pragma once

#include "estimation/base/time.h"
#include "logs/log_tool/type_table.h"
#include "processes/support/log_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace waymark {

struct ChannelSummary {
  std::string channel;
  std::vector<std::string> types;  // In the order in which they appear.
  std::int64_t num_events = 0;
  std::int64_t num_bytes = 0;  // Of the messages, without record headers.
  // Event times; the rest follows from them and from their order in the file.
  Time first;
  Time last;
  // Over the intervals that are not negative; 0 with fewer than two events.
  double rate_hz = 0.0;
  double jitter_s = 0.0;   // Standard deviation of the intervals.
  Duration longest_gap{};  // Between two events.
  Time longest_gap_start;
  std::int64_t num_lost = -1;  // Missing sequence numbers; -1: has none.
};

struct LogSummary {
  std::string path;
  LogReadReport report;
  Time first;                            // Least event time.
  Time last;                             // Greatest event time.
  std::vector<ChannelSummary> channels;  // By name.
};

// Reads the whole log. Throws InputError where it cannot be read.
[[nodiscard]] LogSummary SummariseLog(const std::string& path,
                                      TypeTable* types);

// One line per gap for at most `max_lines` of them, and what to do; "" where
// the log is sound.
[[nodiscard]] std::string DamageText(const std::string& path,
                                     const LogReadReport& report,
                                     std::size_t max_lines);

// Through double: damaged stamps may lie further apart than a Duration holds.
[[nodiscard]] inline double SecondsBetween(Time from, Time to) {
  return 1e-6 * (static_cast<double>(Microseconds(to)) -
                 static_cast<double>(Microseconds(from)));
}

// "2014-10-12 14:22:01.123 UTC".
[[nodiscard]] std::string DateText(Time time);

}  // namespace waymark
