#include "drivers/wheels/create_session.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

// The robot needs 20 ms to change its mode, and ignores what comes meanwhile.
constexpr Duration kModeChange{30'000};

int Millimeters(double meters) {
  return std::clamp(static_cast<int>(std::lround(meters * 1000.0)),
                    -kCreateMaxSpeed,
                    kCreateMaxSpeed);
}

}  // namespace

void CreateSessionOptions::Check() const {
  base.Check();
  if (base.max_wheel_speed > kCreateMaxSpeed / 1000.0) {
    throw std::invalid_argument("max_wheel_speed must be at most 0.5 m/s");
  }
  if (mode != CreateMode::kSafe && mode != CreateMode::kFull) {
    throw std::invalid_argument("mode must be safe or full");
  }
  if (!(return_delay_s >= 0.0) || !std::isfinite(return_delay_s)) {
    throw std::invalid_argument("return_delay_s must not be negative");
  }
  // Ten frames: fewer are lost to noise alone.
  if (!(silence_s >= 10.0 * kCreateStreamPeriodS) ||
      !std::isfinite(silence_s)) {
    throw std::invalid_argument("silence_s must be at least 0.15 s");
  }
}

CreateSession::CreateSession(const CreateSessionOptions& options)
    : options_(options), base_(options.base) {
  options_.Check();
}

void CreateSession::Start(Time now) {
  phase_ = Phase::kStart;
  next_step_ = now;
}

void CreateSession::Open(Time now) {
  Start(now);
  is_silent_ = true;
  parser_.Clear();
  newest_.reset();
}

bool CreateSession::IsDriving() const {
  return newest_ &&
         (newest_->mode == static_cast<std::uint8_t>(CreateMode::kSafe) ||
          newest_->mode == static_cast<std::uint8_t>(CreateMode::kFull));
}

void CreateSession::OnFrame(const CreateSensors& sensors) {
  newest_ = sensors;
  base_.Sense({sensors.is_bumper_left,
               sensors.is_bumper_right,
               sensors.is_wheel_dropped || !IsDriving()});
  CreateReading reading{sensors, std::nullopt};
  if (sensors.capacity > 0) {
    reading.battery =
        std::min(1.0, static_cast<double>(sensors.charge) / sensors.capacity);
  }
  if (reading_) {
    reading.sensors.is_bumper_left |= reading_->sensors.is_bumper_left;
    reading.sensors.is_bumper_right |= reading_->sensors.is_bumper_right;
  }
  reading_ = reading;
}

void CreateSession::Receive(Time now, std::span<const std::uint8_t> bytes) {
  for (const CreateSensors& sensors : parser_.Add(bytes)) {
    // Of a stream that another process had started.
    if (phase_ != Phase::kRun) continue;
    const bool was_driving = IsDriving();
    OnFrame(sensors);
    if (was_driving && !IsDriving()) settled_ = now;
    heard_ = now;
    is_silent_ = false;
  }
}

void CreateSession::Command(Time now, double forward, double turn_rate) {
  base_.Command(now, forward, turn_rate);
}

Bytes CreateSession::Greet(Time now) {
  if (now < next_step_) return {};
  next_step_ = now + kModeChange;
  switch (phase_) {
    case Phase::kStart:
      phase_ = Phase::kMode;
      return EncodeStop();  // Ends with the start command.
    case Phase::kMode:
      phase_ = Phase::kStream;
      settled_ = now;
      return EncodeMode(options_.mode);
    default:
      phase_ = Phase::kRun;
      heard_ = now;
      return EncodeStream();
  }
}

Bytes CreateSession::Drive(Time now) {
  const WheelSpeeds speeds = base_.Speeds(now);
  if (!newest_) return {};
  if (!IsDriving()) {
    if (!options_.returns_to_mode || newest_->is_wheel_dropped ||
        now - settled_ < DurationFromSeconds(options_.return_delay_s)) {
      return {};
    }
    Start(now);
    return Greet(now);
  }
  return EncodeDriveDirect(Millimeters(speeds.right), Millimeters(speeds.left));
}

Bytes CreateSession::Send(Time now) {
  if (phase_ != Phase::kRun) return Greet(now);
  if (now - heard_ > DurationFromSeconds(options_.silence_s)) {
    Open(now);
    return Greet(now);
  }
  return Drive(now);
}

std::optional<CreateReading> CreateSession::TakeReading() {
  return std::exchange(reading_, std::nullopt);
}

std::string CreateSession::Fault() const {
  if (is_silent_) return "the robot does not answer: is it on?";
  if (IsDriving()) {
    return base_.hold() == BaseHold::kStopped
               ? "stopped until a command asks for no motion"
               : "";
  }
  const std::string next =
      options_.returns_to_mode ? "" : "; set to stay so until restarted";
  if (newest_->is_wheel_dropped) {
    return "the robot has stopped: a wheel hangs down" + next;
  }
  if (newest_->is_cliff) return "the robot has stopped: a cliff" + next;
  if (newest_->is_charging) return "the robot has stopped: it charges" + next;
  return "the robot has stopped: it is in mode " +
         std::to_string(newest_->mode) + next;
}

}  // namespace waymark
