// What a base with two driven wheels makes of commands and of its own safety
// sensors: speeds of both wheels.
#pragma once

#include "estimation/base/time.h"

#include <cstdint>

namespace waymark {

struct DifferentialBaseOptions {
  double wheel_base = 0.235;       // Between the wheels, m.
  double max_wheel_speed = 0.5;    // m/s.
  double command_timeout_s = 0.5;  // So long after a command the base stands.
  // By which it brakes so as to stand then, m/s^2.
  double max_wheel_acceleration = 2.0;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct WheelSpeeds {
  double right = 0.0;  // m/s.
  double left = 0.0;
  bool operator==(const WheelSpeeds&) const = default;
};

// Of a base that moves forward at `forward` m/s and turns left at `turn_rate`
// rad/s. Where a wheel would be too fast both are slowed by the same factor:
// the path keeps its curvature.
[[nodiscard]] WheelSpeeds WheelSpeedsOf(double forward,
                                        double turn_rate,
                                        const DifferentialBaseOptions& options);

// Why the base does not do what it was told.
enum class BaseHold {
  kNone,
  kBumper,   // No forward motion until it is released and not asked for.
  kStopped,  // No motion until the cause is gone and none is asked for.
};

struct BaseSensors {
  bool is_bumper_left = false;
  bool is_bumper_right = false;
  // A wheel hangs down, or the base has stopped by itself.
  bool must_stop = false;
  bool operator==(const BaseSensors&) const = default;
};

// Commands wear out, and the base brakes ahead of that: it is never faster than
// it can brake in what is left of the time-out. That limits a fresh command
// too, to max_wheel_acceleration * command_timeout_s, both wheels by the same
// factor: a time-out of 0.1 s with 2 m/s^2 leaves 0.2 m/s. What the base runs
// into holds it until whoever drives has noticed: asks for no forward motion
// (bumper), for none at all (stop), or for nothing any more.
class DifferentialBase {
 public:
  // Throws as Check() does.
  explicit DifferentialBase(const DifferentialBaseOptions& options);

  // Speeds in m/s and rad/s, finite (std::logic_error otherwise). Times never
  // go back.
  void Command(Time now, double forward, double turn_rate);
  void Sense(const BaseSensors& sensors);

  [[nodiscard]] WheelSpeeds Speeds(Time now);

  // As of the last call with a time. False before the first command.
  [[nodiscard]] bool is_command_current() const { return is_current_; }
  [[nodiscard]] BaseHold hold() const;
  // Times that a bumper was pressed, both at once being one.
  [[nodiscard]] std::int64_t num_contacts() const { return num_contacts_; }
  // Commands to move that were not renewed in time.
  [[nodiscard]] std::int64_t num_timeouts() const { return num_timeouts_; }

 private:
  void WearOut(Time now);
  // Lifts what the present command allows to lift.
  void Release();

  DifferentialBaseOptions options_;
  Time commanded_;
  double forward_ = 0.0;  // 0 where no command is current.
  double turn_rate_ = 0.0;
  bool is_current_ = false;
  BaseSensors sensors_;
  bool holds_forward_ = false;
  bool holds_all_ = false;
  std::int64_t num_contacts_ = 0;
  std::int64_t num_timeouts_ = 0;
};

}  // namespace waymark
