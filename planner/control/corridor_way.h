// Way-points along a corridor, as the tasks there drive them.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace waymark {

struct CorridorWayOptions {
  double begin = 2.0;         // Along the axis, where the way begins, m,
  double length = 10.0;       // how far it goes,
  std::int64_t num_legs = 4;  // and how often: two complete turns.
  double zigzag = 0.0;        // To both sides of the axis, m; 0: straight on.
  double zigzag_step = 2.0;   // Along it, m.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// To and fro in the corridor's frame L (x along its axis, y to the left wall),
// from `begin` on, which is no way-point of its own at first. A zig-zag begins
// to the left; each leg ends on the axis.
[[nodiscard]] std::vector<Eigen::Vector2d> CorridorWay(
    const CorridorWayOptions& options);

}  // namespace waymark
