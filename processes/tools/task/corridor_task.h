// To and fro in a corridor, as way-points.
#pragma once

#include "planner/control/corridor_way.h"
#include "processes/convert/task_convert.h"

#include <string>
#include <vector>

namespace waymark {

struct CorridorTask {
  std::string corridors;  // File, or name of one that comes with Waymark.
  std::string corridor;   // Of them; empty: by `start`, or the first.
  std::string start;      // x,y where the robot stands; empty: anywhere.
  CorridorWayOptions way;
};

// In W. Throws InputError where there is no such corridor, the robot does not
// stand in it, or the way leaves it.
[[nodiscard]] std::vector<Waypoint> CorridorWaypoints(const CorridorTask& task);

}  // namespace waymark
