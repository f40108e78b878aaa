#include "estimation/camera/lens_distortion.h"

#include "estimation/camera/polynomial_roots.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

namespace waymark {

double MaxRadius(const LensDistortion& d) {
  // d/dr of r (1 + k1 r^2 + k2 r^4 + k3 r^6), by s = r^2. No lens sees beyond a
  // radius of 100 (89.4 degrees).
  constexpr double kMaxSquare = 1e4;
  const std::array slope{1.0, 3.0 * d.k1, 5.0 * d.k2, 7.0 * d.k3};
  const std::vector<double> roots = RootsBetween(slope, 0.0, kMaxSquare);
  return roots.empty() ? std::numeric_limits<double>::infinity()
                       : std::sqrt(roots.front());
}

DistortedPoint Distort(const LensDistortion& d, const Eigen::Vector2d& point) {
  const double x = point.x();
  const double y = point.y();
  const double s = x * x + y * y;
  const double radial = 1.0 + s * (d.k1 + s * (d.k2 + s * d.k3));
  const double slope = d.k1 + s * (2.0 * d.k2 + s * 3.0 * d.k3);  // By s.
  DistortedPoint result;
  result.point << x * radial + 2.0 * d.p1 * x * y + d.p2 * (s + 2.0 * x * x),
      y * radial + d.p1 * (s + 2.0 * y * y) + 2.0 * d.p2 * x * y;
  const double cross = 2.0 * x * y * slope + 2.0 * d.p1 * x + 2.0 * d.p2 * y;
  result.d_point << radial + 2.0 * x * x * slope + 2.0 * d.p1 * y +
                        6.0 * d.p2 * x,
      cross, cross,
      radial + 2.0 * y * y * slope + 6.0 * d.p1 * y + 2.0 * d.p2 * x;
  return result;
}

Eigen::Matrix<double, 2, 5> DistortedByCoefficients(
    const Eigen::Vector2d& point) {
  const double x = point.x();
  const double y = point.y();
  const double s = x * x + y * y;
  Eigen::Matrix<double, 2, 5> d;
  d << x * s, x * s * s, 2.0 * x * y, s + 2.0 * x * x, x * s * s * s,  //
      y * s, y * s * s, s + 2.0 * y * y, 2.0 * x * y, y * s * s * s;
  return d;
}

std::optional<Eigen::Vector2d> Undistort(const LensDistortion& distortion,
                                         const Eigen::Vector2d& distorted,
                                         double max_radius) {
  if (distortion == LensDistortion{}) return distorted;
  if (!distorted.allFinite()) return std::nullopt;
  // From inside, where the slope only falls toward the edge, Newton's steps
  // cannot leap over it for good: those that do are cut.
  const double edge = std::min(max_radius, 1e3);
  const auto inside = [&](const Eigen::Vector2d& point) {
    const double radius = point.norm();
    return radius <= edge ? point : (point * (edge / radius)).eval();
  };
  Eigen::Vector2d point = inside(distorted);
  constexpr int kMaxSteps = 50;  // Near the edge each step gains one bit.
  for (int step = 0; step < kMaxSteps; ++step) {
    const DistortedPoint now = Distort(distortion, point);
    const Eigen::Vector2d error = now.point - distorted;
    if (error.norm() <= 1e-14 * (1.0 + distorted.norm())) return point;
    const double determinant = now.d_point.determinant();
    if (!(std::abs(determinant) > 0.0)) return std::nullopt;
    const Eigen::Vector2d next = inside(point - now.d_point.inverse() * error);
    if (next == point) break;
    point = next;
  }
  // What rounding leaves where the slope is nearly zero.
  const double left = (Distort(distortion, point).point - distorted).norm();
  if (left <= 1e-12 * (1.0 + distorted.norm())) return point;
  return std::nullopt;
}

}  // namespace waymark
