// Drives to random goals in a world, without vision.
#pragma once

#include "processes/collision_guard/collision_guard_config.h"
#include "processes/path_follower/task_follower_config.h"
#include "processes/pose_filter/pose_filter_config.h"
#include "processes/simulator/simulator_config.h"
#include "processes/tools/experiment/drive_task.h"
#include "processes/tools/experiment/experiment.h"
#include "processes/tools/experiment/experiment_world.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace waymark {

struct DriveExperimentConfig {
  DriveTaskOptions task;
  double goal_radius_m = 0.3;
  double max_duration_s = 300.0;
  // Stands in for a localiser: POSITION_FIX so often, from TRUTH with noise.
  double fix_period_s = 2.0;  // 0: never.
  double fix_sigma_m = 0.03;
  double fix_sigma_rad = 0.02;
  SimulatorConfig simulator;
  PoseFilterConfig pose_filter;
  CollisionGuardConfig collision_guard;
  TaskFollowerConfig path_follower;

  DriveExperimentConfig();
  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const;
};

// Success: path_follower says that it is done, and the robot, truly, has been
// within goal_radius_m of every goal, in order, and stands so near to the last.
// The shortest way goes no nearer to the goals than that.
class DriveExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view name() const override { return "drive"; }
  void Describe(Describer& d) override { config_.Describe(d); }
  void Prepare() override;
  [[nodiscard]] std::string Subject() const override {
    return tasks_->subject();
  }
  [[nodiscard]] RunResult Run(std::uint64_t seed,
                              const std::string& log_path) const override;

 private:
  DriveExperimentConfig config_;
  std::optional<ExperimentTasks> tasks_;
};

}  // namespace waymark
