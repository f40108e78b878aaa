// Encoder counts made from recorded wheel velocities.
#pragma once

#include <cstdint>

namespace waymark {

// Sums travel and rounds the sum, never the parts: after any number of parts
// the count is within half a tick (and the sum's last bit) of the true sum.
class VirtualCounter {
 public:
  // Travel per tick, > 0, else throws std::logic_error.
  explicit VirtualCounter(double resolution);

  // Throws std::logic_error where travel is not finite or the count would no
  // longer be exact (2^53 ticks).
  void Add(double travel);
  [[nodiscard]] std::int64_t ticks() const;

 private:
  double resolution_;
  double sum_ = 0.0;
  double lost_ = 0.0;  // What adding to sum_ rounded away (Kahan).
};

}  // namespace waymark
