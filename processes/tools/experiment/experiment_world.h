// What experiments in a simulated world have in common.
#pragma once

#include "drivers/simulator/obstacle_map.h"
#include "processes/pose_filter/pose_filter_config.h"
#include "processes/simulator/simulator_config.h"
#include "processes/tools/experiment/drive_task.h"

#include <Eigen/Core>

#include <cstdint>
#include <memory>

namespace waymark {

// A world as a planner knows it: its walls and furniture, and who stands there.
struct ExperimentWorld {
  std::unique_ptr<ObstacleMap> map;
  Eigen::Vector2d start_W = Eigen::Vector2d::Zero();  // Free; its usual one.
};

// Throws InputError as LoadWorldFile() and BuildScene() do.
[[nodiscard]] ExperimentWorld LoadExperimentWorld(
    const SimulatorConfig& config);

// Changes that every experiment makes: no cameras, a lidar, no state file.
[[nodiscard]] SimulatorConfig SimulatorWithoutVision();
// One run's own seed and start.
[[nodiscard]] SimulatorConfig WithStart(const SimulatorConfig& config,
                                        const Pose2& X_WR,
                                        std::uint64_t seed);
// Knows the nominal wheels of the simulated robot, its noise, and where it
// starts.
[[nodiscard]] PoseFilterConfig ForRobot(const PoseFilterConfig& config,
                                        const SimulatorConfig& simulator,
                                        const Pose2& X_WR);

}  // namespace waymark
