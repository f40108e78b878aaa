// Floors, walls, ceilings, and what is fixed in the holes of walls.
#pragma once

#include "drivers/simulator/finishes.h"
#include "drivers/simulator/world_layout.h"

namespace waymark {

// Appends the rooms of a world to a scene: their walls with holes where doors
// and openings are, the reveals in between, frames, leaves, skirting boards.
// Neighbouring faces share their corners to the last bit. Throws InputError for
// a material unknown.
void BuildRooms(const World& world,
                const Layout& layout,
                Finishes* finishes,
                Scene* scene);

// Index of a new surface.
std::uint32_t AddSurface(const std::string& name,
                         SurfaceKind kind,
                         Scene* scene);

}  // namespace waymark
