// How a differential drive follows its commands.
#pragma once

#include "estimation/geometry/pose2.h"

namespace waymark {

// Of the robot R: along its x, m/s; about its z, left positive, rad/s.
struct Velocity {
  double forward = 0.0;
  double turn_rate = 0.0;

  [[nodiscard]] bool is_zero() const {
    return forward == 0.0 && turn_rate == 0.0;
  }
  friend bool operator==(const Velocity&, const Velocity&) = default;
};

// How fast a velocity changes: m/s^2 and rad/s^2.
struct DriveRates {
  double acceleration = 2.0;
  double braking = 0.5;
  double turn_acceleration = 15.0;
  double turn_braking = 4.0;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct DriveState {
  Pose2 pose;
  Velocity velocity;
};

// The state `dt` seconds later, where `target` has been commanded. Both parts
// of the velocity arrive at the same time, so that braking keeps the curve.
[[nodiscard]] DriveState Advance(const DriveState& state,
                                 const Velocity& target,
                                 const DriveRates& rates,
                                 double dt);

// `velocity`, or a slower one on the same curve within the limits.
[[nodiscard]] Velocity Limit(const Velocity& velocity,
                             double max_speed,
                             double max_turn_rate);

// The pose after an arc of constant curvature, from X_WR.
[[nodiscard]] Pose2 AlongArc(const Pose2& X_WR, double length, double turn);

}  // namespace waymark
