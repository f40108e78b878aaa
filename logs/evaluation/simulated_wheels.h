// The true wheels of a simulated robot.
#pragma once

#include "estimation/filter/differential_drive.h"

#include <optional>
#include <string>

namespace waymark {

// From the configuration that the simulator published, as YAML: nominal values
// by the factors of its noise. Nothing where that says none.
[[nodiscard]] std::optional<WheelParameters> SimulatedWheels(
    const std::string& yaml);

}  // namespace waymark
