#include "processes/simulator/simulated_clock.h"

#include <algorithm>

namespace waymark {

SimulatedClock::SimulatedClock(double speed,
                               Duration tick,
                               Time now,
                               Time start)
    : speed_(speed),
      begin_(now),
      start_(start),
      max_catch_up_(DurationFromSeconds(
          speed * Seconds(std::max(kMaxCatchUp, 2 * tick)))),
      shown_(start) {}

Time SimulatedClock::At(Time now) {
  // From the beginning, so that roundings do not add up.
  const Time due =
      start_ + DurationFromSeconds(speed_ * Seconds(now - begin_)) - lost_;
  const Duration too_late = due - shown_ - max_catch_up_;
  if (too_late > Duration(0)) lost_ += too_late;
  shown_ = std::clamp(due, shown_, shown_ + max_catch_up_);
  return shown_;
}

}  // namespace waymark
