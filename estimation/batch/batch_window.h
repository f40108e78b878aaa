// The newest stretch of a running robot's inputs, bounded in time and memory.
#pragma once

#include "estimation/batch/batch_types.h"

#include <optional>

namespace waymark {

struct BatchWindowOptions {
  double window_s = 120.0;      // Length of what is kept.
  int max_readings = 50000;     // Bounds of memory, whatever the rates.
  int max_measurements = 5000;  // Of each kind.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Inputs of one robot as a BatchLog of the last window_s before its newest
// reading. O(1) per input, amortised.
class BatchWindow {
 public:
  explicit BatchWindow(const BatchWindowOptions& options);

  // Readings in time order; what is older than the window goes.
  void Add(const EncoderReading& reading);
  void Add(const AbsoluteFix& fix);
  void Add(const RelativeMotion& motion);
  void Clear();

  // Drops everything older than the window and returns the rest.
  [[nodiscard]] const BatchLog& Log();
  [[nodiscard]] std::optional<Time> newest() const;
  // Left out because a bound of memory was reached.
  [[nodiscard]] std::int64_t num_displaced() const { return num_displaced_; }

 private:
  BatchWindowOptions options_;
  BatchLog log_;
  std::int64_t num_displaced_ = 0;
};

}  // namespace waymark
