// A stop that holds until somebody lets go, whatever happens in between.
#pragma once

#include <waymark/stop_t.hpp>

#include <string>

namespace waymark {

// Keeps itself in a file, so that it outlives its process. What cannot be
// trusted is a stop: a file that cannot be read, is none of its own, or whose
// writing was cut short.
class StopLatch {
 public:
  // `path` empty: kept in memory only, and open at first. No file: open. Throws
  // InputError where nothing can be written there.
  explicit StopLatch(const std::string& path);

  // Latches, or lets go; then writes it down.
  void Set(const stop_t& stop);

  [[nodiscard]] bool is_stopped() const { return is_stopped_; }
  // "stopped by ...", as a person reads it. Empty: it is not stopped.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  // Why it would not outlive a restart; empty: it would.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  void Load();

  std::string path_;
  bool is_stopped_ = false;
  std::string reason_;
  std::string fault_;
};

}  // namespace waymark
