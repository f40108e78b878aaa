// An iRobot Create 2 at a serial port that comes and goes.
#pragma once

#include "drivers/wheels/create_session.h"
#include "drivers/wheels/serial_port.h"
#include "drivers/wheels/watchdog.h"
#include "estimation/base/time.h"

#include <memory>
#include <optional>
#include <string>

namespace waymark {

struct CreateBaseOptions {
  std::string device = "/dev/ttyUSB0";
  int baud = 115200;
  double reopen_s = 1.0;    // Between attempts to open the port.
  double watchdog_s = 0.5;  // Without a Poll() for this long the robot stops.
  CreateSessionOptions session;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// The wheels stand from the moment that the port is opened until a command
// comes, and again when this object goes, or its process hangs or ends in any
// way; not where the cable is pulled or the machine stops: the robot has no
// watchdog of its own.
class CreateBase {
 public:
  // Throws as Check() does.
  explicit CreateBase(const CreateBaseOptions& options);

  // As DifferentialBase::Command; sent at once.
  void Command(Time now, double forward, double turn_rate);
  // Opens the port where it is due, reads what has come, sends what is to be
  // sent; every 10 to 100 ms. Returns what the robot says, nullopt: nothing
  // new.
  [[nodiscard]] std::optional<CreateReading> Poll(Time now);
  // Stops the wheels and closes the port, until the next Poll.
  void Stop();

  // Why the robot does not obey, "" where it does.
  [[nodiscard]] std::string Fault() const;
  [[nodiscard]] const CreateSession& session() const { return session_; }

 private:
  void Open(Time now);
  void Exchange(Time now);

  CreateBaseOptions options_;
  SerialPort port_;
  std::unique_ptr<Watchdog> watchdog_;  // While the port is open.
  CreateSession session_;
  std::optional<Time> tried_;
};

}  // namespace waymark
