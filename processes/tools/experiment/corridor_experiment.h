// The tasks of the corridor system, in closed loop.
#pragma once

#include "estimation/corridor/corridor_types.h"
#include "processes/tools/experiment/corridor_experiment_config.h"
#include "processes/tools/experiment/experiment.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// Success: the task is done without a touch, and lateral position and heading
// of POSE are, all the time, within max_error of TRUTH; where the camera was
// blind, from relocate_m of sight on. How far along the corridor the robot is
// its lines do not say.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
class CorridorExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view name() const override { return "corridor"; }
  void Describe(Describer& d) override { config_.Describe(d); }
  void Prepare() override;
  [[nodiscard]] std::string Subject() const override { return subject_; }
  [[nodiscard]] RunResult Run(std::uint64_t seed,
                              const std::string& log_path) const override;

 private:
  [[nodiscard]] std::vector<Eigen::Vector2d> Way() const;  // In L.
  [[nodiscard]] SimulatorConfig Robot(std::uint64_t seed) const;
  [[nodiscard]] PoseFilterConfig Filter(const SimulatorConfig& robot) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> BlindWay() const;

  CorridorExperimentConfig config_;
  CorridorGeometry corridor_;
  std::string corridor_path_;
  std::string subject_;
};

}  // namespace waymark
