// Fisheye camera of Kannala and Brandt.
#pragma once

#include "estimation/camera/projection_types.h"

#include <array>
#include <optional>

namespace waymark {

// A ray at angle t from the optical axis is seen at the distance
//   d(t) = t + k1 t^3 + k2 t^5 + k3 t^7 + k4 t^9
// (times fx, fy) from the principal point, in the ray's own direction [1]:
// OpenCV's fisheye model.
//
// Valid domain: angles up to max_angle(), where d still grows, below pi (there
// the direction is not defined). Rays behind the camera are inside it where the
// lens sees that far.
//
// [1] J. Kannala, S. S. Brandt. A generic camera model and calibration method
//     for conventional, wide-angle, and fish-eye lenses. IEEE TPAMI 28(8),
//     2006.
class FisheyeCamera {
 public:
  using Coefficients = std::array<double, 4>;  // k1 to k4.

  // Throws std::invalid_argument where a value is not finite or a focal length
  // is zero.
  explicit FisheyeCamera(const Intrinsics& intrinsics,
                         const Coefficients& coefficients = {});

  // Of a point in C, any unit, not the origin.
  [[nodiscard]] std::optional<Projection> PixelFromRay(
      const Eigen::Vector3d& point_C) const;
  // The same formula beyond max_angle() too, up to pi, as a minimiser's steps
  // need it.
  [[nodiscard]] std::optional<Projection> ExtendedPixelFromRay(
      const Eigen::Vector3d& point_C) const;
  [[nodiscard]] std::optional<BackProjection> RayFromPixel(
      const Eigen::Vector2d& pixel) const;

  [[nodiscard]] const Intrinsics& intrinsics() const { return intrinsics_; }
  [[nodiscard]] const Coefficients& coefficients() const {
    return coefficients_;
  }
  [[nodiscard]] double max_angle() const { return max_angle_; }  // rad.

 private:
  [[nodiscard]] std::optional<Projection> Project(
      const Eigen::Vector3d& point_C, double max_angle) const;

  Intrinsics intrinsics_;
  Coefficients coefficients_;
  double max_angle_;
};

}  // namespace waymark
