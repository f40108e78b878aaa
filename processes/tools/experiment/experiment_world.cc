#include "processes/tools/experiment/experiment_world.h"

#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/walk_area.h"
#include "estimation/base/fingerprint.h"
#include "estimation/geometry/angle.h"
#include "processes/convert/world_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

std::vector<Segment2> SegmentsOf(const World& world, double height) {
  std::vector<Segment2> segments = WalkArea(world, height).map().segments();
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

// Walls and furniture, what they look like where there is a camera, and people.
std::string SubjectOf(const SimulatorConfig& config, const World& world) {
  const bool has_camera =
      !config.camera.name.empty() || !config.second_camera.name.empty();
  Fingerprint print;
  print.Add(FingerprintOf(
      BuildScene(world, has_camera ? SceneLooks::kDrawn : SceneLooks::kPlain)));
  for (const WorldPerson& person : world.people) {
    print.Add(static_cast<int>(person.motion));
    print.Add(person.is_closed);
    for (const double value : {person.at.x(),
                               person.at.y(),
                               person.heading,
                               person.speed,
                               person.start,
                               person.bearing,
                               person.clearance}) {
      print.Add(value);
    }
    for (const Eigen::Vector2d& p : person.path) {
      print.Add(p.x());
      print.Add(p.y());
    }
  }
  return fmt::format("world {} {:016x}", config.world, print.value());
}

// Those who walk are somewhere when a run begins.
DriveTaskOptions WithPeople(DriveTaskOptions options, const World& world) {
  const auto poses = People(world, {}).PosesAt(0.0, Pose2{});
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (world.people[i].motion != PersonMotion::kWalk) continue;
    options.people.push_back(poses[i].position());
  }
  return options;
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
      tasks(map, WithPeople(options, world), StartOf(config, world)) {}

ExperimentTasks::ExperimentTasks(const SimulatorConfig& config,
                                 const DriveTaskOptions& options)
    : config_(config), options_(options) {
  if (config.world == kWorldPerSeed) {
    subject_ = "random worlds";
    return;
  }
  const waymark::World world = LoadWorldFile(FindWorldFile(config.world));
  world_ = std::make_unique<World>(config, options, world);
  subject_ = SubjectOf(config, world);
}

DriveTask ExperimentTasks::Make(std::uint64_t seed) const {
  if (world_) return world_->tasks.Make(seed);
  SimulatorConfig own = WithStart(config_, {}, seed);
  own.start = config_.start;
  return World(own, options_).tasks.Make(seed);
}

std::string SubjectOf(const SimulatorConfig& config) {
  return SubjectOf(config, LoadWorldFile(FindWorldFile(config.world)));
}

ObstacleMap WallsOf(const SimulatorConfig& config) {
  return WalkArea(LoadWorldFile(FindWorldFile(config.world)),
                  config.robot.height)
      .map();
}

void CheckForRuns(const SimulatorConfig& config) {
  config.Check();
  CheckHasNoFile("simulator.state_file", config.state_file);
  if (config.pace != Pace::kRealTime || config.speed != 1.0) {
    throw std::invalid_argument(
        "simulator.time: must be pace real_time and speed 1: runs are in "
        "simulated time, as fast as the machine goes");
  }
}

void CheckHasNoFile(const std::string& key, const std::string& path) {
  if (path.empty()) return;
  throw std::invalid_argument(key + " = " + path +
                              ": must be empty: runs know nothing of each "
                              "other");
}

// A goal that is passed saves the radius before and behind it, the last one
// once.
double ShortestPast(const DriveTask& task, double radius) {
  const double saved =
      (2.0 * static_cast<double>(task.goals.size()) - 1.0) * radius;
  return std::max(0.0, task.shortest_m - saved);
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
