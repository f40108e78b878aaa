#include "estimation/camera/perspective_camera.h"

#include "estimation/camera/intrinsics_check.h"

#include <cmath>
#include <limits>

namespace waymark {

PerspectiveCamera::PerspectiveCamera(const Intrinsics& intrinsics,
                                     const LensDistortion& distortion)
    : intrinsics_(intrinsics),
      distortion_(distortion),
      max_radius_(MaxRadius(distortion)) {
  RequireUsable(intrinsics);
  RequireUsable(distortion);
}

std::optional<Projection> PerspectiveCamera::PixelFromRay(
    const Eigen::Vector3d& point) const {
  return Project(point, max_radius_);
}

std::optional<Projection> PerspectiveCamera::ExtendedPixelFromRay(
    const Eigen::Vector3d& point) const {
  return Project(point, std::numeric_limits<double>::infinity());
}

std::optional<Projection> PerspectiveCamera::Project(
    const Eigen::Vector3d& point, double max_radius) const {
  if (!(point.z() > 0.0) || !std::isfinite(point.z())) return std::nullopt;
  const double inverse = 1.0 / point.z();
  const Eigen::Vector2d plane = inverse * point.head<2>();
  if (!plane.allFinite() || plane.norm() > max_radius) return std::nullopt;
  const DistortedPoint bent = Distort(distortion_, plane);
  const Eigen::Vector2d focal(intrinsics_.fx, intrinsics_.fy);
  Eigen::Matrix<double, 2, 3> d_plane;
  d_plane << inverse, 0.0, -inverse * plane.x(), 0.0, inverse,
      -inverse * plane.y();
  return Projection{focal.cwiseProduct(bent.point) +
                        Eigen::Vector2d(intrinsics_.cx, intrinsics_.cy),
                    focal.asDiagonal() * bent.d_point * d_plane};
}

std::optional<BackProjection> PerspectiveCamera::RayFromPixel(
    const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d bent((pixel.x() - intrinsics_.cx) / intrinsics_.fx,
                             (pixel.y() - intrinsics_.cy) / intrinsics_.fy);
  const auto plane = Undistort(distortion_, bent, max_radius_);
  if (!plane) return std::nullopt;
  const Eigen::Vector3d ray =
      Eigen::Vector3d(plane->x(), plane->y(), 1.0).normalized();
  const auto forward = PixelFromRay(ray);
  if (!forward) return std::nullopt;
  return BackProjection{ray, InverseJacobian(forward->d_point)};
}

}  // namespace waymark
