// What experiments in a simulated world have in common.
#pragma once

#include "drivers/simulator/obstacle_map.h"
#include "drivers/simulator/world.h"
#include "processes/pose_filter/pose_filter_config.h"
#include "processes/simulator/simulator_config.h"
#include "processes/tools/experiment/drive_task.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace waymark {

// As SimulatorConfig::world: each run has a random world of its own.
inline constexpr std::string_view kWorldPerSeed = "random";

// Where runs start and drive to, in the world that a planner knows: walls and
// furniture, and who stands there.
class ExperimentTasks {
 public:
  // Throws InputError as LoadWorldFile() and BuildScene() do, and
  // std::invalid_argument as DriveTaskMaker.
  ExperimentTasks(const SimulatorConfig& config,
                  const DriveTaskOptions& options);

  // As DriveTaskMaker::Make().
  [[nodiscard]] DriveTask Make(std::uint64_t seed) const;

  // The world's name and, of one file, a number that changes with its content.
  [[nodiscard]] const std::string& subject() const { return subject_; }

 private:
  struct World {
    World(const SimulatorConfig& config, const DriveTaskOptions& options);
    World(const SimulatorConfig& config,
          const DriveTaskOptions& options,
          const waymark::World& world);

    ObstacleMap map;
    DriveTaskMaker tasks;
  };

  SimulatorConfig config_;
  DriveTaskOptions options_;
  std::string subject_;
  std::unique_ptr<World> world_;  // Null where each run has its own.
};

// Walls and furniture of the configuration's world. Throws as LoadWorldFile()
// and BuildScene() do.
[[nodiscard]] ObstacleMap WallsOf(const SimulatorConfig& config);

// The world's name and, of one file, a number that changes with its content.
[[nodiscard]] std::string SubjectOf(const SimulatorConfig& config);

// As config.Check(), and that a run depends on nothing but its seed, in
// simulated time: no state file, no other pace.
void CheckForRuns(const SimulatorConfig& config);
// Of the other processes' files. Throws std::invalid_argument naming the key.
void CheckHasNoFile(const std::string& key, const std::string& path);

// At least so far drives who comes within `radius` of all goals, m.
[[nodiscard]] double ShortestPast(const DriveTask& task, double radius);

// Changes that every experiment makes: no cameras, a lidar, no state file.
[[nodiscard]] SimulatorConfig SimulatorWithoutVision();
// One run's own seed and start, and world where that is random.
[[nodiscard]] SimulatorConfig WithStart(const SimulatorConfig& config,
                                        const Pose2& X_WR,
                                        std::uint64_t seed);
// Knows the nominal wheels of the simulated robot, its noise, and where it
// starts.
[[nodiscard]] PoseFilterConfig ForRobot(const PoseFilterConfig& config,
                                        const SimulatorConfig& simulator,
                                        const Pose2& X_WR);

}  // namespace waymark
