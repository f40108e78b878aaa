// Corridor files: what is known of a building's corridors.
#pragma once

#include "estimation/corridor/corridor_types.h"

#include <string>
#include <vector>

namespace waymark {

// YAML, read as strictly as a configuration:
//
//   corridors:
//     - name: corridor
//       width: 2.0             # Between the walls, m; left out: not known
//       height: 2.5            # Floor to ceiling, m; left out: not known
//       skirting_height: 0.08  # Of the boards' upper edge, m; left out: none
//       skirting_depth: 0.012  # How far they stand out from the wall, m (0)
//       x: [0, 20]             # Where it begins and ends along its axis, m
//       axis_W: [0, 1, 0]      # A point midway between the walls, x and y in
//                              # m, where x is 0, and the axis' direction, deg
//
// Throws InputError with one line (file, key, value, allowed range) where it
// cannot be read, has no corridor, or two of one name.
[[nodiscard]] std::vector<CorridorGeometry> LoadCorridorFile(
    const std::string& path);
// The same from text; `source` names it in errors.
[[nodiscard]] std::vector<CorridorGeometry> CorridorsFromYaml(
    const std::string& yaml, const std::string& source);
// Path of a corridor file by name or path; a name may be one of the simulator's
// worlds that are corridors. Throws InputError that lists them.
[[nodiscard]] std::string FindCorridorFile(const std::string& name);

}  // namespace waymark
