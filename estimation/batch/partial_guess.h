// First guess of a robot's path from fixes of which none is a whole position.
#pragma once

#include "estimation/batch/batch_input.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace waymark {

// One pose per time (s of the track, ascending): dead reckoning from the log's
// start pose, or the origin, turned by what fixes say of the heading and moved
// by what they say of x or y in their frames (a corridor's lines: lateral
// position and heading). Medians of neighbours keep wild fixes out. What no
// fix speaks of stays dead reckoning. Headings are not wrapped.
[[nodiscard]] std::vector<Eigen::Vector3d> GuessFromParts(
    const BatchLogInput& log,
    std::span<const BatchSensorSlot> sensors,
    std::span<const double> times,
    const BatchOptions& options);

}  // namespace waymark
