// How simulated time goes with a clock.
#pragma once

#include "estimation/base/time.h"

namespace waymark {

// Time that passes `speed` times as fast as a clock. What was missed is made up
// for, but no more than kMaxCatchUp of it: a machine that slept for an hour
// would send a hundred thousand readings at once, which nobody can take in. The
// rest is lost.
class SimulatedClock {
 public:
  static constexpr Duration kMaxCatchUp = std::chrono::seconds(1);

  // Shows `start` at `now`.
  SimulatedClock(double speed, Time now, Time start);

  // At `now`, which does not go back; nor does this.
  [[nodiscard]] Time At(Time now);
  // All simulated time that was lost so far.
  [[nodiscard]] Duration lost() const { return lost_; }

 private:
  double speed_;
  Time begin_;
  Time start_;
  Time shown_;
  Duration lost_{0};
};

}  // namespace waymark
