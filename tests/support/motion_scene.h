// Drives with a sensor that measures its own motion, and nothing else.
#pragma once

#include "tests/support/batch_simulation.h"

#include <Eigen/Core>

#include <cstdint>

namespace waymark {

inline constexpr WheelParameters kMotionWheels{1.03e-4, 0.97e-4, 0.27};
inline constexpr Pose2 kMotionMounting{0.1, -0.04, 1.2};

// Twice a second, good to 2 mm and 3 mrad, where the messages say it is.
inline BatchSimulationOptions MotionDrive(std::uint64_t seed) {
  BatchSimulationOptions options;
  options.drive.parameters = kMotionWheels;
  options.drive.rate_hz = 20.0;
  options.drive.duration_s = 48.0;
  options.drive.seed = seed;
  options.fix_every = 0;
  options.motion_every = 10;
  options.X_RS = options.X_RS_nominal = kMotionMounting;
  options.sigma_m = 2e-3;
  options.sigma_rad = 3e-3;
  return options;
}

// Without noise, and ticks so fine that whole ones are exact.
inline BatchSimulationOptions ExactMotionDrive() {
  BatchSimulationOptions options = MotionDrive(1);
  options.drive.noise = {0.0, 0.0};
  options.drive.parameters.k_right *= 1e-4;
  options.drive.parameters.k_left *= 1e-4;
  options.is_exact = true;
  return options;
}

inline WheelParameters Scaled(const WheelParameters& p,
                              const Eigen::Vector3d& by) {
  return WheelParameters::FromVector(p.vector().cwiseProduct(by));
}

}  // namespace waymark
