#include "estimation/filter/pose_history.h"

#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace waymark {

void PoseHistoryOptions::Check() const {
  for (const auto& [key, value] :
       {std::pair("length_s", length_s),
        std::pair("max_ahead_s", max_ahead_s),
        std::pair("acceleration", acceleration),
        std::pair("turn_acceleration", turn_acceleration)}) {
    if (value >= 0.0 && std::isfinite(value)) continue;
    throw std::invalid_argument(std::string(key) + ": " +
                                std::to_string(value) +
                                " must be finite and not negative");
  }
}

PoseHistory::PoseHistory(const PoseHistoryOptions& options)
    : options_(options) {
  options.Check();
}

void PoseHistory::Add(const PoseEstimate& estimate) {
  if (!estimate.is_known ||
      (!poses_.empty() && estimate.time < poses_.back().time)) {
    poses_.clear();
  }
  if (!estimate.is_known) return;
  // A second one of the same time is the better one.
  if (!poses_.empty() && poses_.back().time == estimate.time) {
    poses_.pop_back();
  }
  poses_.push_back(estimate);
  const Duration length = DurationFromSeconds(options_.length_s);
  while (estimate.time - poses_.front().time > length) poses_.pop_front();
}

std::optional<PoseEstimate> PoseHistory::At(Time time) const {
  if (poses_.empty() || time < poses_.front().time) return std::nullopt;
  const auto after = std::lower_bound(
      poses_.begin(), poses_.end(), time, [](const PoseEstimate& p, Time t) {
        return p.time < t;
      });
  if (after == poses_.end()) {
    const double seconds = Seconds(time - poses_.back().time);
    if (seconds > options_.max_ahead_s) return std::nullopt;
    return Ahead(seconds);
  }
  if (after->time == time) return *after;
  const PoseEstimate& a = *(after - 1);
  const double share = Seconds(time - a.time) / Seconds(after->time - a.time);
  PoseEstimate between = *after;
  between.time = time;
  between.X_WR.x = a.X_WR.x + share * (after->X_WR.x - a.X_WR.x);
  between.X_WR.y = a.X_WR.y + share * (after->X_WR.y - a.X_WR.y);
  between.X_WR.heading = WrapAngle(
      a.X_WR.heading + share * WrapAngle(after->X_WR.heading - a.X_WR.heading));
  between.covariance = (1.0 - share) * a.covariance + share * after->covariance;
  return between;
}

PoseEstimate PoseHistory::Ahead(double seconds) const {
  PoseEstimate ahead = poses_.back();
  const double turn = ahead.turn_rate * seconds;
  const double way = ahead.forward_speed * seconds;
  // The chord of the arc that the speeds make.
  ahead.X_WR = ahead.X_WR * Pose2{way * std::cos(0.5 * turn),
                                  way * std::sin(0.5 * turn),
                                  WrapAngle(turn)};
  ahead.time += DurationFromSeconds(seconds);
  const double half = 0.5 * seconds * seconds;
  const double position = half * options_.acceleration;
  const double heading = half * options_.turn_acceleration;
  ahead.covariance +=
      Eigen::Vector3d(
          position * position, position * position, heading * heading)
          .asDiagonal();
  return ahead;
}

}  // namespace waymark
