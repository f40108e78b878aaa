#include "drivers/wheels/differential_base.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace waymark {

void DifferentialBaseOptions::Check() const {
  if (!(wheel_base > 0.0) || !std::isfinite(wheel_base)) {
    throw std::invalid_argument("wheel_base must be positive");
  }
  if (!(max_wheel_speed > 0.0) || !std::isfinite(max_wheel_speed)) {
    throw std::invalid_argument("max_wheel_speed must be positive");
  }
  if (!(command_timeout_s > 0.0) || !std::isfinite(command_timeout_s)) {
    throw std::invalid_argument("command_timeout_s must be positive");
  }
  if (!(max_wheel_acceleration > 0.0) ||
      !std::isfinite(max_wheel_acceleration)) {
    throw std::invalid_argument("max_wheel_acceleration must be positive");
  }
}

WheelSpeeds WheelSpeedsOf(double forward,
                          double turn_rate,
                          const DifferentialBaseOptions& options) {
  const double half_turn = turn_rate * options.wheel_base / 2.0;
  WheelSpeeds speeds{forward + half_turn, forward - half_turn};
  const double fastest =
      std::max(std::abs(speeds.right), std::abs(speeds.left));
  if (fastest > options.max_wheel_speed) {
    const double share = options.max_wheel_speed / fastest;
    speeds.right *= share;
    speeds.left *= share;
  }
  return speeds;
}

DifferentialBase::DifferentialBase(const DifferentialBaseOptions& options)
    : options_(options) {
  options_.Check();
}

void DifferentialBase::WearOut(Time now) {
  if (!is_current_ ||
      now - commanded_ < DurationFromSeconds(options_.command_timeout_s)) {
    return;
  }
  if (forward_ != 0.0 || turn_rate_ != 0.0) ++num_timeouts_;
  is_current_ = false;
  forward_ = 0.0;
  turn_rate_ = 0.0;
  Release();
}

void DifferentialBase::Release() {
  if (forward_ <= 0.0 && !sensors_.is_bumper_left &&
      !sensors_.is_bumper_right) {
    holds_forward_ = false;
  }
  if (forward_ == 0.0 && turn_rate_ == 0.0 && !sensors_.must_stop) {
    holds_all_ = false;
  }
}

void DifferentialBase::Command(Time now, double forward, double turn_rate) {
  WAYMARK_CHECK(
      std::isfinite(forward) && std::isfinite(turn_rate), forward, turn_rate);
  WearOut(now);
  commanded_ = now;
  forward_ = forward;
  turn_rate_ = turn_rate;
  is_current_ = true;
  Release();
}

void DifferentialBase::Sense(const BaseSensors& sensors) {
  const bool was_pressed = sensors_.is_bumper_left || sensors_.is_bumper_right;
  const bool is_pressed = sensors.is_bumper_left || sensors.is_bumper_right;
  if (is_pressed && !was_pressed) ++num_contacts_;
  sensors_ = sensors;
  if (is_pressed) holds_forward_ = true;
  if (sensors.must_stop) holds_all_ = true;
  Release();
}

WheelSpeeds DifferentialBase::Speeds(Time now) {
  WearOut(now);
  if (holds_all_) return {};
  const double forward = holds_forward_ ? std::min(forward_, 0.0) : forward_;
  WheelSpeeds speeds = WheelSpeedsOf(forward, turn_rate_, options_);
  // The speed from which the rest of the time is enough to brake.
  const double rest_s = options_.command_timeout_s - Seconds(now - commanded_);
  const double cap = options_.max_wheel_acceleration * std::max(0.0, rest_s);
  const double fastest =
      std::max(std::abs(speeds.right), std::abs(speeds.left));
  if (fastest > cap) {
    speeds.right *= cap / fastest;
    speeds.left *= cap / fastest;
  }
  return speeds;
}

BaseHold DifferentialBase::hold() const {
  if (holds_all_) return BaseHold::kStopped;
  return holds_forward_ ? BaseHold::kBumper : BaseHold::kNone;
}

}  // namespace waymark
