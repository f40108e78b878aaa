#include "processes/tools/experiment/experiment_world.h"

#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/mesh_outline.h"
#include "drivers/simulator/people.h"
#include "estimation/geometry/angle.h"
#include "processes/convert/world_file.h"

#include <string>
#include <vector>

namespace waymark {
namespace {

std::vector<Segment2> WallsIn(const World& world, double height) {
  return OutlineOfMesh(BuildScene(world, SceneLooks::kPlain).mesh,
                       {.high = height});
}

std::vector<Segment2> SegmentsOf(const World& world, double height) {
  std::vector<Segment2> segments = WallsIn(world, height);
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
  return segments;
}

// Free; its usual one.
Eigen::Vector2d StartOf(const SimulatorConfig& config, const World& world) {
  if (!config.start.empty()) return {config.start[0], config.start[1]};
  if (!world.starts.empty()) return world.starts.front().X_WR.position();
  return Eigen::Vector2d::Zero();
}

}  // namespace

ExperimentTasks::World::World(const SimulatorConfig& config,
                              const DriveTaskOptions& options)
    : World(config, options, LoadWorldFile(FindWorldFile(config.world))) {}

ExperimentTasks::World::World(const SimulatorConfig& config,
                              const DriveTaskOptions& options,
                              const waymark::World& world)
    : map(SegmentsOf(world, config.robot.height)),
      tasks(map, options, StartOf(config, world)) {}

ExperimentTasks::ExperimentTasks(const SimulatorConfig& config,
                                 const DriveTaskOptions& options)
    : config_(config), options_(options) {
  if (config.world != kWorldPerSeed) {
    world_ = std::make_unique<World>(config, options);
  }
}

DriveTask ExperimentTasks::Make(std::uint64_t seed) const {
  if (world_) return world_->tasks.Make(seed);
  SimulatorConfig own = WithStart(config_, {}, seed);
  own.start = config_.start;
  return World(own, options_).tasks.Make(seed);
}

ObstacleMap WallsOf(const SimulatorConfig& config) {
  return ObstacleMap(WallsIn(LoadWorldFile(FindWorldFile(config.world)),
                             config.robot.height));
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
  if (own.world == kWorldPerSeed) {
    own.world = std::string(kRandomWorld) + std::to_string(seed);
  }
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
