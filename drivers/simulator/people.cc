#include "drivers/simulator/people.h"

#include "estimation/base/check.h"
#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

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
    : People(world, WalkArea(world), options) {}

People::People(const World& world, WalkArea area, const PeopleOptions& options)
    : people_(world.people), area_(std::move(area)), options_(options) {
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

std::vector<Pose2> People::PosesAt(double seconds,
                                   const Pose2& X_WR,
                                   std::span<const PersonState> states) const {
  WAYMARK_CHECK(states.empty() || states.size() == people_.size(),
                states.size(),
                people_.size());
  const PersonState fresh;
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < people_.size(); ++i) {
    const WorldPerson& person = people_[i];
    switch (person.motion) {
      case PersonMotion::kStand:
        poses.push_back(
            {person.at.x(), person.at.y(), WrapAngle(person.heading)});
        break;
      case PersonMotion::kWalk:
        poses.push_back(Walk(
            person, paths_[i], states.empty() ? fresh : states[i], seconds));
        break;
      case PersonMotion::kBeside: {
        const auto known = states.empty() ? std::nullopt : states[i].bearing_W;
        const double wanted = X_WR.heading + person.bearing;
        poses.push_back(
            Beside(person,
                   X_WR,
                   known ? *known : FreeBearing(person, X_WR, wanted, poses),
                   known ? states[i].squeezed : 0.0));
        break;
      }
    }
  }
  return poses;
}

void People::Meet(double seconds,
                  double dt,
                  const Pose2& X_WR,
                  std::vector<PersonState>* states) const {
  states->resize(people_.size());
  std::vector<Pose2> others;  // Those before, who have moved already.
  for (std::size_t i = 0; i < people_.size(); ++i) {
    const WorldPerson& person = people_[i];
    PersonState* state = &(*states)[i];
    if (person.motion == PersonMotion::kWalk) {
      MeetAsWalker(Walk(person, paths_[i], *state, seconds), dt, X_WR, state);
      others.push_back(Walk(person, paths_[i], *state, seconds));
    } else if (person.motion == PersonMotion::kStand) {
      others.push_back({person.at.x(), person.at.y(), person.heading});
    } else {
      state->bearing_W =
          state->bearing_W
              ? GoAround(person, X_WR, *state->bearing_W, dt, others)
              : FreeBearing(
                    person, X_WR, X_WR.heading + person.bearing, others);
      const double wish =
          std::clamp(Intrusion(person, X_WR, *state->bearing_W, others),
                     0.0,
                     std::max(0.0, person.clearance - kLeastGap));
      const double most = kSqueezeSpeed * dt;
      state->squeezed += std::clamp(wish - state->squeezed, -most, most);
      others.push_back(
          Beside(person, X_WR, *state->bearing_W, state->squeezed));
    }
  }
}

void People::MeetAsWalker(const Pose2& X_WP,
                          double dt,
                          const Pose2& X_WR,
                          PersonState* state) const {
  const double touching = kPersonRadius + options_.robot_radius;
  const Eigen::Vector2d p_PR = Inverse(X_WP) * X_WR.position();
  const double gap = p_PR.norm() - touching;
  const double way = kAsideSpeed * dt;
  const Eigen::Rotation2Dd R_WP(X_WP.heading);
  if (state->patience_s >= kPatienceS && gap < kLookGap) {
    // Gives way, wherever they were going, until the robot is gone: away from
    // it, or along what is in the way of that.
    state->waited_s += dt;
    if (gap >= kGiveGap) return;
    const Eigen::Vector2d away = -way * (R_WP * p_PR.normalized());
    for (const double turn : {0.0, 0.7, -0.7, 1.4, -1.4}) {
      if (Shift(X_WP, Eigen::Rotation2Dd(turn) * away, X_WR, state)) return;
    }
    return;
  }
  const bool is_near = gap < kLookGap && p_PR.x() > -touching;
  if (!is_near) {
    state->patience_s = 0.0;
    const double left = state->aside_W.norm();
    if (left > 0.0) {
      (void)Shift(
          X_WP, -std::min(way / left, 1.0) * state->aside_W, X_WR, state);
    }
  }
  // Aside enough, they stay there until they are past it.
  if (!is_near || std::abs(p_PR.y()) >= touching + kPassGap) return;
  const double left = p_PR.y() > 0.0 ? -way : way;
  (void)Shift(X_WP, R_WP * Eigen::Vector2d(0.0, left), X_WR, state);
  if (p_PR.x() > 0.0 && gap < kWaitGap) {
    state->waited_s += dt;
    state->patience_s += dt;
  }
}

