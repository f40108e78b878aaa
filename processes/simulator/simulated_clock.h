// How simulated time goes with a clock.
#pragma once

#include "estimation/base/time.h"

namespace waymark {

// Time that passes `speed` times as fast as a clock, which is looked at every
// `tick`. What was missed is made up for, but no more than kMaxCatchUp of the
// clock's time, or two ticks if that is longer; the rest is lost. A machine
// that stood still for longer kept the other processes from answering too: made
// up for, that time would be driven without them until the command's time-out,
// and after an hour's sleep a hundred thousand readings would come at once.
class SimulatedClock {
 public:
  static constexpr Duration kMaxCatchUp = std::chrono::milliseconds(100);

  // Shows `start` at `now`.
  SimulatedClock(double speed, Duration tick, Time now, Time start);

  // At `now`, which does not go back; nor does this.
  [[nodiscard]] Time At(Time now);
  // All simulated time that was lost so far.
  [[nodiscard]] Duration lost() const { return lost_; }

 private:
  double speed_;
  Time begin_;
  Time start_;
  Duration max_catch_up_;  // Of simulated time.
  Time shown_;
  Duration lost_{0};
};

}  // namespace waymark
