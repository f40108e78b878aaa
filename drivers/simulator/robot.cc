#include "drivers/simulator/robot.h"

#include "drivers/simulator/option_range.h"
#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>

namespace waymark {

void RobotOptions::Check() const {
  RequireAbove0("radius", radius);
  // Above what it rolls over.
  RequireWithin("height", height, 2.0 * HeightBand{}.low, 10.0);
  RequireAbove0("meters_per_tick", meters_per_tick);
  RequireAbove0("wheel_base", wheel_base);
  RequireAbove0("right_wheel_factor", right_wheel_factor);
  RequireAbove0("left_wheel_factor", left_wheel_factor);
  RequireAbove0("wheel_base_factor", wheel_base_factor);
  RequireAbove0("max_wheel_speed", max_wheel_speed);
  RequireAbove0("max_wheel_acceleration", max_wheel_acceleration);
  // Else it could not stand in time after the last command.
  RequireAbove0("command_timeout_s", command_timeout_s);
  RequireWithin("max_wheel_speed",
                max_wheel_speed,
                0.0,
                max_wheel_acceleration * command_timeout_s);
  RequireNotNegative("wheel_variance", wheel_variance);
  RequireNotNegative("base_variance", base_variance);
  RequireNotNegative("slip_every", slip_every);
  RequireAbove0("slip_length", slip_length);
  RequireWithin("slip_share", slip_share, 0.0, 1.0);
}

namespace {

DifferentialBaseOptions BaseOptions(const RobotOptions& options) {
  options.Check();
  return {.wheel_base = options.wheel_base,
          .max_wheel_speed = options.max_wheel_speed,
          .command_timeout_s = options.command_timeout_s,
          .max_wheel_acceleration = options.max_wheel_acceleration};
}

}  // namespace

SimulatedRobot::SimulatedRobot(const RobotOptions& options,
                               const RobotSnapshot& start,
                               std::uint64_t seed)
    : options_(options),
      wheel_noise_(SeedFor(seed, "robot.wheels")),
      slip_noise_(SeedFor(seed, "robot.slip")),
      X_WR_(start.X_WR),
      ticks_{start.right_ticks, start.left_ticks},
      base_(BaseOptions(options)),
      X_WR0_(X_WR_),
      ticks0_(ticks_) {
  WAYMARK_CHECK(X_WR_.vector().allFinite() && std::isfinite(ticks_.right) &&
                    std::isfinite(ticks_.left),
                X_WR_.vector().transpose(),
                ticks_.right,
                ticks_.left);
  to_next_slip_ = -options_.slip_every * std::log(1.0 - slip_noise_.Uniform());
}

void SimulatedRobot::Command(double forward, double turn_rate) {
  WAYMARK_CHECK(
      std::isfinite(forward) && std::isfinite(turn_rate), forward, turn_rate);
  base_.Command(Now(), forward, turn_rate);
}

SimulatedRobot::Wheels SimulatedRobot::TurnWheels(double dt) {
  seconds_ += dt;
  const double a = options_.max_wheel_acceleration;
  const WheelSpeeds asked = base_.Speeds(Now());
  const double change_right = asked.right - speed_.right;
  const double change_left = asked.left - speed_.left;
  // Both wheels arrive at the same time.
  const double ramp_s =
      std::max(std::abs(change_right), std::abs(change_left)) / a;
  const double share = ramp_s > dt ? dt / ramp_s : 1.0;
  // The mean speed of a ramp that lasts the first `ramp_share` of the step.
  const double ramp_share = std::min(1.0, ramp_s / dt);
  const auto way = [&](double speed, double change) {
    return dt * (speed + share * change * (1.0 - 0.5 * ramp_share));
  };
  const Wheels turned{way(speed_.right, change_right),
                      way(speed_.left, change_left)};
  speed_.right += share * change_right;
  speed_.left += share * change_left;
  return turned;
}

void SimulatedRobot::Slip(Wheels* way) {
  if (options_.slip_every == 0.0) return;
  const double step = 0.5 * (std::abs(way->right) + std::abs(way->left));
  const Wheels whole = *way;
  for (double rest = step; rest > 0.0;) {
    if (slip_rest_ > 0.0) {
      const double part = std::min(rest, slip_rest_);
      const double lost = options_.slip_share * part / step;
      double& wheel = is_right_slipping_ ? way->right : way->left;
      wheel -= lost * (is_right_slipping_ ? whole.right : whole.left);
      slip_rest_ -= part;
      rest -= part;
    } else {
      const double part = std::min(rest, to_next_slip_);
      to_next_slip_ -= part;
      rest -= part;
      if (to_next_slip_ > 0.0) continue;
      slip_rest_ = options_.slip_length;
      is_right_slipping_ = slip_noise_.Uniform() < 0.5;
      // Ways between slips of a Poisson process.
      to_next_slip_ =
          -options_.slip_every * std::log(1.0 - slip_noise_.Uniform());
    }
  }
}

ArcMotion SimulatedRobot::MotionOf(const Wheels& way) {
  Wheels ground{way.right * options_.right_wheel_factor,
                way.left * options_.left_wheel_factor};
  Slip(&ground);
  const double base = options_.wheel_base * options_.wheel_base_factor;
  const double travel = 0.5 * (std::abs(ground.right) + std::abs(ground.left));
  if (travel == 0.0) return {};
  double turn = (ground.right - ground.left) / base;
  const double b =
      wheel_noise_.Normal(std::sqrt(options_.base_variance / travel));
  turn -= turn * b / base;
  const double e_right = wheel_noise_.Normal(
      std::sqrt(options_.wheel_variance * std::abs(ground.right)));
  const double e_left = wheel_noise_.Normal(
      std::sqrt(options_.wheel_variance * std::abs(ground.left)));
  return {0.5 * (ground.right + e_right + ground.left + e_left),
          turn + (e_right - e_left) / base};
}

void SimulatedRobot::Step(double dt,
                          const ObstacleMap& map,
                          std::span<const Disc2> people) {
  WAYMARK_CHECK(dt > 0.0 && std::isfinite(dt), dt);
  const Wheels way = TurnWheels(dt);
  motion_ = MotionOf(way);
  turned_ = {way.right / options_.meters_per_tick,
             way.left / options_.meters_per_tick};
  X_WR0_ = X_WR_;
  ticks0_ = ticks_;
  free_share_ = tick_share_ = 1.0;
  turns_on_ = false;
  const std::optional<ArcContact> contact =
      map.FirstContact(X_WR_, motion_, options_.radius + kSkin, people);
  if (contact) StopAt(*contact, way);
  way_ += std::abs(motion_.distance) * free_share_;
  X_WR_ = PoseAt(1.0);
  ticks_ = {ticks0_.right + tick_share_ * turned_.right,
            ticks0_.left + tick_share_ * turned_.left};
  CountTouch(contact, map, people);
  if (options_.holds_at_bumper) {
    base_.Sense({.is_bumper_left = is_left_bumper_pressed(),
                 .is_bumper_right = is_right_bumper_pressed()});
  }
}

void SimulatedRobot::StopAt(const ArcContact& contact, const Wheels& way) {
  free_share_ = contact.share;
  // A round body that turns on the spot goes on turning: what noise would add
  // to its way is held by the wall. The wheels need not agree better than
  // those of a real robot do.
  constexpr double kOnTheSpot = 0.1;
  turns_on_ = std::abs(way.right + way.left) <=
              kOnTheSpot * (std::abs(way.right) + std::abs(way.left));
  if (turns_on_ || options_.blocked_wheels == BlockedWheels::kSpin) return;
  tick_share_ = free_share_;
  speed_ = {};
}

void SimulatedRobot::CountTouch(const std::optional<ArcContact>& contact,
                                const ObstacleMap& map,
                                std::span<const Disc2> people) {
  bool touches = contact.has_value();
  if (contact) p_WT_ = contact->p_W;
  // People may walk into it.
  for (const Disc2& person : people) {
    const Eigen::Vector2d to = person.p_W - X_WR_.position();
    if (to.norm() >= person.radius + options_.radius) continue;
    touches = true;
    p_WT_ = person.p_W;
  }
  if (touches) {
    if (!is_touching_) ++num_touches_;
    is_touching_ = true;
  } else if (is_touching_) {
    is_touching_ =
        map.Nearest(X_WR_.position(), options_.radius + kReleaseGap, people)
            .has_value();
  }
}

Pose2 SimulatedRobot::PoseAt(double share) const {
  const double moved = std::min(share, free_share_);
  Pose2 X_WR = X_WR0_ * PoseAlong(motion_, moved);
  if (turns_on_) {
    X_WR.heading = WrapAngle(X_WR.heading + (share - moved) * motion_.turn);
  }
  return X_WR;
}

std::int64_t SimulatedRobot::RightTicksAt(double share) const {
  return static_cast<std::int64_t>(
      std::floor(ticks0_.right + std::min(share, tick_share_) * turned_.right));
}

std::int64_t SimulatedRobot::LeftTicksAt(double share) const {
  return static_cast<std::int64_t>(
      std::floor(ticks0_.left + std::min(share, tick_share_) * turned_.left));
}

RobotSnapshot SimulatedRobot::Snapshot() const {
  return {X_WR_, ticks_.right, ticks_.left};
}

double SimulatedRobot::forward_speed() const {
  return 0.5 * (speed_.right + speed_.left);
}

double SimulatedRobot::turn_rate() const {
  return (speed_.right - speed_.left) / options_.wheel_base;
}

double SimulatedRobot::TouchBearing() const {
  const Eigen::Vector2d p_RT = Inverse(X_WR_) * p_WT_;
  return std::atan2(p_RT.y(), p_RT.x());
}

bool SimulatedRobot::is_left_bumper_pressed() const {
  if (!is_touching_) return false;
  const double bearing = TouchBearing();
  return bearing > -kBumperOverlap && bearing < kBumperReach;
}

bool SimulatedRobot::is_right_bumper_pressed() const {
  if (!is_touching_) return false;
  const double bearing = TouchBearing();
  return bearing < kBumperOverlap && bearing > -kBumperReach;
}

}  // namespace waymark
