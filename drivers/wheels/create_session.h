// The conversation with an iRobot Create 2: what to send when, and what its
// answers mean. Bytes and times in, bytes and readings out.
#pragma once

#include "drivers/wheels/create_protocol.h"
#include "drivers/wheels/differential_base.h"
#include "estimation/base/time.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace waymark {

struct CreateSessionOptions {
  DifferentialBaseOptions base;
  // kSafe or kFull; in full mode the robot itself stops for nothing.
  CreateMode mode = CreateMode::kSafe;
  // Return to that mode after the robot has stopped itself. Motion still waits
  // for a command that asks for none.
  bool returns_to_mode = true;
  double return_delay_s = 1.0;  // Since then, or since the last attempt.
  // So long without a frame the robot counts as gone: it is addressed anew, and
  // again each time this has passed.
  double silence_s = 0.5;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct CreateReading {
  CreateSensors
      sensors;  // The newest; bumpers: pressed since the last reading.
  std::optional<double> battery;  // Charge, 0 to 1.
};

class CreateSession {
 public:
  // Throws as Check() does.
  explicit CreateSession(const CreateSessionOptions& options);

  // The port was opened: the robot, which may still be driving as it was told
  // by someone else, is stopped and addressed from the start.
  void Open(Time now);
  void Receive(Time now, std::span<const std::uint8_t> bytes);
  // As DifferentialBase::Command.
  void Command(Time now, double forward, double turn_rate);
  // What to send now; call it every 10 to 100 ms, and after a command.
  [[nodiscard]] Bytes Send(Time now);

  // What has come since the last call; nullopt: nothing.
  [[nodiscard]] std::optional<CreateReading> TakeReading();
  // Why the robot does not obey, "" where it does.
  [[nodiscard]] std::string Fault() const;

  [[nodiscard]] const DifferentialBase& base() const { return base_; }
  [[nodiscard]] const CreateStreamParser& parser() const { return parser_; }

 private:
  enum class Phase { kStart, kMode, kStream, kRun };

  void Start(Time now);  // The greeting.
  void OnFrame(const CreateSensors& sensors);
  [[nodiscard]] bool IsDriving() const;
  [[nodiscard]] Bytes Greet(Time now);
  [[nodiscard]] Bytes Drive(Time now);

  CreateSessionOptions options_;
  DifferentialBase base_;
  CreateStreamParser parser_;
  Phase phase_ = Phase::kStart;
  Time next_step_;  // Of the greeting.
  Time settled_;    // When the mode was asked for, or left by the robot.
  Time heard_;      // Of the last frame; of the greeting before the first.
  bool is_silent_ = true;
  std::optional<CreateSensors> newest_;  // Since the port was opened.
  std::optional<CreateReading> reading_;
};

}  // namespace waymark
