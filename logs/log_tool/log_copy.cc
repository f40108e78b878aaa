#include "logs/log_tool/log_copy.h"

#include "processes/support/progress.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <regex>

namespace waymark {
namespace {

std::regex ChannelRegex(const std::string& text) {
  try {
    return std::regex(text);
  } catch (const std::regex_error& error) {
    throw InputError("--channels: '" + text +
                     "' is no regular expression: " + error.what());
  }
}

class EventFilter {
 public:
  explicit EventFilter(const LogCopyOptions& options)
      : options_(options), channels_(ChannelRegex(options.channels)) {}

  // Before the first event is asked for.
  void Begin(Time log_start) {
    log_start_ = log_start;
    if (options_.start && options_.end &&
        options_.end->In(log_start) <= options_.start->In(log_start)) {
      throw InputError("--end: must be later than --start");
    }
  }

  bool Keeps(const LogEvent& event) const {
    if (options_.start && event.time < options_.start->In(log_start_)) {
      return false;
    }
    if (options_.end && event.time >= options_.end->In(log_start_)) {
      return false;
    }
    return options_.channels.empty() ||
           std::regex_match(event.channel, channels_) !=
               options_.invert_channels;
  }

 private:
  const LogCopyOptions& options_;
  std::regex channels_;
  Time log_start_;
};

}  // namespace

LogMoment::LogMoment(const std::string& flag, const std::string& text) {
  const char* const end = text.data() + text.size();
  std::int64_t utime = 0;
  const auto integer = std::from_chars(text.data(), end, utime);
  if (integer.ec == std::errc() && std::string_view(integer.ptr, end) == "us") {
    is_absolute_ = true;
    value_ = Duration(utime);
    return;
  }
  double seconds = 0.0;
  const auto number = std::from_chars(text.data(), end, seconds);
  constexpr double kMostSeconds = 1e9;  // Longer than any recording.
  if (number.ec != std::errc() || number.ptr != end || !(seconds >= 0.0) ||
      seconds > kMostSeconds) {
    throw InputError(flag + ": '" + text +
                     "' is neither seconds from the log's start (0 or more) "
                     "nor a time since the epoch like 1400000000000000us");
  }
  value_ = DurationFromSeconds(seconds);
}

Time LogMoment::In(Time log_start) const {
  if (is_absolute_) return Time(value_);
  // A damaged first stamp may leave no room for it.
  return log_start > Time::max() - value_ ? Time::max() : log_start + value_;
}

LogCopyReport CopyLog(const std::string& in,
                      const std::string& out,
                      const LogCopyOptions& options) {
  EventFilter filter(options);
  LogReader reader(in);
  CheckOutput(out, options.if_exists, {&in, 1});
  std::optional<LogEvent> event = reader.Next();
  if (event) filter.Begin(event->time);
  LogWriter writer(out, options.if_exists);
  Progress progress("copying " + in, reader.report().num_file_bytes);
  for (; event; event = reader.Next()) {
    progress.Show(reader.offset());
    if (filter.Keeps(*event)) {
      writer.Write(event->time, event->channel, event->data);
    }
  }
  writer.Close();
  if (writer.num_events() == 0) {
    std::filesystem::remove(out);
    throw InputError(in + ": none of its " +
                     std::to_string(reader.report().num_events) +
                     " events is left, so " + out + " was not written");
  }
  return {reader.report(), writer.num_events(), writer.num_bytes()};
}

}  // namespace waymark
