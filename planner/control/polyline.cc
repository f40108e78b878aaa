#include "planner/control/polyline.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace waymark {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

Polyline::Polyline(std::vector<Eigen::Vector2d> points)
    : points_(std::move(points)) {
  WAYMARK_CHECK(!points_.empty());
  lengths_.push_back(0.0);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const double piece = (points_[i] - points_[i - 1]).norm();
    WAYMARK_CHECK(piece > 0.0, i);
    lengths_.push_back(lengths_.back() + piece);
  }
}

Eigen::Vector2d Polyline::PointAt(double s) const {
  if (points_.size() == 1) return points_[0];
  // The piece that holds s; the last one goes on.
  std::size_t i = 1;
  while (i + 1 < points_.size() && lengths_[i] < s) ++i;
  const double share = (s - lengths_[i - 1]) / (lengths_[i] - lengths_[i - 1]);
  return points_[i - 1] + share * (points_[i] - points_[i - 1]);
}

double Polyline::TurnAt(std::size_t index) const {
  WAYMARK_CHECK(index > 0 && index + 1 < points_.size(), index);
  const Eigen::Vector2d before = points_[index] - points_[index - 1];
  const Eigen::Vector2d after = points_[index + 1] - points_[index];
  return std::atan2(Cross(before, after), before.dot(after));
}

Polyline::Foot Polyline::Project(const Eigen::Vector2d& p,
                                 double from,
                                 double to) const {
  Foot best;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const double low = std::max(from, lengths_[i - 1]);
    const double high = std::min(to, lengths_[i]);
    if (low > high) continue;
    const Eigen::Vector2d direction =
        (points_[i] - points_[i - 1]).normalized();
    const Eigen::Vector2d offset = p - points_[i - 1];
    const double s =
        std::clamp(lengths_[i - 1] + direction.dot(offset), low, high);
    const double distance = (p - PointAt(s)).norm();
    if (distance < nearest) {
      nearest = distance;
      best = {s, std::copysign(distance, Cross(direction, offset))};
    }
  }
  return best;
}

}  // namespace waymark
