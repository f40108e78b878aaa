// Walls for the simulated robot and its sensors, for tests.
#pragma once

#include "drivers/simulator/obstacle_map.h"

#include <Eigen/Core>

#include <vector>

namespace waymark {

// `inside`, and the four walls round it: south, east, north, west.
inline std::vector<Segment2> RectangleWalls(const Eigen::Vector2d& low,
                                            const Eigen::Vector2d& high,
                                            std::vector<Segment2> inside = {}) {
  const Eigen::Vector2d south_east(high.x(), low.y());
  const Eigen::Vector2d north_west(low.x(), high.y());
  inside.push_back({low, south_east});
  inside.push_back({south_east, high});
  inside.push_back({high, north_west});
  inside.push_back({north_west, low});
  return inside;
}

}  // namespace waymark
