// Time stamps: microseconds since the Unix epoch, as in every message's utime.
#pragma once

#include <chrono>
#include <cstdint>

namespace waymark {

using Duration = std::chrono::duration<std::int64_t, std::micro>;

// Clock tag of event time. It has no now(): algorithms never read a clock.
struct EventClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<EventClock>;
  static constexpr bool is_steady = false;
};

using Time = EventClock::time_point;

constexpr Time TimeFromMicroseconds(std::int64_t utime) {
  return Time(Duration(utime));
}
constexpr std::int64_t Microseconds(Time t) {
  return t.time_since_epoch().count();
}
// Differences only: a double has too few digits for a stamp.
constexpr double Seconds(Duration d) {
  return std::chrono::duration<double>(d).count();
}
// Rounds to the nearest microsecond.
constexpr Duration DurationFromSeconds(double seconds) {
  return Duration(
      static_cast<std::int64_t>(seconds * 1e6 + (seconds < 0 ? -0.5 : 0.5)));
}

}  // namespace waymark
