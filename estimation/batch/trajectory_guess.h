// First guess of a robot's path from ticks and absolute fixes.
#pragma once

#include "estimation/batch/batch_input.h"

#include <span>
#include <vector>

namespace waymark {

// One pose per time (s of the track, ascending). Dead reckoning is laid onto
// the fixes piece by piece (rigid least squares over a window of travel), so
// that wheel parameters which are off by tens of percent bend it but little.
// Without a fix that carries a position it is GuessFromParts(). Headings are
// not wrapped: neighbours differ by what the ticks say, up to the bending.
[[nodiscard]] std::vector<Eigen::Vector3d> GuessTrajectory(
    const BatchLogInput& log,
    std::span<const BatchSensorSlot> sensors,
    std::span<const double> times,
    const BatchOptions& options);

}  // namespace waymark
