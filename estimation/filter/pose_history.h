// Where the robot was believed to be a moment ago.
#pragma once

#include "estimation/base/time.h"
#include "estimation/filter/estimate_types.h"

#include <deque>
#include <optional>

namespace waymark {

struct PoseHistoryOptions {
  double length_s = 5.0;  // Older poses are forgotten.
  // After the newest pose its speeds are taken to go on, so long at most,
  double max_ahead_s = 0.3;
  // and to change by so much, 1 sigma.
  double acceleration = 1.0;       // m/s^2.
  double turn_acceleration = 2.0;  // rad/s^2.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Poses of a filter, to be asked for the time of an image that took longer
// than they did. Deterministic; O(log of what is kept).
class PoseHistory {
 public:
  // Throws as Check() does.
  explicit PoseHistory(const PoseHistoryOptions& options = {});

  // Known poses in time order. One that is not known, or of a time before the
  // newest, starts the history anew: what was believed is not believed now.
  void Add(const PoseEstimate& estimate);

  // Between two poses linear, the covariance too; nullopt before the first
  // and more than max_ahead_s behind the last.
  [[nodiscard]] std::optional<PoseEstimate> At(Time time) const;

 private:
  [[nodiscard]] PoseEstimate Ahead(double seconds) const;

  PoseHistoryOptions options_;
  std::deque<PoseEstimate> poses_;
};

}  // namespace waymark
