// Calls that come back every so often, on whatever clock a bus has.
#pragma once

#include "estimation/base/time.h"

#include <functional>
#include <optional>
#include <vector>

namespace waymark {

// Not thread-safe.
class Timers {
 public:
  using Action = std::function<void(Time)>;

  // Calls `action` every `period`. Throws std::logic_error unless the period
  // is positive. One that is added after Start() is due from the last time
  // that was told.
  void Add(Duration period, Action action);

  // The first calls are due one period after `now`.
  void Start(Time now);
  [[nodiscard]] bool has_started() const { return now_.has_value(); }

  // When the next call is due; nullopt before Start(), without a timer, and
  // where none is due before the end of time.
  [[nodiscard]] std::optional<Time> next() const;

  // Makes the calls that are due at `now`, in the order of their due times,
  // then in that of Add(). One that missed several periods is called once and
  // keeps its phase; where `now` has gone back, all start anew from there. What
  // a call throws passes through.
  void RunDue(Time now);

 private:
  struct Timer {
    Duration period;
    Action action;
    Time due;
  };

  std::vector<Timer> timers_;
  std::optional<Time> now_;
};

}  // namespace waymark
