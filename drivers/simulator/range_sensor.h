// Sonar rings and planar lidars.
#pragma once

#include "drivers/simulator/obstacle_map.h"
#include "estimation/base/random.h"
#include "estimation/geometry/pose2.h"

#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

// Beams from a circle about the sensor's origin, all at one instant. A beam
// with a width hears the nearest thing in its cone that throws sound back: what
// it meets steeply enough, and at short range edges and corners at any angle.
// One without a width is a ray of light, which every wall scatters. No beam
// hears another.
struct RangeSensorOptions {
  double rate_hz = 10.0;
  int num_beams = 16;
  double first_bearing = 0.0;  // In S, rad.
  double bearing_step = 0.0;   // rad.
  Pose2 X_RS;                  // Where it sits.
  // The transducers' distance from S's origin, m. Ranges count from the origin.
  double ring_radius = 0.0;
  double max_range = 4.0;      // What is read where nothing is heard, m.
  double beam_width = 0.0;     // rad.
  double max_incidence = 1.6;  // Between beam and normal; above: no echo, rad.
  double edge_range = 0.0;     // Edges and corners are heard up to here, m.
  double sigma = 0.0;          // Noise: sigma + sigma_share * range, m.
  double sigma_share = 0.0;
  double drop_share = 0.0;  // Of readings that are lost: nothing heard.

  // 16 beams of 30 deg all around, heard up to 25 deg off the normal. They
  // start in the middle, so that they overlap from there on: real transducers
  // on a ring do by their side lobes, which hear what is close.
  [[nodiscard]] static RangeSensorOptions SonarRing();
  // 360 rays all around.
  [[nodiscard]] static RangeSensorOptions Lidar();

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

class RangeSensor {
 public:
  // Throws as Check() does.
  RangeSensor(const RangeSensorOptions& options, std::uint64_t seed);

  // One range per beam, m, in [0, max_range].
  [[nodiscard]] std::vector<float> Measure(const Pose2& X_WR,
                                           const ObstacleMap& map,
                                           std::span<const Disc2> people);

 private:
  RangeSensorOptions options_;
  Random random_;
};

}  // namespace waymark
