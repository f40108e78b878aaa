// From what a world file says to what is drawn and bumped into.
#pragma once

#include "drivers/simulator/scene.h"
#include "drivers/simulator/world.h"

#include <cstdint>

namespace waymark {

enum class SceneLooks : std::uint8_t { kDrawn, kPlain };

// Movers are the people in the order of World::people; the scene passes
// CheckScene(). Same world, same bytes.
//
// Throws InputError with the object's place in the file where something does
// not fit together (world_layout.h), a picture hangs over a door or past its
// wall, a material is unknown or a file cannot be used. Some 0.1 s per texture
// that is new, mesh files aside.
//
// Where nobody looks, plain looks save nearly all of that time: one grey for
// everything, no people. The mesh has its triangles and corners all the same.
[[nodiscard]] Scene BuildScene(const World& world,
                               SceneLooks looks = SceneLooks::kDrawn);

}  // namespace waymark
