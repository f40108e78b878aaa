// Camera that looks into a hyperbolic mirror from the mirror's outer focus.
#pragma once

#include "estimation/camera/sphere_camera.h"

#include <optional>

namespace waymark {

// One sheet of the hyperboloid of revolution with semi-axes a and b (m). Its
// inner focus is the viewpoint, C's origin; the outer one, at z = 2 c with
// c = sqrt(a^2 + b^2), is the lens's. C's z points from the mirror to the lens.
struct HyperbolicMirror {
  double a = 0.0;
  double b = 0.0;

  // Throws std::invalid_argument where a or b is not positive and finite.
  void Check() const;

  [[nodiscard]] double focal_distance() const;  // c, m.
  [[nodiscard]] double eccentricity() const;    // c / a.

  // Where a ray from the viewpoint meets the mirror, m: |P| = b^2 / (a + c
  // n_z). `ray` is a unit bearing; nullopt where n_z <= -a / c, which misses
  // it.
  [[nodiscard]] std::optional<Eigen::Vector3d> PointOnMirror(
      const Eigen::Vector3d& ray) const;
  // Unit normal of the mirror at a point of it, on the side of the lens.
  [[nodiscard]] Eigen::Vector3d NormalAt(const Eigen::Vector3d& point) const;
};

// The same images as a sphere camera: with the eccentricity e = c / a,
// xi = 2 e / (1 + e^2), and focal lengths times (e^2 - 1) / (e^2 + 1) [1].
// `lens` is that of the camera that looks into the mirror, its x and y along
// C's: a lens that looks up at the mirror mirrors the image, one focal length
// is negative then. `distortion` acts on the sphere model's normalised points.
//
// [1] J. P. Barreto, H. Araujo. Issues on the geometry of central catadioptric
//     image formation. CVPR 2001.
[[nodiscard]] SphereCamera CameraFromMirror(
    const HyperbolicMirror& mirror,
    const Intrinsics& lens,
    const LensDistortion& distortion = {});

}  // namespace waymark
