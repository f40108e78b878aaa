#include "estimation/camera/sphere_camera.h"

#include "estimation/camera/intrinsics_check.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace waymark {

SphereCamera::SphereCamera(double xi,
                           const Intrinsics& intrinsics,
                           const LensDistortion& distortion)
    : xi_(xi),
      intrinsics_(intrinsics),
      distortion_(distortion),
      max_radius_(MaxRadius(distortion)),
      min_z_(xi > 1.0 ? -1.0 / xi : -xi) {
  RequireFinite(xi, "xi");
  if (xi < 0.0) throw std::invalid_argument("xi is negative");
  RequireUsable(intrinsics);
  RequireUsable(distortion);
}

std::optional<Projection> SphereCamera::PixelFromRay(
    const Eigen::Vector3d& point) const {
  return Project(point, max_radius_);
}

std::optional<Projection> SphereCamera::ExtendedPixelFromRay(
    const Eigen::Vector3d& point) const {
  return Project(point, std::numeric_limits<double>::infinity());
}

std::optional<Projection> SphereCamera::Project(const Eigen::Vector3d& point,
                                                double max_radius) const {
  const double norm = point.norm();
  if (!(norm > 0.0) || !std::isfinite(norm)) return std::nullopt;
  const Eigen::Vector3d n = point / norm;
  if (!(n.z() > min_z_)) return std::nullopt;
  const double inverse = 1.0 / (n.z() + xi_);
  const Eigen::Vector2d plane = inverse * n.head<2>();
  if (!plane.allFinite() || plane.norm() > max_radius) return std::nullopt;
  const DistortedPoint bent = Distort(distortion_, plane);
  Eigen::Matrix<double, 2, 3> d_n;
  d_n << inverse, 0.0, -inverse * plane.x(), 0.0, inverse, -inverse * plane.y();
  const Eigen::Matrix3d d_point =
      (Eigen::Matrix3d::Identity() - n * n.transpose()) / norm;
  const Eigen::Vector2d focal(intrinsics_.fx, intrinsics_.fy);
  return Projection{focal.cwiseProduct(bent.point) +
                        Eigen::Vector2d(intrinsics_.cx, intrinsics_.cy),
                    focal.asDiagonal() * bent.d_point * d_n * d_point};
}

std::optional<BackProjection> SphereCamera::RayFromPixel(
    const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d bent((pixel.x() - intrinsics_.cx) / intrinsics_.fx,
                             (pixel.y() - intrinsics_.cy) / intrinsics_.fy);
  const auto plane = Undistort(distortion_, bent, max_radius_);
  if (!plane) return std::nullopt;
  // Where the line from (0, 0, -xi) through (m, 1 - xi) meets the sphere.
  const double square = plane->squaredNorm();
  const double root = 1.0 + (1.0 - xi_ * xi_) * square;
  if (!(root >= 0.0)) return std::nullopt;
  const double eta = (xi_ + std::sqrt(root)) / (square + 1.0);
  const Eigen::Vector3d ray =
      Eigen::Vector3d(eta * plane->x(), eta * plane->y(), eta - xi_)
          .normalized();
  const auto forward = PixelFromRay(ray);
  if (!forward) return std::nullopt;
  return BackProjection{ray, InverseJacobian(forward->d_point)};
}

}  // namespace waymark
