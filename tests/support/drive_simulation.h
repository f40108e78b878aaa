// Generator of drives with ground truth, for tests, benchmarks and log samples.
#pragma once

#include "estimation/base/time.h"
#include "estimation/filter/differential_drive.h"
#include "estimation/geometry/pose2.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace waymark {

// Asked-for velocity of the robot: forward m/s, turn rate rad/s.
struct DriveCommand {
  double forward = 0.0;
  double turn_rate = 0.0;
};

// Chooses the command from the time since the start (s) and the true pose
// (the driver sees where the robot is).
using Driver = std::function<DriveCommand(double, const Pose2&)>;

struct DriveSimulationOptions {
  WheelParameters parameters{1e-4, 1e-4, 0.27};  // The true ones.
  DriveNoise noise;
  DriveIntegration integration = DriveIntegration::kArc;
  Pose2 start;
  Time start_time = TimeFromMicroseconds(1'000'000'000);
  double rate_hz = 50.0;  // Of the encoder readings.
  double duration_s = 60.0;
  bool whole_ticks = true;  // Readings are integers; the truth follows them.
  std::uint64_t seed = 1;
};

struct SimulatedReading {
  Time time;
  double left_ticks = 0.0;  // Cumulative.
  double right_ticks = 0.0;
  Pose2 X_WR;  // True pose at this time.
};

// Drives and records one reading per encoder period, the first at start_time.
// Noise enters exactly as DriveNoise describes it, so a consistent estimator
// reaches the Cramer-Rao bound. Same options, same result.
[[nodiscard]] std::vector<SimulatedReading> SimulateDrive(
    const DriveSimulationOptions& options, const Driver& driver);

// Zig-zag about the x axis: legs of leg_m at +-amplitude_rad, turning at
// turn_rate between them.
[[nodiscard]] Driver ZigZagDriver(double forward,
                                  double amplitude_rad,
                                  double leg_m,
                                  double turn_rate);
// Straight sides and left (positive) or right quarter turns on the spot.
[[nodiscard]] Driver SquareDriver(double forward,
                                  double side_m,
                                  double turn_rate);
[[nodiscard]] Driver CircleDriver(double forward, double radius_m);

}  // namespace waymark
