// Whether a log can be relied on: its records, its times and what its messages
// say.
#pragma once

#include "logs/log_tool/type_table.h"
#include "processes/support/log_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace waymark {

enum class FindingKind {
  kNotDecodable,        // A known type whose bytes do not decode.
  kNotFinite,           // NaN or infinity in a message of ours.
  kTimeBackwards,       // A utime below the one before, of the same sender.
  kMixedSenders,        // Two count their messages under one name.
  kRestart,             // A sender that counts from the beginning again.
  kEventTimeBackwards,  // The event time below the one before it in the log.
  kUnknownType,         // A fingerprint without definition.
};

// All occurrences of one kind on one channel.
struct Finding {
  FindingKind kind = FindingKind::kUnknownType;
  std::string channel;
  std::int64_t num_events = 0;
  std::int64_t first_event = 0;  // Counted from 0 in the file.
  std::int64_t first_offset = 0;
  std::string detail;         // Of the first: which field, how far back.
  double worst_step_s = 0.0;  // Of times: the farthest step back.

  // A type that we do not know is no fault of the log, nor is a sender that
  // started again (its times may then be others), nor are event times that
  // differ by less than kMaxEventStepBackS: loggers write them in the order of
  // arrival in a queue, and clocks are slewed.
  [[nodiscard]] bool is_fault() const;
  static constexpr double kMaxEventStepBackS = 0.1;
};

struct LogCheck {
  LogReadReport report;
  std::vector<Finding> findings;  // By channel.

  [[nodiscard]] bool is_sound() const;
};

// Reads the whole log. Throws InputError where it cannot be read.
[[nodiscard]] LogCheck CheckLog(const std::string& path, TypeTable* types);

}  // namespace waymark
