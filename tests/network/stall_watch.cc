#include "tests/network/stall_watch.h"

#include <sched.h>

namespace waymark {

StallWatch::StallWatch() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  ::sched_getaffinity(0, sizeof(allowed), &allowed);
  for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
    if (!CPU_ISSET(static_cast<unsigned>(processor), &allowed)) continue;
    threads_.emplace_back([this, processor] { Watch(processor); });
  }
}

StallWatch::~StallWatch() {
  is_over_ = true;
  for (std::thread& thread : threads_) thread.join();
}

void StallWatch::Watch(int processor) {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(static_cast<unsigned>(processor), &only);
  sched_param highest{};
  highest.sched_priority = ::sched_get_priority_max(SCHED_FIFO);
  if (::sched_setaffinity(0, sizeof(only), &only) != 0 ||
      ::sched_setscheduler(0, SCHED_FIFO, &highest) != 0) {
    return;
  }
  constexpr std::chrono::milliseconds kPeriod{2};
  auto before = std::chrono::steady_clock::now();
  while (!is_over_) {
    std::this_thread::sleep_for(kPeriod);
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::microseconds late =
        std::chrono::duration_cast<std::chrono::microseconds>(now - before -
                                                              kPeriod);
    before = now;
    auto longest = longest_us_.load();
    while (late.count() > longest &&
           !longest_us_.compare_exchange_weak(longest, late.count())) {
    }
  }
}

}  // namespace waymark
