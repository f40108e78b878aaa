// Pinhole camera with lens distortion.
#pragma once

#include "estimation/camera/lens_distortion.h"
#include "estimation/camera/projection_types.h"

#include <optional>

namespace waymark {

// pixel = (fx x' + cx, fy y' + cy), (x', y') = Distort(X / Z, Y / Z): OpenCV's
// model with five coefficients.
//
// Valid domain: Z > 0, and a radius of the undistorted point up to
// max_radius(), where the distortion has an inverse. Beyond: nullopt, either
// way.
class PerspectiveCamera {
 public:
  // Throws std::invalid_argument where a value is not finite or a focal length
  // is zero.
  explicit PerspectiveCamera(const Intrinsics& intrinsics,
                             const LensDistortion& distortion = {});

  // Of a point in C, any unit; z > 0.
  [[nodiscard]] std::optional<Projection> PixelFromRay(
      const Eigen::Vector3d& point_C) const;
  // The same formula beyond max_radius() too, as a minimiser's steps need it.
  [[nodiscard]] std::optional<Projection> ExtendedPixelFromRay(
      const Eigen::Vector3d& point_C) const;
  [[nodiscard]] std::optional<BackProjection> RayFromPixel(
      const Eigen::Vector2d& pixel) const;

  [[nodiscard]] const Intrinsics& intrinsics() const { return intrinsics_; }
  [[nodiscard]] const LensDistortion& distortion() const { return distortion_; }
  [[nodiscard]] double max_radius() const { return max_radius_; }

 private:
  [[nodiscard]] std::optional<Projection> Project(
      const Eigen::Vector3d& point_C, double max_radius) const;

  Intrinsics intrinsics_;
  LensDistortion distortion_;
  double max_radius_;
};

}  // namespace waymark
