#include "estimation/camera/fisheye_camera.h"

#include "estimation/camera/intrinsics_check.h"
#include "estimation/camera/polynomial_roots.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

// The direction of a ray this close to straight back is lost to rounding.
constexpr double kMaxAngle = kPi - 1e-6;

struct Distance {
  double value = 0.0;
  double slope = 1.0;
};

Distance DistanceAt(double angle, const FisheyeCamera::Coefficients& k) {
  const double s = angle * angle;
  return {angle * (1.0 + s * (k[0] + s * (k[1] + s * (k[2] + s * k[3])))),
          1.0 + s * (3.0 * k[0] +
                     s * (5.0 * k[1] + s * (7.0 * k[2] + s * 9.0 * k[3])))};
}

double MaxAngle(const FisheyeCamera::Coefficients& k) {
  const std::array slope{1.0, 3.0 * k[0], 5.0 * k[1], 7.0 * k[2], 9.0 * k[3]};
  const std::vector<double> roots =
      RootsBetween(slope, 0.0, kMaxAngle * kMaxAngle);  // By the square.
  return roots.empty() ? kMaxAngle : std::sqrt(roots.front());
}

}  // namespace

FisheyeCamera::FisheyeCamera(const Intrinsics& intrinsics,
                             const Coefficients& coefficients)
    : intrinsics_(intrinsics), coefficients_(coefficients) {
  RequireUsable(intrinsics);
  constexpr std::array kNames{"k1", "k2", "k3", "k4"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    RequireFinite(coefficients[i], kNames[i]);
  }
  max_angle_ = MaxAngle(coefficients);
}

std::optional<Projection> FisheyeCamera::PixelFromRay(
    const Eigen::Vector3d& point) const {
  return Project(point, max_angle_);
}

std::optional<Projection> FisheyeCamera::ExtendedPixelFromRay(
    const Eigen::Vector3d& point) const {
  return Project(point, kMaxAngle);
}

std::optional<Projection> FisheyeCamera::Project(const Eigen::Vector3d& point,
                                                 double max_angle) const {
  const double norm = point.norm();
  if (!(norm > 0.0) || !std::isfinite(norm)) return std::nullopt;
  const Eigen::Vector3d n = point / norm;
  const double r = n.head<2>().norm();
  const double angle = std::atan2(r, n.z());
  if (angle > max_angle) return std::nullopt;
  const Distance d = DistanceAt(angle, coefficients_);
  // On the axis d / r goes to 1 (r is the sine of the angle), and its change is
  // of second order: below this angle both are exact to rounding.
  constexpr double kOnAxis = 1e-8;
  Eigen::Vector2d plane = n.head<2>();
  Eigen::Matrix<double, 2, 3> d_n;
  if (r < kOnAxis) {
    d_n << 1.0, 0.0, -n.x(), 0.0, 1.0, -n.y();
  } else {
    const Eigen::Vector2d direction = n.head<2>() / r;
    plane = d.value * direction;
    // Along the radius the angle changes, across it the direction.
    const Eigen::Vector3d d_angle(
        direction.x() * n.z(), direction.y() * n.z(), -r);
    const Eigen::Vector2d across(-direction.y(), direction.x());
    d_n = d.slope * direction * d_angle.transpose();
    d_n.leftCols<2>() += d.value / r * across * across.transpose();
  }
  const Eigen::Vector2d focal(intrinsics_.fx, intrinsics_.fy);
  return Projection{focal.cwiseProduct(plane) +
                        Eigen::Vector2d(intrinsics_.cx, intrinsics_.cy),
                    focal.asDiagonal() * d_n / norm};
}

std::optional<BackProjection> FisheyeCamera::RayFromPixel(
    const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d plane((pixel.x() - intrinsics_.cx) / intrinsics_.fx,
                              (pixel.y() - intrinsics_.cy) / intrinsics_.fy);
  const double wanted = plane.norm();
  if (!(wanted <= DistanceAt(max_angle_, coefficients_).value)) {
    return std::nullopt;
  }
  // The distance grows with the angle: bisection brackets Newton's steps.
  double low = 0.0;
  double high = max_angle_;
  double angle = std::min(wanted, max_angle_);
  constexpr int kMaxSteps = 100;
  for (int i = 0; i < kMaxSteps; ++i) {
    const Distance d = DistanceAt(angle, coefficients_);
    (d.value > wanted ? high : low) = angle;
    double next = angle - (d.value - wanted) / d.slope;
    const bool is_newton = next >= low && next <= high;
    if (!is_newton) next = 0.5 * (low + high);
    const double step = next - angle;
    angle = next;
    // Newton's error after a step is about its square over the slope.
    if (is_newton && step * step <= 1e-17 * d.slope) break;
  }
  const double scale = wanted > 0.0 ? std::sin(angle) / wanted : 1.0;
  const Eigen::Vector3d ray =
      Eigen::Vector3d(scale * plane.x(), scale * plane.y(), std::cos(angle))
          .normalized();
  const auto forward = PixelFromRay(ray);
  if (!forward) return std::nullopt;
  return BackProjection{ray, InverseJacobian(forward->d_point)};
}

}  // namespace waymark
