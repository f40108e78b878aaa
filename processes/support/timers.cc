#include "processes/support/timers.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace waymark {

void Timers::Add(Duration period, Action action) {
  WAYMARK_CHECK(period > Duration(0), period.count());
  const Time due = now_ ? *now_ + period : Time();
  timers_.push_back({period, std::move(action), due});
}

void Timers::Start(Time now) {
  now_ = now;
  for (Timer& timer : timers_) timer.due = now + timer.period;
}

std::optional<Time> Timers::next() const {
  if (!now_ || timers_.empty()) return std::nullopt;
  return std::min_element(
             timers_.begin(),
             timers_.end(),
             [](const Timer& a, const Timer& b) { return a.due < b.due; })
      ->due;
}

void Timers::RunDue(Time now) {
  WAYMARK_CHECK(has_started());
  if (now < *now_) Start(now);
  now_ = now;
  while (true) {
    const auto first = std::min_element(
        timers_.begin(), timers_.end(), [](const Timer& a, const Timer& b) {
          return a.due < b.due;
        });
    if (first == timers_.end() || first->due > now) return;
    first->due += first->period * ((now - first->due) / first->period + 1);
    // By a copy: the call may add a timer, which moves them.
    const Action action = first->action;
    action(now);
  }
}

}  // namespace waymark
