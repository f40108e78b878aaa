#include "planner/control/drive_model.h"

#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace waymark {
namespace {

// Seconds until `from` has become `to`: down to 0 by braking, up from there.
double TimeToReach(double from,
                   double to,
                   double acceleration,
                   double braking) {
  if (from * to < 0.0) {
    return std::abs(from) / braking + std::abs(to) / acceleration;
  }
  const double change = std::abs(to) - std::abs(from);
  return change > 0.0 ? change / acceleration : -change / braking;
}

}  // namespace

void DriveRates::Check() const {
  const auto check = [](const char* name, double value) {
    if (std::isfinite(value) && value > 0.0) return;
    throw std::invalid_argument(std::string(name) + " = " +
                                std::to_string(value) + " must be positive");
  };
  check("acceleration", acceleration);
  check("braking", braking);
  check("turn_acceleration", turn_acceleration);
  check("turn_braking", turn_braking);
}

Pose2 AlongArc(const Pose2& X_WR, double length, double turn) {
  // The chord of the arc: its length times sin(h)/h, in the mean direction.
  const double half = 0.5 * turn;
  const double chord =
      std::abs(half) < 1e-6 ? length : length * std::sin(half) / half;
  const double direction = X_WR.heading + half;
  return {X_WR.x + chord * std::cos(direction),
          X_WR.y + chord * std::sin(direction),
          WrapAngle(X_WR.heading + turn)};
}

DriveState Advance(const DriveState& state,
                   const Velocity& target,
                   const DriveRates& rates,
                   double dt) {
  const Velocity& from = state.velocity;
  const double needed = std::max(
      TimeToReach(
          from.forward, target.forward, rates.acceleration, rates.braking),
      TimeToReach(from.turn_rate,
                  target.turn_rate,
                  rates.turn_acceleration,
                  rates.turn_braking));
  const double share = needed > dt ? dt / needed : 1.0;
  const Velocity change{share * (target.forward - from.forward),
                        share * (target.turn_rate - from.turn_rate)};
  // The change lasts the first part of the step.
  const double ramp = 1.0 - 0.5 * std::min(1.0, needed / dt);
  return {AlongArc(state.pose,
                   dt * (from.forward + ramp * change.forward),
                   dt * (from.turn_rate + ramp * change.turn_rate)),
          share == 1.0 ? target
                       : Velocity{from.forward + change.forward,
                                  from.turn_rate + change.turn_rate}};
}

Velocity Limit(const Velocity& velocity,
               double max_speed,
               double max_turn_rate) {
  const double share = std::min(
      {1.0,
       max_speed / std::max(std::abs(velocity.forward), max_speed),
       max_turn_rate / std::max(std::abs(velocity.turn_rate), max_turn_rate)});
  return {share * velocity.forward, share * velocity.turn_rate};
}

}  // namespace waymark
