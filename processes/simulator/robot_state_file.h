// Where a simulated robot stood and when, so that a restarted simulator goes on
// from there.
#pragma once

#include "drivers/simulator/robot.h"
#include "estimation/base/time.h"

#include <optional>
#include <string>

namespace waymark {

struct RobotState {
  std::string world;  // Its file.
  RobotSnapshot snapshot;
  Time time;  // No message of it is newer.
};

// nullopt where there is no such file. Throws InputError with one line (file,
// key, value, allowed range) where it cannot be read or is no such file. The
// pose is finite; whether a robot can be there is not looked at.
[[nodiscard]] std::optional<RobotState> LoadRobotState(const std::string& path);

// What LoadRobotState() reads: the same again, bit for bit.
[[nodiscard]] std::string TextOfRobotState(const RobotState& state);

}  // namespace waymark
