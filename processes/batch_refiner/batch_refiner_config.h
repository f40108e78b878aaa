// Configuration of batch_refiner and waymark-refine.
#pragma once

#include "estimation/batch/batch_types.h"
#include "estimation/batch/batch_window.h"
#include "processes/support/describer.h"

#include <cstdint>
#include <vector>

namespace waymark {

// How a batch problem is set up, without the nominal wheel parameters.
struct BatchSolverConfig {
  std::vector<double> sigma_share{0.2, 0.2, 0.2};
  bool calibrate_position = false;
  bool calibrate_yaw = false;
  bool calibrate_time_offset = false;
  BatchOptions options;

  BatchSolverConfig();
  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const;
  [[nodiscard]] BatchOptions Options(const WheelParameters& nominal,
                                     bool shared_mounting = true) const;
};

struct BatchRefinerConfig {
  BatchWindowOptions window;
  double period_s = 10.0;
  // (k_right m, k_left m, wheel_base m); empty: ODOMETRY_PARAMETERS "nominal".
  std::vector<double> nominal;
  double max_wheel_speed = 5.0;
  BatchSolverConfig solver;

  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const;
};

}  // namespace waymark
