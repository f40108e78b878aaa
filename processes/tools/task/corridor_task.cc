#include "processes/tools/task/corridor_task.h"

#include "estimation/base/input_error.h"
#include "processes/convert/corridor_file.h"
#include "processes/tools/task/task_places.h"

#include <fmt/format.h>

#include <cmath>

namespace waymark {
namespace {

bool IsIn(const CorridorGeometry& corridor, const Eigen::Vector2d& p_W) {
  const Eigen::Vector2d p_L = Inverse(corridor.X_WL) * p_W;
  return p_L.x() >= corridor.x_min && p_L.x() <= corridor.x_max &&
         (!corridor.width || std::abs(p_L.y()) <= 0.5 * *corridor.width);
}

CorridorGeometry CorridorOf(const CorridorTask& task) {
  std::vector<CorridorGeometry> corridors =
      LoadCorridorFile(FindCorridorFile(task.corridors));
  std::string known;
  for (const CorridorGeometry& corridor : corridors) {
    known += (known.empty() ? "" : ", ") + corridor.name;
  }
  if (!task.corridor.empty()) {
    std::erase_if(corridors, [&](const CorridorGeometry& corridor) {
      return corridor.name != task.corridor;
    });
    if (corridors.empty()) {
      throw InputError("--corridor: no '" + task.corridor + "' in " +
                       task.corridors + ", which has " + known);
    }
  }
  if (!task.start.empty()) {
    const Eigen::Vector2d start = WaypointFromText(task.start).p_W;
    std::erase_if(corridors, [&](const CorridorGeometry& corridor) {
      return !IsIn(corridor, start);
    });
    if (corridors.empty()) {
      throw InputError(
          "--start: the robot at " + task.start + " is not in " +
          (task.corridor.empty() ? "any of " + known : task.corridor));
    }
  }
  return corridors.front();
}

// Throws InputError where the way leaves the corridor.
void CheckWay(const CorridorWayOptions& way, const CorridorGeometry& corridor) {
  const double end = way.begin + way.length;
  if (way.begin < corridor.x_min || end > corridor.x_max) {
    throw InputError(fmt::format(
        "--begin, --length: the way is from {:g} to {:g} m, {} from {:g} to "
        "{:g}",
        way.begin,
        end,
        corridor.name,
        corridor.x_min,
        corridor.x_max));
  }
  if (corridor.width && way.zigzag >= 0.5 * *corridor.width) {
    throw InputError(
        fmt::format("--zigzag: {:g} m to both sides, {} is {:g} m "
                    "wide",
                    way.zigzag,
                    corridor.name,
                    *corridor.width));
  }
}

}  // namespace

std::vector<Waypoint> CorridorWaypoints(const CorridorTask& task) {
  const CorridorGeometry corridor = CorridorOf(task);
  CheckWay(task.way, corridor);
  std::vector<Waypoint> waypoints;
  for (const Eigen::Vector2d& p_L : CorridorWay(task.way)) {
    waypoints.push_back({corridor.X_WL * p_L, {}});
  }
  return waypoints;
}

}  // namespace waymark
