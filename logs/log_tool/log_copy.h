// Copies of logs: what can be saved, and excerpts.
#pragma once

#include "estimation/base/time.h"
#include "processes/support/log_file.h"

#include <cstdint>
#include <optional>
#include <string>

namespace waymark {

// A moment of a log: "12.5" is seconds from its first event, "1400000000000us"
// a time since the epoch in microseconds.
class LogMoment {
 public:
  // Throws InputError naming `flag` where `text` is neither.
  LogMoment(const std::string& flag, const std::string& text);
  [[nodiscard]] Time In(Time log_start) const;

 private:
  bool is_absolute_ = false;
  Duration value_{};
};

struct LogCopyOptions {
  std::optional<LogMoment> start;  // First to keep.
  std::optional<LogMoment> end;    // First to leave out, so that cuts join.
  std::string channels;  // Regular expression for whole names; "": all.
  bool invert_channels = false;
  IfExists if_exists = IfExists::kFail;
};

struct LogCopyReport {
  LogReadReport read;
  std::int64_t num_events = 0;
  std::int64_t num_bytes = 0;
};

// Copies the events that `options` ask for, in their order, numbered anew.
// Throws InputError where reading or writing fails, `out` exists or is `in`, an
// option is malformed, or no event is left; then `out` is taken away.
LogCopyReport CopyLog(const std::string& in,
                      const std::string& out,
                      const LogCopyOptions& options);

}  // namespace waymark
