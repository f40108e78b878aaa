#include "estimation/batch/batch_window.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

// Makes room by dropping the oldest quarter, so that the cost of moving the
// rest is shared by many inputs.
template <typename T>
std::int64_t Bound(std::vector<T>* items, int max) {
  if (items->size() < static_cast<std::size_t>(max)) return 0;
  const auto num_dropped = static_cast<std::ptrdiff_t>(max) / 4 + 1;
  items->erase(items->begin(), items->begin() + num_dropped);
  return num_dropped;
}

}  // namespace

void BatchWindowOptions::Check() const {
  if (!(window_s > 0.0) || !std::isfinite(window_s)) {
    throw std::invalid_argument("window_s = " + std::to_string(window_s) +
                                " is not above 0");
  }
  if (max_readings < 4 || max_measurements < 4) {
    throw std::invalid_argument(
        "max_readings and max_measurements: at least 4");
  }
}

BatchWindow::BatchWindow(const BatchWindowOptions& options)
    : options_(options) {
  options_.Check();
}

void BatchWindow::Add(const EncoderReading& reading) {
  num_displaced_ += Bound(&log_.encoders, options_.max_readings);
  log_.encoders.push_back(reading);
}

void BatchWindow::Add(const AbsoluteFix& fix) {
  num_displaced_ += Bound(&log_.fixes, options_.max_measurements);
  log_.fixes.push_back(fix);
}

void BatchWindow::Add(const RelativeMotion& motion) {
  num_displaced_ += Bound(&log_.motions, options_.max_measurements);
  log_.motions.push_back(motion);
}

void BatchWindow::Clear() {
  log_ = BatchLog{};
}

const BatchLog& BatchWindow::Log() {
  if (log_.encoders.empty()) return log_;
  const Time begin =
      log_.encoders.back().time - DurationFromSeconds(options_.window_s);
  std::erase_if(log_.encoders, [&](const auto& r) { return r.time < begin; });
  std::erase_if(log_.fixes, [&](const auto& f) { return f.time < begin; });
  std::erase_if(log_.motions, [&](const auto& m) { return m.from < begin; });
  return log_;
}

std::optional<Time> BatchWindow::newest() const {
  if (log_.encoders.empty()) return std::nullopt;
  return log_.encoders.back().time;
}

}  // namespace waymark
