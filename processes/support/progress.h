// A line on the terminal that says how far long work has come.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace waymark {

// Silent where stderr is no terminal, and in the first half second.
class Progress {
 public:
  // `what` is "reading drive.log"; `total` in bytes, at least 0.
  Progress(std::string what, std::int64_t total);
  ~Progress();  // Clears.
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(std::int64_t done);
  // Takes the line away, for output that follows.
  void Clear();

 private:
  std::string what_;
  std::int64_t total_;
  bool is_terminal_;
  bool is_shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace waymark
