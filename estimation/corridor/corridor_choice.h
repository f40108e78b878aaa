// Which of a building's corridors a robot is in.
#pragma once

#include "estimation/corridor/corridor_types.h"
#include "estimation/filter/estimate_types.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace waymark {

struct CorridorChoice {
  std::optional<std::size_t> corridor;  // Index; absent: in none of them.
  std::optional<CorridorPrior> prior;   // In it, where a pose is known.
  std::string reason;                   // Why in none.
};

// The corridor whose floor the robot is on, as far as its pose is known: three
// sigmas beyond it still count. Of several that cross the one along which it
// looks most. Without a pose the only one, if there is only one. A corridor of
// unknown width is taken to be 3 m wide.
[[nodiscard]] CorridorChoice ChooseCorridor(
    std::span<const CorridorGeometry> corridors,
    const std::optional<PoseEstimate>& pose);

}  // namespace waymark
