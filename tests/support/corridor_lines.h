// Lines of a corridor as a pinhole camera on a robot sees them, exactly.
#pragma once

#include "estimation/base/random.h"
#include "estimation/corridor/corridor_types.h"
#include "estimation/corridor/corridor_view.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <vector>

namespace waymark {

// A straight piece in L.
struct Piece3 {
  Eigen::Vector3d a_L = Eigen::Vector3d::Zero();
  Eigen::Vector3d b_L = Eigen::Vector3d::Zero();
};

struct CorridorLinesOptions {
  double x_from = 1.0;  // Along the axis, from and to where edges are, in L.
  double x_to = 15.0;
  bool has_ceiling = true;
  bool has_skirting = false;
  // Other lines: lamps and tiles along the axis, frames across and upright.
  bool has_clutter = false;
  double noise_px = 0.0;   // Of each end, across the line.
  double sigma_px = 1e-3;  // As stated; of each end.
  std::uint64_t seed = 1;
};

// The camera of the simulator: 640 x 480, 70 degrees, 60 cm above the floor,
// looking downward by `tilt`.
[[nodiscard]] CorridorView ViewForTests(double tilt, double yaw = 0.0);

// By projecting points, not by any formula of estimation/corridor. What is
// behind the camera or beside the image is cut off.
[[nodiscard]] LineSet SeeCorridor(const CorridorView& view,
                                  const CorridorGeometry& corridor,
                                  const Pose2& X_LR,
                                  const CorridorLinesOptions& options);

}  // namespace waymark
