#include "processes/tools/experiment/experiment_world.h"

#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/mesh_outline.h"
#include "drivers/simulator/people.h"
#include "estimation/geometry/angle.h"
#include "processes/convert/world_file.h"

#include <vector>

namespace waymark {

ExperimentWorld LoadExperimentWorld(const SimulatorConfig& config) {
  const World world = LoadWorldFile(FindWorldFile(config.world));
  std::vector<Segment2> segments =
      OutlineOfMesh(BuildScene(world).mesh, HeightBand{});
  for (const WorldPerson& person : world.people) {
    if (person.motion != PersonMotion::kStand) continue;
    // The square about the person.
    const Eigen::Vector2d corner(kPersonRadius, kPersonRadius);
    const Eigen::Vector2d other(kPersonRadius, -kPersonRadius);
    const Eigen::Vector2d& p = person.at;
    segments.push_back({p - corner, p + other});
    segments.push_back({p + other, p + corner});
    segments.push_back({p + corner, p - other});
    segments.push_back({p - other, p - corner});
  }
  ExperimentWorld result;
  result.map = std::make_unique<ObstacleMap>(std::move(segments));
  if (!config.start.empty()) {
    result.start_W = {config.start[0], config.start[1]};
  } else if (!world.starts.empty()) {
    result.start_W = world.starts.front().X_WR.position();
  }
  return result;
}

SimulatorConfig SimulatorWithoutVision() {
  SimulatorConfig config;
  config.camera.name.clear();
  config.second_camera.name.clear();
  config.ranges = RangeKind::kLidar;
  return config;
}

SimulatorConfig WithStart(const SimulatorConfig& config,
                          const Pose2& X_WR,
                          std::uint64_t seed) {
  SimulatorConfig own = config;
  own.start = {X_WR.x, X_WR.y, DegreesFromRadians(X_WR.heading)};
  own.seed = static_cast<std::int64_t>(seed);
  return own;
}

PoseFilterConfig ForRobot(const PoseFilterConfig& config,
                          const SimulatorConfig& simulator,
                          const Pose2& X_WR) {
  PoseFilterConfig own = config;
  const RobotOptions& robot = simulator.robot;
  own.nominal = {
      robot.meters_per_tick, robot.meters_per_tick, robot.wheel_base};
  own.wheel_variance = robot.wheel_variance;
  own.base_variance = robot.base_variance;
  own.start_position = {X_WR.x, X_WR.y};
  own.start_heading = X_WR.heading;
  return own;
}

}  // namespace waymark
