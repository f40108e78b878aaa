#include "drivers/simulator/people.h"

#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace waymark {
namespace {

// Bearings tried beside the robot: two degrees apart, 2 cm at arm's length.
constexpr int kNumBearings = 180;
// Intrusions that differ by less are alike, m.
constexpr double kSameIntrusion = 0.005;

double HeadingOf(const Eigen::Vector2d& direction) {
  return std::atan2(direction.y(), direction.x());
}

}  // namespace

void PeopleOptions::Check() const {
  if (!(robot_radius > 0.0 && robot_radius <= 10.0)) {
    throw std::invalid_argument("robot_radius: must be in (0, 10]");
  }
}

People::People(const World& world, const PeopleOptions& options)
    : people_(world.people), area_(world), options_(options) {
  options.Check();
  for (const WorldPerson& person : people_) {
    Path path;
    if (person.motion == PersonMotion::kWalk) {
      path.points = person.path;
      if (person.is_closed && !path.points.empty()) {
        path.points.push_back(path.points.front());
      }
      double along = 0.0;
      for (std::size_t i = 0; i < path.points.size(); ++i) {
        if (i > 0) along += (path.points[i] - path.points[i - 1]).norm();
        path.along.push_back(along);
      }
      if (!(along > 0.0)) {
        throw InputError(person.where + ": path: must have a length");
      }
    }
    paths_.push_back(std::move(path));
  }
}

std::vector<Pose2> People::PosesAt(double seconds, const Pose2& X_WR) const {
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < people_.size(); ++i) {
    const WorldPerson& person = people_[i];
    switch (person.motion) {
      case PersonMotion::kStand:
        poses.push_back(
            {person.at.x(), person.at.y(), WrapAngle(person.heading)});
        break;
      case PersonMotion::kWalk:
        poses.push_back(Walk(person, paths_[i], seconds));
        break;
      case PersonMotion::kBeside:
        poses.push_back(Beside(person, X_WR, poses));
        break;
    }
  }
  return poses;
}

Pose2 People::Walk(const WorldPerson& person,
                   const Path& path,
                   double seconds) const {
  const double length = path.along.back();
  const double period = person.is_closed ? length : 2.0 * length;
  double way = std::fmod(person.start + person.speed * seconds, period);
  if (way < 0.0) way += period;
  const bool is_returning = way > length;
  if (is_returning) way = period - way;
  const auto next = std::upper_bound(path.along.begin(), path.along.end(), way);
  const auto to = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      next - path.along.begin(),
      1,
      static_cast<std::ptrdiff_t>(path.along.size()) - 1));
  const Eigen::Vector2d& a = path.points[to - 1];
  const Eigen::Vector2d& b = path.points[to];
  const double part = path.along[to] - path.along[to - 1];
  const double t = part > 0.0 ? (way - path.along[to - 1]) / part : 0.0;
  const Eigen::Vector2d at = a + t * (b - a);
  const Eigen::Vector2d ahead = is_returning ? Eigen::Vector2d(a - b) : b - a;
  return {at.x(), at.y(), HeadingOf(ahead)};
}

Pose2 People::Beside(const WorldPerson& person,
                     const Pose2& X_WR,
                     const std::vector<Pose2>& others) const {
  const double distance =
      options_.robot_radius + person.clearance + kPersonRadius;
  Pose2 best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kNumBearings; ++i) {
    // 0, +1, -1, +2, -2, ...: the nearest free bearing comes first.
    const int step = (i + 1) / 2 * (i % 2 == 1 ? 1 : -1);
    const double bearing = X_WR.heading + person.bearing +
                           2.0 * std::numbers::pi * step / kNumBearings;
    const Eigen::Vector2d at =
        X_WR.position() +
        distance * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
    double intrusion = std::max(0.0, kPersonRadius - area_.Clearance(at));
    for (const Pose2& other : others) {
      intrusion = std::max(
          intrusion, 2.0 * kPersonRadius - (other.position() - at).norm());
    }
    const bool is_free = intrusion <= 0.0;
    if (is_free || intrusion < least - kSameIntrusion) {
      least = intrusion;
      best = {at.x(), at.y(), X_WR.heading};
    }
    if (is_free) break;
  }
  return best;
}

}  // namespace waymark
