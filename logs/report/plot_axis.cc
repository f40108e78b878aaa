#include "logs/report/plot_axis.h"

#include "estimation/base/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

// The smallest of 1, 2, 5 times a power of ten that is at least `rough`.
double NiceStep(double rough) {
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  // A rough step that is a nice one up to rounding is taken as it is.
  constexpr double kRounding = 1.0 + 1e-9;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power * kRounding >= rough) return factor * power;
  }
  return 10.0 * power;
}

std::string TickText(double value, double step) {
  const int decimals =
      std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 9);
  // "-0" is 0.
  return fmt::format(
      "{:.{}f}", std::abs(value) < 1e-9 * step ? 0.0 : value, decimals);
}

}  // namespace

PlotAxis::PlotAxis(double low, double high, bool is_log, int num_ticks)
    : low_(low), high_(high), is_log_(is_log) {
  WAYMARK_CHECK(
      std::isfinite(low) && std::isfinite(high) && low <= high, low, high);
  if (is_log) {
    WAYMARK_CHECK(low > 0.0, low);
    low_ = std::pow(10.0, std::floor(std::log10(low) + 1e-9));
    high_ = std::pow(10.0, std::ceil(std::log10(high) - 1e-9));
    if (high_ <= low_) high_ = 10.0 * low_;
    for (double value = low_; value < 1.001 * high_; value *= 10.0) {
      ticks_.push_back({value, fmt::format("{:g}", value)});
    }
    return;
  }
  // All values equal: a range about them, so that the line is in the middle.
  if (high_ - low_ <= 1e-12 * std::max(std::abs(low_), std::abs(high_))) {
    const double margin = low_ == 0.0 ? 1.0 : 0.01 * std::abs(low_);
    low_ -= margin;
    high_ += margin;
  }
  const double step = NiceStep((high_ - low_) / num_ticks);
  for (double k = std::ceil(low_ / step - 1e-9);
       k * step <= high_ + 1e-9 * step;
       k += 1.0) {
    ticks_.push_back({k * step, TickText(k * step, step)});
  }
}

double PlotAxis::Place(double value) const {
  if (is_log_) {
    return std::log10(value / low_) / std::log10(high_ / low_);
  }
  return (value - low_) / (high_ - low_);
}

}  // namespace waymark
