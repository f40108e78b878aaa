#include "estimation/camera/camera_model.h"

#include <type_traits>

namespace waymark {

std::optional<Projection> PixelFromRay(const CameraModel& camera,
                                       const Eigen::Vector3d& point_C) {
  return std::visit([&](const auto& c) { return c.PixelFromRay(point_C); },
                    camera);
}

std::optional<BackProjection> RayFromPixel(const CameraModel& camera,
                                           const Eigen::Vector2d& pixel) {
  return std::visit([&](const auto& c) { return c.RayFromPixel(pixel); },
                    camera);
}

std::optional<Projection> ExtendedPixelFromRay(const CameraModel& camera,
                                               const Eigen::Vector3d& point_C) {
  return std::visit(
      [&](const auto& c) -> std::optional<Projection> {
        if constexpr (std::is_same_v<std::decay_t<decltype(c)>,
                                     PanoramaCamera>) {
          return c.PixelFromRay(point_C);
        } else {
          return c.ExtendedPixelFromRay(point_C);
        }
      },
      camera);
}

bool IsInside(const ImageSize& size, const Eigen::Vector2d& pixel) {
  constexpr double kHalf = 0.5;  // Of a pixel.
  return pixel.x() >= -kHalf && pixel.x() <= size.width - kHalf &&
         pixel.y() >= -kHalf && pixel.y() <= size.height - kHalf;
}

}  // namespace waymark
