#include "planner/control/velocity_guard.h"

#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace waymark {
namespace {

// Steps of the ways looked at: 1 cm at 0.5 m/s, well below any margin.
constexpr double kStepS = 0.02;
// A velocity is slowed in steps of this share, then refined within one.
constexpr int kSlowSteps = 16;
constexpr int kRefinements = 4;
// Rounding of a distance that stays the same while the robot turns.
constexpr double kRounding = 1e-9;
// Points of a wide echo lie no further apart, m: less than anything that
// fits between them could matter.
constexpr double kArcSpacing = 0.03;
// So many at most: a beam of 90 deg at 19 m, which is beyond the reach of all
// but very fast robots, and those keep more than this between them.
constexpr int kMaxArcParts = 1000;
// More than the sum of all delays: older commands have had their effect, once
// the time to reach them is added.
constexpr double kForgetS = 3.0;
// Messages that overtake each other; more is another run.
constexpr Duration kRestart{1'000'000};
// A gap between directions that are seen, around the one driven to.
constexpr double kSeenWithin = 0.3;  // rad.

void Require(bool holds, const char* field, double value, const char* range) {
  if (holds) return;
  throw std::invalid_argument(std::string(field) + " = " +
                              std::to_string(value) + " is not " + range);
}

std::string Text(const char* format, double a, double b = 0.0) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

}  // namespace

void VelocityGuardOptions::Check() const {
  const auto positive = [](const char* field, double value) {
    Require(std::isfinite(value) && value > 0.0, field, value, "above 0");
  };
  const auto not_negative = [](const char* field, double value) {
    Require(std::isfinite(value) && value >= 0.0, field, value, "0 or above");
  };
  positive("radius", radius);
  not_negative("margin", margin);
  not_negative("margin_time", margin_time);
  positive("max_speed", max_speed);
  positive("max_turn_rate", max_turn_rate);
  rates.Check();
  not_negative("max_latency_s", max_latency_s);
  not_negative("hold_s", hold_s);
  Require(X_RS.vector().allFinite(), "X_RS", X_RS.x, "finite");
  not_negative("min_range", min_range);
  Require(beam_width >= 0.0 && beam_width < kPi,
          "beam_width",
          beam_width,
          "from 0 to below pi");
  positive("max_range_age", max_range_age);
  not_negative("unseen_speed", unseen_speed);
  not_negative("contact_hold_s", contact_hold_s);
}

VelocityGuard::VelocityGuard(const VelocityGuardOptions& options)
    : options_(options) {
  options_.Check();
}

void VelocityGuard::SetRanges(const RangeScan& scan) {
  range_time_ = scan.time;
  echoes_.clear();
  seen_.clear();
  // From the sensor, over all the way that the robot goes while these ranges
  // count. What is farther, or what a driver sends for no echo, is no obstacle
  // yet, whatever number that is.
  const double farthest =
      options_.X_RS.position().norm() + Reach() +
      options_.max_speed *
          (options_.max_range_age + options_.max_latency_s + kStepS);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = scan.ranges[i];
    if (!std::isfinite(range) || range <= options_.min_range) continue;
    const double angle = scan.first_angle + static_cast<double>(i) * scan.step;
    seen_.push_back(WrapAngle(options_.X_RS.heading + angle));
    if (range > farthest) continue;
    // What is between two beams is seen by neither, or by both at its range.
    const double half =
        0.5 *
        std::max(options_.beam_width, std::min(std::abs(scan.step), 0.5 * kPi));
    const int parts = static_cast<int>(
        std::min(2.0 * half * range / kArcSpacing, double{kMaxArcParts}));
    for (int k = 0; k <= parts; ++k) {
      const double beside =
          parts == 0 ? 0.0
                     : half * (2.0 * k / static_cast<double>(parts) - 1.0);
      echoes_.push_back(options_.X_RS *
                        Eigen::Vector2d(range * std::cos(angle + beside),
                                        range * std::sin(angle + beside)));
    }
  }
}

void VelocityGuard::SetContact(Time time) {
  contact_time_ = time;
}

