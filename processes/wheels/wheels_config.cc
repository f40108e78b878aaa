#include "processes/wheels/wheels_config.h"

#include <cstdint>

namespace waymark {

void WheelsConfig::Describe(Describer& d) {
  d.Text("device", &create.device, "Serial port of the iRobot Create 2");
  std::int64_t baud = create.baud;
  d.Integer("baud", &baud, 9600, 230400, "Its speed, bit/s; the robot's own");
  create.baud = static_cast<int>(baud);
  CreateSessionOptions& session = create.session;
  d.Choice<CreateMode>(
      "mode",
      &session.mode,
      {{"safe", CreateMode::kSafe}, {"full", CreateMode::kFull}},
      "safe: the robot stops itself at cliffs, when lifted, on its charger; "
      "full: it stops for nothing");
  d.Flag("returns_to_mode",
         &session.returns_to_mode,
         "Address it again after it has stopped itself; it moves once a "
         "command has asked for no motion");
  d.Number("return_delay_s",
           &session.return_delay_s,
           {0.0, 3600.0},
           "So long after it has stopped itself");
  d.Number("max_wheel_speed",
           &session.base.max_wheel_speed,
           {0.01, kCreateMaxSpeed / 1000.0},
           "Faster commands are slowed, on the same curve, m/s");
  d.Number("wheel_base",
           &session.base.wheel_base,
           {0.01, 2.0},
           "Between the wheels, m");
  d.Number("command_timeout_s",
           &session.base.command_timeout_s,
           {0.05, 10.0},
           "So long after the last MOTION_COMMAND the robot stands; no command "
           "makes a wheel faster than this times max_wheel_acceleration");
  d.Number("max_wheel_acceleration",
           &session.base.max_wheel_acceleration,
           {0.1, 100.0},
           "It brakes by this so as to stand then, m/s^2");
  d.Number("silence_s",
           &session.silence_s,
           {0.15, 60.0},
           "Without an answer for this long the robot counts as gone");
  d.Number("reopen_s",
           &create.reopen_s,
           {0.05, 60.0},
           "Between attempts to open the port");
  d.Number(
      "watchdog_s",
      &create.watchdog_s,
      {0.1, 3600.0},
      "Where this process hangs for so long, its watchdog stops the robot");
  d.Number("period_s",
           &period_s,
           {0.01, 0.1},
           "Between readings, and between commands that are sent again");
}

}  // namespace waymark
