#include "estimation/camera/hyperbolic_mirror.h"

#include <cmath>
#include <stdexcept>

namespace waymark {

void HyperbolicMirror::Check() const {
  if (!(a > 0.0) || !std::isfinite(a)) {
    throw std::invalid_argument("a is not a positive length");
  }
  if (!(b > 0.0) || !std::isfinite(b)) {
    throw std::invalid_argument("b is not a positive length");
  }
}

double HyperbolicMirror::focal_distance() const {
  return std::hypot(a, b);
}

double HyperbolicMirror::eccentricity() const {
  return focal_distance() / a;
}

std::optional<Eigen::Vector3d> HyperbolicMirror::PointOnMirror(
    const Eigen::Vector3d& ray) const {
  // |P - lens| - |P| = 2 a, squared: |P| (a + c n_z) = c^2 - a^2 = b^2.
  const double below = a + focal_distance() * ray.z();
  if (!(below > 0.0)) return std::nullopt;
  return b * b / below * ray;
}

Eigen::Vector3d HyperbolicMirror::NormalAt(const Eigen::Vector3d& point) const {
  // The gradient of |P - lens| - |P| points away from the lens's side.
  const Eigen::Vector3d lens(0.0, 0.0, 2.0 * focal_distance());
  return (point.normalized() - (point - lens).normalized()).normalized();
}

SphereCamera CameraFromMirror(const HyperbolicMirror& mirror,
                              const Intrinsics& lens,
                              const LensDistortion& distortion) {
  mirror.Check();
  const double e = mirror.eccentricity();
  const double scale = (e * e - 1.0) / (e * e + 1.0);
  return SphereCamera(2.0 * e / (1.0 + e * e),
                      {scale * lens.fx, scale * lens.fy, lens.cx, lens.cy},
                      distortion);
}

}  // namespace waymark
