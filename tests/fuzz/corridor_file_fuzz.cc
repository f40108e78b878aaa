// Corridor files: refused in one line, or corridors that a robot can be in.
#include "processes/convert/corridor_file.h"
#include "tests/fuzz/fuzz_target.h"

#include <cmath>
#include <set>

namespace waymark::fuzz {

void RunOne(Bytes data) {
  std::vector<CorridorGeometry> corridors;
  const bool taken = TakesOrRefuses([&] {
    corridors = CorridorsFromYaml(std::string(Text(data)), "fuzz.yaml");
  });
  if (!taken) return;
  Expect(!corridors.empty(), "a corridor at least");
  std::set<std::string> names;
  for (const CorridorGeometry& corridor : corridors) {
    Expect(names.insert(corridor.name).second, "each of its own name");
    Expect(!corridor.name.empty(), "which is not empty");
    corridor.Check();
    const Pose2& X_WL = corridor.X_WL;
    Expect(std::isfinite(X_WL.x) && std::isfinite(X_WL.y) &&
               std::isfinite(X_WL.heading),
           "it is somewhere");
  }
}

std::vector<std::string> Seeds() {
  const std::string one =
      "corridors:\n  - name: corridor\n    width: 2.0\n    height: 2.5\n"
      "    skirting_height: 0.08\n    skirting_depth: 0.012\n"
      "    x: [0, 20]\n    axis_W: [0, 1, 0]\n";
  return {one,
          one + "  - {name: other, axis_W: [1e3, -2, 270]}\n",
          "corridors: [{name: a, axis_W: [0, 0, 0], x: [2, 1]}]\n"};
}

}  // namespace waymark::fuzz