void VelocityGuard::Rewind(Time now) {
  if (!commands_.empty() && now < commands_.back().time - kRestart) {
    commands_.clear();
    contact_time_.reset();
    if (range_time_ && *range_time_ > now + kRestart) range_time_.reset();
  }
  while (!commands_.empty() && commands_.back().time >= now) {
    commands_.pop_back();
  }
  const Time forget = now - DurationFromSeconds(kForgetS);
  while (commands_.size() > 1 && commands_[1].time <= forget) {
    commands_.erase(commands_.begin());
  }
  // It has held for long, however long that is.
  if (!commands_.empty() && commands_.front().time < forget) {
    commands_.front().time = forget;
  }
}

void VelocityGuard::Record(Time now, const Velocity& command) {
  // Before the first one it stood.
  if (commands_.empty()) {
    commands_.push_back({now - DurationFromSeconds(kForgetS), {}});
  }
  commands_.push_back({now, command});
}

void VelocityGuard::Stop(Time now) {
  Rewind(now);
  Record(now, {});
}

AllowedVelocity VelocityGuard::Allow(Time now, const Velocity& asked) {
  WAYMARK_CHECK(std::isfinite(asked.forward) && std::isfinite(asked.turn_rate),
                asked.forward,
                asked.turn_rate);
  Rewind(now);
  AllowedVelocity allowed =
      Check(now, Limit(asked, options_.max_speed, options_.max_turn_rate));
  Record(now, allowed.velocity);
  if (allowed.reason.empty() && allowed.velocity != asked) {
    return {allowed.velocity, "speed limit"};
  }
  return allowed;
}

AllowedVelocity VelocityGuard::Check(Time now, const Velocity& limited) {
  AllowedVelocity allowed{limited, ""};
  if (limited.is_zero()) return allowed;
  if (contact_time_ && limited.forward > 0.0 &&
      now - *contact_time_ < DurationFromSeconds(options_.contact_hold_s)) {
    allowed = {{0.0, limited.turn_rate}, "bumper: only backwards"};
  }
  if (options_.ranges == RangeUse::kNone) return allowed;
  if (!range_time_) return {{}, "no ranges yet"};
  const double age = Seconds(now - *range_time_);
  if (age > options_.max_range_age) {
    return {{}, Text("ranges are %.1f s old", age)};
  }
  const double direction = allowed.velocity.forward < 0.0 ? kPi : 0.0;
  if (std::abs(allowed.velocity.forward) > options_.unseen_speed &&
      !IsSeen(direction)) {
    allowed = {Limit(allowed.velocity,
                     std::max(options_.unseen_speed, 1e-6),
                     options_.max_turn_rate),
               "no ranges in that direction"};
  }
  std::vector<Start> starts = StartsAt(now);
  Measure(&starts);
  const auto obstacle = Obstacle(starts, allowed.velocity);
  if (!obstacle) return allowed;
  const Eigen::Vector2d p_RQ =
      Inverse(starts.back().state.pose) * points_[*obstacle];
  return {Slowed(starts, allowed.velocity),
          Text("obstacle at %.2f m, %.0f deg",
               std::max(0.0, p_RQ.norm() - options_.radius),
               DegreesFromRadians(std::atan2(p_RQ.y(), p_RQ.x())))};
}

bool VelocityGuard::IsSeen(double direction) const {
  return std::any_of(seen_.begin(), seen_.end(), [&](double angle) {
    return std::abs(WrapAngle(angle - direction)) <= kSeenWithin;
  });
}

// The frame of all that follows is R at the time of the ranges.
std::vector<VelocityGuard::Start> VelocityGuard::StartsAt(Time now) const {
  const DriveRates& r = options_.rates;
  const DriveRates sluggish{std::min(r.acceleration, r.braking),
                            std::min(r.acceleration, r.braking),
                            std::min(r.turn_acceleration, r.turn_braking),
                            std::min(r.turn_acceleration, r.turn_braking)};
  const DriveRates brisk{std::max(r.acceleration, r.braking),
                         std::max(r.acceleration, r.braking),
                         std::max(r.turn_acceleration, r.turn_braking),
                         std::max(r.turn_acceleration, r.turn_braking)};
  std::vector<Start> starts;
  for (const double latency_s : {0.0, options_.max_latency_s}) {
    for (const DriveRates& rates : {sluggish, brisk}) {
      starts.push_back(
          {StateAt(now, DurationFromSeconds(latency_s), rates), latency_s, {}});
    }
  }
  return starts;
}

