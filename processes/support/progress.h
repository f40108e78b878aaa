// A line on the terminal that says how far long work has come.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace waymark {

enum class ProgressUnit {
  kBytes,
  kRuns,  // Long ones: the time left is shown too.
};

// Silent where stderr is no terminal, and in the first half second.
class Progress {
 public:
  // `what` is "reading drive.log"; `total` at least 0. `already`: of it, done
  // before this began; says nothing of the pace.
  Progress(std::string what,
           std::int64_t total,
           ProgressUnit unit = ProgressUnit::kBytes,
           std::int64_t already = 0);
  ~Progress();  // Clears.
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(std::int64_t done);
  // Takes the line away, for output that follows.
  void Clear();

 private:
  std::string what_;
  std::int64_t total_;
  std::int64_t already_;
  ProgressUnit unit_;
  bool is_terminal_;
  bool is_shown_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point next_;
};

// How long the rest takes at the pace so far: "2 min left"; empty before
// anything is done.
[[nodiscard]] std::string TimeLeftText(std::chrono::duration<double> passed,
                                       std::int64_t done,
                                       std::int64_t total);

// "drive: 214 of 1000, 2 min left".
[[nodiscard]] std::string RunsText(const std::string& what,
                                   std::chrono::duration<double> passed,
                                   std::int64_t already,
                                   std::int64_t done,
                                   std::int64_t total);

}  // namespace waymark
