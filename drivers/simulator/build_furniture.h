// Desks, chairs, cabinets, shelves, sofas, plants, of boxes and columns.
#pragma once

#include "drivers/simulator/finishes.h"
#include "drivers/simulator/world.h"

#include <Eigen/Core>

#include <string>

namespace waymark {

// "desk", "table", "chair", ...
[[nodiscard]] std::string NameOf(FurnitureKind kind);
// Depth, width, height where none are given, m.
[[nodiscard]] Eigen::Vector3d UsualSize(FurnitureKind kind);

// Appends one piece. Its geometry stays within its size, but for the leaves of
// plants (by a tenth) and what stands on a desk. Throws InputError for a
// material unknown.
void BuildFurniture(const WorldFurniture& piece,
                    Finishes* finishes,
                    Scene* scene);

}  // namespace waymark
