#include "processes/support/timers.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace waymark {
namespace {

// Damaged logs have any time: the last one of all stands for never.
Time Later(Time t, Duration period) {
  return t > Time::max() - period ? Time::max() : t + period;
}

}  // namespace

void Timers::Add(Duration period, Action action) {
  WAYMARK_CHECK(period > Duration(0), period.count());
  const Time due = now_ ? Later(*now_, period) : Time();
  timers_.push_back({period, std::move(action), due});
}

void Timers::Start(Time now) {
  now_ = now;
  for (Timer& timer : timers_) timer.due = Later(now, timer.period);
}

std::optional<Time> Timers::next() const {
  if (!now_ || timers_.empty()) return std::nullopt;
  const Time due = std::min_element(timers_.begin(),
                                    timers_.end(),
                                    [](const Timer& a, const Timer& b) {
                                      return a.due < b.due;
                                    })
                       ->due;
  return due == Time::max() ? std::nullopt : std::optional(due);
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
    if (first == timers_.end() || first->due > now ||
        first->due == Time::max()) {
      return;
    }
    const auto num_missed = (now - first->due) / first->period;
    first->due = Later(first->due + num_missed * first->period, first->period);
    // By a copy: the call may add a timer, which moves them.
    const Action action = first->action;
    action(now);
  }
}

}  // namespace waymark
