// Simulated batch problems with ground truth, and the bound on their accuracy.
#pragma once

#include "estimation/batch/batch_types.h"
#include "tests/support/drive_simulation.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>

namespace waymark {

struct BatchSimulationOptions {
  DriveSimulationOptions drive;
  std::string source = "sensor";
  Pose2 X_RS;                  // True mounting.
  Pose2 X_RS_nominal;          // As the messages state it.
  double time_offset_s = 0.0;  // Sensor's clock minus encoders'.
  int fix_every = 10;          // Readings per fix; 0: no fixes.
  bool has_heading = true;     // Of the fixes.
  int motion_every = 0;        // Readings per relative motion; 0: none.
  double sigma_m = 0.01;       // Of measurements, per axis.
  double sigma_rad = 0.01;
  bool is_exact = false;  // No measurement noise (sigmas are still stated).
  double outlier_share = 0.0;  // Measurements that are off by ...
  double outlier_m = 1.0;      // ... normal with this sigma (and as many rad).
};

struct BatchSimulation {
  BatchLog log;
  std::vector<SimulatedReading> truth;  // At every reading.
};

// The drive's seed also seeds the measurements. Same options, same result.
[[nodiscard]] BatchSimulation SimulateBatch(
    const BatchSimulationOptions& options, const Driver& driver);

// Left circles, right circles and straights in turn: everything about the
// wheels and a sensor can be told from it.
[[nodiscard]] Driver MixedDriver(double forward);

// Cramer-Rao bound of (k_right, k_left, B, sensor x, y, yaw, time offset) with
// these priors: the Riccati recursion along the true path, which knows nothing
// of the batch solver. Components that `sensor` holds have bound 0. The start
// pose is unknown.
[[nodiscard]] Eigen::Matrix<double, 7, 7> CramerRaoBound(
    const BatchSimulationOptions& options,
    const BatchSimulation& simulation,
    const Eigen::Vector3d& prior_sigma,
    const BatchSensorOptions& sensor);

}  // namespace waymark
