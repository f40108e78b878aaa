// Cylindrical panorama.
#pragma once

#include "estimation/camera/projection_types.h"

#include <optional>

namespace waymark {

// Columns are azimuths, rows tangents of elevation:
//   u = cx + fx atan2(X, Z), v = cy + fy Y / hypot(X, Z)
// fx and fy are px per radian at the horizon; a whole turn is 2 pi fx columns
// wide. The azimuth 0 (forward) is at cx, positive to the right.
//
// Valid domain: all rays but those along the axis (X = Z = 0). Of a pixel, the
// azimuth (u - cx) / fx in (-pi, pi]: columns beyond the whole turn are
// repetitions and have no ray.
class PanoramaCamera {
 public:
  // Throws std::invalid_argument where a value is not finite or a focal length
  // is zero.
  explicit PanoramaCamera(const Intrinsics& intrinsics);

  // One whole turn over `size.width` columns, square pixels at the horizon,
  // which is at row `horizon`; forward is in the middle. Throws
  // std::invalid_argument where the size is not positive.
  [[nodiscard]] static PanoramaCamera WholeTurn(const ImageSize& size,
                                                double horizon);

  // Of a point in C, any unit.
  [[nodiscard]] std::optional<Projection> PixelFromRay(
      const Eigen::Vector3d& point_C) const;
  [[nodiscard]] std::optional<BackProjection> RayFromPixel(
      const Eigen::Vector2d& pixel) const;

  [[nodiscard]] const Intrinsics& intrinsics() const { return intrinsics_; }

 private:
  Intrinsics intrinsics_;
};

}  // namespace waymark