bool People::Shift(const Pose2& X_WP,
                   const Eigen::Vector2d& step_W,
                   const Pose2& X_WR,
                   PersonState* state) const {
  const Eigen::Vector2d to = X_WP.position() + step_W;
  // Room for the elbows, or more than before.
  constexpr double kElbows = 0.03;
  const double clearance = area_.Clearance(to);
  if (clearance < kPersonRadius + kElbows &&
      clearance < area_.Clearance(X_WP.position())) {
    return false;
  }
  const double before = (X_WR.position() - X_WP.position()).norm();
  const double after = (X_WR.position() - to).norm();
  const double free = kPersonRadius + options_.robot_radius + kPassGap;
  if (after < before && after < free) return false;
  state->aside_W += step_W;
  return true;
}

Pose2 People::Walk(const WorldPerson& person,
                   const Path& path,
                   const PersonState& state,
                   double seconds) const {
  const double length = path.along.back();
  const double period = person.is_closed ? length : 2.0 * length;
  double way = std::fmod(
      person.start + person.speed * (seconds - state.waited_s), period);
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
  const Eigen::Vector2d at = a + t * (b - a) + state.aside_W;
  const Eigen::Vector2d ahead = is_returning ? Eigen::Vector2d(a - b) : b - a;
  return {at.x(), at.y(), HeadingOf(ahead)};
}

Pose2 People::Beside(const WorldPerson& person,
                     const Pose2& X_WR,
                     double bearing_W,
                     double squeezed) const {
  const double distance =
      options_.robot_radius + person.clearance - squeezed + kPersonRadius;
  const Eigen::Vector2d at =
      X_WR.position() +
      distance * Eigen::Vector2d(std::cos(bearing_W), std::sin(bearing_W));
  return {at.x(), at.y(), X_WR.heading};
}

double People::Intrusion(const WorldPerson& person,
                         const Pose2& X_WR,
                         double bearing_W,
                         std::span<const Pose2> others) const {
  const Eigen::Vector2d at = Beside(person, X_WR, bearing_W).position();
  double intrusion = kPersonRadius - area_.Clearance(at);
  for (const Pose2& other : others) {
    intrusion = std::max(intrusion,
                         2.0 * kPersonRadius - (other.position() - at).norm());
  }
  return intrusion;
}

double People::FreeBearing(const WorldPerson& person,
                           const Pose2& X_WR,
                           double bearing_W,
                           std::span<const Pose2> others) const {
  double best = bearing_W;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kNumBearings; ++i) {
    // 0, +1, -1, +2, -2, ...: the nearest free bearing comes first.
    const int step = (i + 1) / 2 * (i % 2 == 1 ? 1 : -1);
    const double bearing =
        bearing_W + 2.0 * std::numbers::pi * step / kNumBearings;
    const double intrusion = Intrusion(person, X_WR, bearing, others);
    if (intrusion <= 0.0) return bearing;
    if (intrusion < least - kSameIntrusion) {
      least = intrusion;
      best = bearing;
    }
  }
  return best;
}

double People::WayOut(const WorldPerson& person,
                      const Pose2& X_WR,
                      double bearing_W,
                      std::span<const Pose2> others) const {
  double best_turn = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const double side : {1.0, -1.0}) {
    // What is in the way until it is free, over the way.
    double sum = 0.0;
    for (int i = 1; i < kNumBearings; ++i) {
      const double turn = side * 2.0 * std::numbers::pi * i / kNumBearings;
      const double intrusion =
          Intrusion(person, X_WR, bearing_W + turn, others);
      sum += std::max(0.0, intrusion);
      if (sum >= least) break;
      if (intrusion > 0.0) continue;
      least = sum;
      best_turn = turn;
      break;
    }
  }
  // Else to where the least is.
  return best_turn != 0.0
             ? best_turn
             : FreeBearing(person, X_WR, bearing_W, others) - bearing_W;
}

double People::GoAround(const WorldPerson& person,
                        const Pose2& X_WR,
                        double bearing_W,
                        double dt,
                        std::span<const Pose2> others) const {
  const double most =
      kBesideSpeed * dt /
      (options_.robot_radius + person.clearance + kPersonRadius);
  const auto toward = [&](double change) {
    return bearing_W + std::clamp(change, -most, most);
  };
  if (Intrusion(person, X_WR, bearing_W, others) > 0.0) {
    return toward(WayOut(person, X_WR, bearing_W, others));
  }
  const double next =
      toward(WrapAngle(X_WR.heading + person.bearing - bearing_W));
  return Intrusion(person, X_WR, next, others) <= 0.0 ? next : bearing_W;
}

}  // namespace waymark
