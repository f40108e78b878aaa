// Whether the machine itself stood still.
#pragma once

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

namespace waymark {

// A virtual machine's processors may be taken from it for a while, and no
// process can do anything about it. On each processor a thread of higher
// priority than any other here (50 at most) looks every 2 ms whether that
// happened. Where real-time priority is not allowed nothing is seen: 0.
class StallWatch {
 public:
  StallWatch();
  ~StallWatch();
  StallWatch(const StallWatch&) = delete;
  StallWatch& operator=(const StallWatch&) = delete;

  // Longest so far.
  [[nodiscard]] std::chrono::microseconds longest() const {
    return std::chrono::microseconds(longest_us_);
  }

 private:
  void Watch(int processor);

  std::atomic<bool> is_over_{false};
  std::atomic<std::chrono::microseconds::rep> longest_us_{0};
  std::vector<std::thread> threads_;
};

}  // namespace waymark
