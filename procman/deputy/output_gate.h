// How much of what commands print goes to the network.
#pragma once

#include "estimation/base/time.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

struct OutputGateOptions {
  // Of each command; more is left out, and said how much.
  double bytes_per_second = 100e3;
  double burst_bytes = 200e3;
  // A message goes once so much waits, or so long after the last one.
  std::size_t full_bytes = 4096;
  Duration period = std::chrono::milliseconds(10);
};

struct OutputText {
  std::string command_id;
  std::string text;
};

// Clean text in, messages out: of some commands each. `now` is a steady
// clock's.
class OutputGate {
 public:
  explicit OutputGate(const OutputGateOptions& options = {});

  void Add(const std::string& command_id,
           const std::string& text,
           Duration now);
  // What is to be sent now; empty: nothing.
  [[nodiscard]] std::vector<OutputText> Take(Duration now);
  // When Take() gives something; nullopt: nothing waits.
  [[nodiscard]] std::optional<Duration> next() const;
  // No more comes of it.
  void Forget(const std::string& command_id) { commands_.erase(command_id); }

  [[nodiscard]] std::int64_t num_dropped_bytes() const { return num_dropped_; }

 private:
  struct Command {
    double budget = 0.0;  // Bytes, as of `at`.
    Duration at{};
    std::int64_t num_left_out = 0;  // Not said yet.
    bool is_known = false;
  };

  OutputGateOptions options_;
  std::map<std::string, Command> commands_;
  std::vector<OutputText> waiting_;  // Of each command one, in order.
  std::size_t num_waiting_ = 0;      // Bytes.
  Duration last_sent_{};
  std::int64_t num_dropped_ = 0;
};

}  // namespace waymark
