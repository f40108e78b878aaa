// Worlds that nobody has drawn, to try robots in.
#pragma once

#include "drivers/simulator/world.h"

#include <cstdint>

namespace waymark {

// One to five rooms and corridors in a row or tree, joined by openings and
// doors that stand 15 to 95 degrees open, now and then shut; corners cut off or
// built out, the whole turned as it comes. Pillars, furniture and people who
// stand, as near to each other and to the walls as it happens, but none in a
// passage.
//
// Its one start is kStartClearance or more away from everything. BuildScene()
// and WalkArea take it. Same seed, same world.
[[nodiscard]] World RandomWorld(std::uint64_t seed);

inline constexpr double kStartClearance = 0.5;  // m.

}  // namespace waymark
