// Unified sphere model of mirror cameras with a single viewpoint.
#pragma once

#include "estimation/camera/lens_distortion.h"
#include "estimation/camera/projection_types.h"

#include <optional>

namespace waymark {

// A point is projected onto the unit sphere about the viewpoint, n, and from
// (0, 0, -xi) onto a plane: m = (n_x, n_y) / (n_z + xi), then distorted and
// scaled like a perspective camera's [1, 2]: OpenCV's omnidir model without
// skew. xi 0 is a perspective camera, 1 a parabolic mirror, between them
// hyperbolic ones; above 1 wide lenses.
//
// Valid domain: n_z > -min(xi, 1 / xi), where the projection has an inverse
// (xi 0: n_z > 0), and |m| up to the distortion's largest radius.
//
// [1] C. Geyer, K. Daniilidis. A unifying theory for central panoramic systems
//     and practical implications. ECCV 2000.
// [2] C. Mei, P. Rives. Single view point omnidirectional camera calibration
//     from planar grids. ICRA 2007.
class SphereCamera {
 public:
  // Throws std::invalid_argument where a value is not finite, xi is negative or
  // a focal length is zero.
  SphereCamera(double xi,
               const Intrinsics& intrinsics,
               const LensDistortion& distortion = {});

  // Of a point in C, any unit, not the origin.
  [[nodiscard]] std::optional<Projection> PixelFromRay(
      const Eigen::Vector3d& point_C) const;
  // The same formula also where the distortion has no inverse, as a minimiser's
  // steps need it.
  [[nodiscard]] std::optional<Projection> ExtendedPixelFromRay(
      const Eigen::Vector3d& point_C) const;
  [[nodiscard]] std::optional<BackProjection> RayFromPixel(
      const Eigen::Vector2d& pixel) const;

  [[nodiscard]] double xi() const { return xi_; }
  [[nodiscard]] const Intrinsics& intrinsics() const { return intrinsics_; }
  [[nodiscard]] const LensDistortion& distortion() const { return distortion_; }
  // Least n_z of a ray that is seen.
  [[nodiscard]] double min_z() const { return min_z_; }

 private:
  [[nodiscard]] std::optional<Projection> Project(
      const Eigen::Vector3d& point_C, double max_radius) const;

  double xi_;
  Intrinsics intrinsics_;
  LensDistortion distortion_;
  double max_radius_;
  double min_z_;
};

}  // namespace waymark
