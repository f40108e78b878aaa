#include "drivers/simulator/parallel_rows.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace waymark {

void ForEachRow(int num_rows,
                int num_threads,
                const std::function<void(int row)>& work) {
  std::atomic<int> next_row = 0;
  std::mutex failure_mutex;
  std::exception_ptr failure;
  const auto run = [&] {
    try {
      for (int row = next_row++; row < num_rows; row = next_row++) work(row);
    } catch (...) {
      next_row = num_rows;
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (int i = 1; i < std::min(num_threads, num_rows); ++i) {
      helpers.emplace_back(run);
    }
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace waymark
