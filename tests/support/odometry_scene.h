// A simulated drive as the filter sees it: readings and fixes with ground
// truth.
#pragma once

#include "estimation/filter/measurement_types.h"
#include "tests/support/drive_simulation.h"

#include <cstdint>
#include <vector>

namespace waymark {

struct OdometrySceneOptions {
  DriveSimulationOptions drive;
  Driver driver;  // Empty: a fixed program of turns without feedback.
  double fix_period_s = 0.5;
  double position_sigma = 0.03;  // m.
  double heading_sigma = 0.01;   // rad.
  bool has_position = true;
  bool has_heading = true;
  // Fixes fall between readings by this share of a period.
  double fix_shift = 0.3;
};

struct OdometryScene {
  std::vector<EncoderReading> readings;
  std::vector<AbsoluteFix> fixes;
  std::vector<Pose2> truth;  // One per reading.
};

[[nodiscard]] OdometryScene MakeOdometryScene(
    const OdometrySceneOptions& options);

}  // namespace waymark
