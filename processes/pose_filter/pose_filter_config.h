// Configuration of pose_filter.
#pragma once

#include "estimation/filter/delayed_fusion.h"
#include "estimation/geometry/angle.h"
#include "processes/support/describer.h"

#include <cstdint>
#include <string>
#include <vector>

namespace waymark {

enum class ParameterUse { kOwn, kBatch };

struct PoseFilterConfig {
  double window_s = 2.0;
  double max_ahead_s = 10.0;
  // (k_right m, k_left m, wheel_base m); empty: ODOMETRY_PARAMETERS "nominal".
  std::vector<double> nominal;
  std::vector<double> nominal_sigma{0.05, 0.05, 0.1};
  ParameterUse use = ParameterUse::kOwn;
  std::string parameters_file;
  double parameters_period_s = 1.0;
  std::vector<double> start_position;  // (x m, y m); empty: none.
  double start_heading = 0.0;
  double start_position_sigma = 0.05;
  double start_heading_sigma = 0.02;
  double max_wheel_speed = 5.0;
  double jitter_s = 0.1;
  double wheel_variance = 1e-4;
  double base_variance = 1e-6;
  std::vector<double> walk_per_sqrt_metre{0.0, 0.0, 0.0};
  std::vector<double> walk_per_sqrt_second{0.0, 0.0, 0.0};
  ParameterForm form = ParameterForm::kTurn;
  DriveIntegration integration = DriveIntegration::kArc;
  GateOptions gate;
  double mounting_position_sigma = 0.01;
  double mounting_yaw_sigma = RadiansFromDegrees(2.0);
  std::int64_t max_motions = 8;
  std::int64_t max_sensors = 4;
  std::int64_t doubt_after = 5;
  std::int64_t relocalise_after = 5;
  PoseAlignerOptions alignment;

  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const;
  // Without what parameters_file holds.
  [[nodiscard]] DelayedFusionOptions Options() const;

 private:
  void DescribeWheels(Describer& d);
  void DescribeStart(Describer& d);
  void DescribeAlignment(Describer& d);
  void DescribeNoise(Describer& d);
  void DescribeGate(Describer& d);
  void DescribeMotion(Describer& d);
};

}  // namespace waymark
