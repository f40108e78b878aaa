// Random places to drive to in a world.
#pragma once

#include "drivers/simulator/geodesic.h"
#include "drivers/simulator/obstacle_map.h"
#include "estimation/base/random.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <vector>

namespace waymark {

struct DriveTaskOptions {
  double radius = 0.17;  // Of the robot, m.
  // The way to drive keeps so much farther from walls than the shortest, m.
  double clearance = 0.2;
  int num_goals = 3;
  double min_way = 2.0;  // Of the shortest way from one goal to the next, m.
  double max_way = 15.0;
  // Who walks is there when the run begins: starts keep away from them, m.
  std::vector<Eigen::Vector2d> people;
  double people_gap = 0.5;  // From their middle to the robot's side.
};

struct DriveTask {
  Pose2 X_WR;                              // Where the robot starts.
  std::vector<Eigen::Vector2d> goals;      // In W, in order.
  std::vector<Eigen::Vector2d> waypoints;  // On the way, goals included.
  double shortest_m = 0.0;  // Of the shortest ways through the goals.
};

class DriveTaskMaker {
 public:
  // Goals are what a robot reaches from p_W. `map` outlives this object. Throws
  // std::invalid_argument where nothing is reached from there.
  DriveTaskMaker(const ObstacleMap& map,
                 const DriveTaskOptions& options,
                 const Eigen::Vector2d& p_W);

  // Same seed, same task. Throws std::invalid_argument where a hundred draws
  // each from some starts find no goal whose way has the length asked for.
  [[nodiscard]] DriveTask Make(std::uint64_t seed) const;

 private:
  [[nodiscard]] std::optional<DriveTask> MakeOne(Random* random) const;

  DriveTaskOptions options_;
  Geodesic shortest_;
  Geodesic clear_;
  std::vector<Eigen::Vector2d> places_;
};

// The fewest of its points that keep a polyline within `tolerance`, by the
// rule of Douglas and Peucker.
[[nodiscard]] std::vector<Eigen::Vector2d> Simplified(
    const std::vector<Eigen::Vector2d>& points, double tolerance);

}  // namespace waymark
