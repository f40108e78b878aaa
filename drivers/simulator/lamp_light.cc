#include "drivers/simulator/lamp_light.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace waymark {
namespace {

using Eigen::Vector3d;

// A rectangle cut by one plane has up to five corners.
struct Polygon {
  std::array<Vector3d, 5> corners;
  int size = 0;
};

// The part of the lamp above the horizon, seen from the point.
Polygon VisiblePart(const SceneLamp& lamp,
                    const Vector3d& p_W,
                    const Vector3d& n_W) {
  const double half_x = 0.5 * lamp.size.x();
  const double half_y = 0.5 * lamp.size.y();
  // Counterclockwise seen from above: then the cross products of neighbours
  // point up, and the sum is positive.
  const std::array<Vector3d, 4> corners = {
      lamp.p_W + Vector3d(-half_x, -half_y, 0.0) - p_W,
      lamp.p_W + Vector3d(half_x, -half_y, 0.0) - p_W,
      lamp.p_W + Vector3d(half_x, half_y, 0.0) - p_W,
      lamp.p_W + Vector3d(-half_x, half_y, 0.0) - p_W};
  Polygon part;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d& a = corners[i];
    const Vector3d& b = corners[(i + 1) % 4];
    const double height_a = n_W.dot(a);
    const double height_b = n_W.dot(b);
    if (height_a > 0.0 && part.size < 5) part.corners[part.size++] = a;
    if ((height_a > 0.0) != (height_b > 0.0) && part.size < 5) {
      part.corners[part.size++] =
          a + height_a / (height_a - height_b) * (b - a);
    }
  }
  return part;
}

}  // namespace

double LampIrradiance(const SceneLamp& lamp,
                      const Vector3d& p_W,
                      const Vector3d& n_W) {
  if (p_W.z() >= lamp.p_W.z()) return 0.0;
  const Polygon part = VisiblePart(lamp, p_W, n_W);
  double sum = 0.0;
  for (int i = 0; i < part.size; ++i) {
    const Vector3d& a = part.corners[static_cast<std::size_t>(i)];
    const Vector3d& b =
        part.corners[static_cast<std::size_t>((i + 1) % part.size)];
    const Vector3d across = a.cross(b);
    const double length = across.norm();
    // Two corners in one direction span no angle.
    if (!(length > 0.0)) continue;
    sum += std::atan2(length, a.dot(b)) * n_W.dot(across) / length;
  }
  return std::max(0.0, 0.5 * sum);
}

}  // namespace waymark
