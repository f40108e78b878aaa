// Where a simulated robot stood, so that a restarted simulator goes on there.
#pragma once

#include "drivers/simulator/robot.h"

#include <optional>
#include <string>

namespace waymark {

struct RobotState {
  std::string world;  // Its file.
  RobotSnapshot snapshot;
};

// nullopt where there is no such file, or it is of another world. Throws
// InputError with one line (file, key, value, allowed range) where it cannot be
// read or is no such file.
[[nodiscard]] std::optional<RobotSnapshot> LoadRobotState(
    const std::string& path, const std::string& world);

// As SaveStateFile() does; loads back bit for bit.
void SaveRobotState(const std::string& path, const RobotState& state);

}  // namespace waymark
