#include "estimation/camera/panorama_camera.h"

#include "estimation/camera/intrinsics_check.h"
#include "estimation/geometry/angle.h"

#include <cmath>
#include <stdexcept>

namespace waymark {

PanoramaCamera::PanoramaCamera(const Intrinsics& intrinsics)
    : intrinsics_(intrinsics) {
  RequireUsable(intrinsics);
}

PanoramaCamera PanoramaCamera::WholeTurn(const ImageSize& size,
                                         double horizon) {
  if (size.width <= 0 || size.height <= 0) {
    throw std::invalid_argument("a panorama's size is not positive");
  }
  const double focal = size.width / (2.0 * kPi);
  // Pixel centres: columns lie evenly about forward.
  return PanoramaCamera({focal, focal, 0.5 * (size.width - 1), horizon});
}

std::optional<Projection> PanoramaCamera::PixelFromRay(
    const Eigen::Vector3d& point) const {
  const double x = point.x();
  const double y = point.y();
  const double z = point.z();
  const double square = x * x + z * z;
  if (!point.allFinite() || !(square > 0.0)) return std::nullopt;
  const double r = std::sqrt(square);
  if (!std::isfinite(y / r)) return std::nullopt;
  Projection result;
  result.pixel << intrinsics_.cx + intrinsics_.fx * std::atan2(x, z),
      intrinsics_.cy + intrinsics_.fy * y / r;
  result.d_point << intrinsics_.fx * z / square, 0.0,
      -intrinsics_.fx * x / square,  //
      -intrinsics_.fy * x * y / (square * r), intrinsics_.fy / r,
      -intrinsics_.fy * z * y / (square * r);
  return result;
}

std::optional<BackProjection> PanoramaCamera::RayFromPixel(
    const Eigen::Vector2d& pixel) const {
  if (!pixel.allFinite()) return std::nullopt;
  const double azimuth = (pixel.x() - intrinsics_.cx) / intrinsics_.fx;
  if (!(azimuth > -kPi && azimuth <= kPi)) return std::nullopt;
  const double tangent = (pixel.y() - intrinsics_.cy) / intrinsics_.fy;
  const Eigen::Vector3d ray =
      Eigen::Vector3d(std::sin(azimuth), tangent, std::cos(azimuth))
          .normalized();
  const auto forward = PixelFromRay(ray);
  if (!forward) return std::nullopt;
  return BackProjection{ray, InverseJacobian(forward->d_point)};
}

}  // namespace waymark