DriveState VelocityGuard::StateAt(Time now,
                                  Duration latency,
                                  const DriveRates& rates) const {
  DriveState state;
  if (commands_.empty()) return state;
  Time t = commands_.front().time + latency;
  state.velocity = commands_.front().velocity;
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const bool is_last = i + 1 == commands_.size();
    const Time until = (is_last ? now : commands_[i + 1].time) + latency;
    while (t < until) {
      Time next = std::min(until, t + DurationFromSeconds(kStepS));
      // What happened before the ranges gives the velocity only.
      if (t < *range_time_) next = std::min(next, *range_time_);
      const Pose2 before = t < *range_time_ ? Pose2{} : state.pose;
      state = Advance(state, commands_[i].velocity, rates, Seconds(next - t));
      if (t < *range_time_) state.pose = before;
      t = next;
    }
  }
  return state;
}

double VelocityGuard::Reach() const {
  // Farther than the robot can get before it stands.
  const double v = options_.max_speed;
  const double way = v * (options_.max_latency_s + options_.hold_s + kStepS) +
                     0.5 * v * v / options_.rates.braking;
  // Braking on a curve may last as long as the turn.
  const double turning =
      v * options_.max_turn_rate / options_.rates.turn_braking;
  return options_.radius + options_.margin + options_.margin_time * v + way +
         turning;
}

void VelocityGuard::Measure(std::vector<Start>* starts) {
  const double reach = Reach();
  points_.clear();
  for (const Eigen::Vector2d& echo : echoes_) {
    for (const Start& start : *starts) {
      if ((echo - start.state.pose.position()).squaredNorm() < reach * reach) {
        points_.push_back(echo);
        break;
      }
    }
  }
  for (Start& start : *starts) {
    for (const Eigen::Vector2d& point : points_) {
      start.distances.push_back((point - start.state.pose.position()).norm());
    }
  }
}

// Where the robot comes by until it stands.
std::vector<Eigen::Vector2d> VelocityGuard::WayOf(
    const Start& start, const Velocity& candidate) const {
  std::vector<Eigen::Vector2d> way;
  DriveState state = start.state;
  // The brake that may have to follow takes the longest to get there.
  double hold = options_.hold_s + options_.max_latency_s - start.latency_s;
  while (hold > 0.0 || !state.velocity.is_zero()) {
    const double dt = hold > 0.0 ? std::min(kStepS, hold) : kStepS;
    state =
        Advance(state, hold > 0.0 ? candidate : Velocity{}, options_.rates, dt);
    hold -= dt;
    way.push_back(state.pose.position());
  }
  return way;
}

std::optional<std::size_t> VelocityGuard::Obstacle(
    const std::vector<Start>& starts, const Velocity& candidate) const {
  const double clearance = options_.radius + options_.margin +
                           options_.margin_time * std::abs(candidate.forward);
  for (const Start& start : starts) {
    const std::vector<Eigen::Vector2d> way = WayOf(start, candidate);
    double reach = 0.0;
    for (const Eigen::Vector2d& p : way) {
      reach = std::max(reach, (p - start.state.pose.position()).norm());
    }
    std::optional<std::size_t> nearest;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double distance = start.distances[i];
      if (distance > clearance + reach) continue;
      if (nearest && start.distances[*nearest] <= distance) continue;
      const double least = std::min(clearance, distance) - kRounding;
      const bool is_met =
          std::any_of(way.begin(), way.end(), [&](const Eigen::Vector2d& p) {
            return (points_[i] - p).squaredNorm() < least * least;
          });
      if (is_met) nearest = i;
    }
    if (nearest) return nearest;
  }
  return std::nullopt;
}

Velocity VelocityGuard::Slowed(const std::vector<Start>& starts,
                               const Velocity& asked) const {
  const auto at = [&](double share) {
    return Velocity{share * asked.forward, share * asked.turn_rate};
  };
  const auto is_free = [&](const Velocity& candidate) {
    return !Obstacle(starts, candidate);
  };
  for (int step = kSlowSteps - 1; step > 0; --step) {
    double free = static_cast<double>(step) / kSlowSteps;
    if (!is_free(at(free))) continue;
    double blocked = static_cast<double>(step + 1) / kSlowSteps;
    for (int i = 0; i < kRefinements; ++i) {
      const double middle = 0.5 * (free + blocked);
      (is_free(at(middle)) ? free : blocked) = middle;
    }
    return at(free);
  }
  const Velocity turning{0.0, asked.turn_rate};
  return is_free(turning) ? turning : Velocity{};
}

}  // namespace waymark
