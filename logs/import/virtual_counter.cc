#include "logs/import/virtual_counter.h"

#include "estimation/base/check.h"

#include <cmath>

namespace waymark {

VirtualCounter::VirtualCounter(double resolution) : resolution_(resolution) {
  WAYMARK_CHECK(resolution > 0.0 && std::isfinite(resolution), resolution);
}

void VirtualCounter::Add(double travel) {
  const double part = travel - lost_;
  const double sum = sum_ + part;
  lost_ = (sum - sum_) - part;
  sum_ = sum;
  // Beyond 2^53 a double skips integers. Also false where travel is NaN.
  WAYMARK_CHECK(std::abs(sum_ / resolution_) < 9007199254740992.0, travel);
}

std::int64_t VirtualCounter::ticks() const {
  return std::llround(sum_ / resolution_);
}

}  // namespace waymark
