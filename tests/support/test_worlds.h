// Worlds of a few rooms, for tests.
#pragma once

#include "drivers/simulator/world.h"

#include <string>
#include <vector>

namespace waymark {

[[nodiscard]] WorldRoom RectangleRoom(const std::string& name,
                                      double west,
                                      double south,
                                      double east,
                                      double north,
                                      double height);
[[nodiscard]] WorldRoom OutlineRoom(const std::string& name,
                                    const std::vector<Eigen::Vector2d>& outline,
                                    double height);

// A corridor of 10 x 2 m from the origin, 2.5 m high; north of it, behind walls
// of 0.15 m, the rooms "study" (4 x 3 m, 3 m high) from x = 0 and "hall"
// (5.85 x 3 m, 2.5 m high) from x = 4.15. In its north wall a door (0.9 x 2.05
// m, open 90 degrees, hinge left) to the study at x = 2 and an opening (1.5 m,
// full height) to the hall at x = 7; in its south wall a shut door to nowhere
// (0.8 x 2 m) at x = 5.
[[nodiscard]] World TwoRoomsAndCorridor();

// The rooms turned about the origin, then moved. What stands in them stays.
[[nodiscard]] World Turned(World world,
                           double angle,
                           const Eigen::Vector2d& shift);

}  // namespace waymark
