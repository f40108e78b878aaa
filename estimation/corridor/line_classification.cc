#include "estimation/corridor/line_classification.h"

#include <cmath>
#include <stdexcept>

namespace waymark {

void LineClassificationOptions::Check() const {
  if (!(max_sigmas > 0.0)) {
    throw std::invalid_argument("max_sigmas: must be positive");
  }
  if (!(vanishing_rad >= 0.0 && vanishing_rad <= 0.5)) {
    throw std::invalid_argument("vanishing_rad: in [0, 0.5]");
  }
}

CorridorEdge ClassifyLine(const CorridorView& view,
                          const SeenLine& line,
                          double heading,
                          const LineClassificationOptions& options) {
  const Eigen::Vector3d vanishing = view.PixelOf(AxisIn(heading));
  // The line itself, once more with what the point is off by: a turn of a unit
  // direction moves its homogeneous pixel by as many focal lengths.
  const Eigen::Vector2d way = vanishing.head<2>() - vanishing.z() * line.middle;
  const double of_line =
      std::hypot(line.sigma_px * vanishing.z(), line.sigma_rad * way.norm());
  const double of_point = options.vanishing_rad * view.intrinsics.fx;
  const double miss = std::abs(VanishingResidual(line, vanishing)) * of_line;
  if (!(miss <= options.max_sigmas * std::hypot(of_line, of_point))) {
    return CorridorEdge::kNone;
  }
  const Eigen::Vector3d ray_R = view.RayOf(line.middle);
  const double left = ray_R.dot(AcrossIn(heading));
  const double up = ray_R.z();
  if (left == 0.0 || up == 0.0) return CorridorEdge::kAlong;
  if (up < 0.0) {
    return left > 0.0 ? CorridorEdge::kFloorLeft : CorridorEdge::kFloorRight;
  }
  return left > 0.0 ? CorridorEdge::kCeilingLeft : CorridorEdge::kCeilingRight;
}

}  // namespace waymark
