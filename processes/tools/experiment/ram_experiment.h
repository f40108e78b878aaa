// Rams whatever there is, through collision_guard.
#pragma once

#include "processes/collision_guard/collision_guard_config.h"
#include "processes/simulator/simulator_config.h"
#include "processes/tools/experiment/drive_task.h"
#include "processes/tools/experiment/experiment.h"
#include "processes/tools/experiment/experiment_world.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace waymark {

// Asks for full speed in a random direction again and again, into whatever
// there is, through collision_guard. Success: not one touch in duration_s.
struct RamExperimentConfig {
  double duration_s = 60.0;
  double period_s = 2.0;  // A new direction so often.
  SimulatorConfig simulator;
  CollisionGuardConfig collision_guard;

  RamExperimentConfig();
  void Describe(Describer& d);
  void Check() const;
};

class RamExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view name() const override { return "ram"; }
  void Describe(Describer& d) override { config_.Describe(d); }
  void Prepare() override;
  [[nodiscard]] std::string Subject() const override {
    return tasks_->subject();
  }
  [[nodiscard]] RunResult Run(std::uint64_t seed,
                              const std::string& log_path) const override;

 private:
  RamExperimentConfig config_;
  std::optional<ExperimentTasks> tasks_;  // For where to start.
};

}  // namespace waymark
