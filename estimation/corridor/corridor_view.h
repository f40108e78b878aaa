// A pinhole view of a corridor from a robot: which pixels mean what.
#pragma once

#include "estimation/camera/projection_types.h"
#include "estimation/corridor/corridor_types.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>

namespace waymark {

// The mounting may be any; the floor is R's plane z = 0.
struct CorridorView {
  Intrinsics intrinsics;  // Of pixels without distortion.
  ImageSize size;
  Eigen::Isometry3d X_RC = Eigen::Isometry3d::Identity();

  // Homogeneous pixel of a direction in R; the third component is positive in
  // front of the camera.
  [[nodiscard]] Eigen::Vector3d PixelOf(
      const Eigen::Vector3d& direction_R) const;
  // Direction in R of a pixel's ray, not normalised.
  [[nodiscard]] Eigen::Vector3d RayOf(const Eigen::Vector2d& pixel) const;
};

// A straight edge of the image, as its errors are stated.
struct SeenLine {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();      // px.
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  // Unit.
  double length = 0.0;                                   // px.
  double sigma_px = 0.5;    // Of the offset at the middle.
  double sigma_rad = 0.01;  // Of the direction.
};
// `model_px`, `model_rad`: what straight edges of real walls are off by, added
// to the line's own errors.
[[nodiscard]] SeenLine SeenLineOf(const LineSegment& segment,
                                  double model_px,
                                  double model_rad);

// Direction of the axis of L in R, and of what lies across it to the left, for
// a robot whose heading in L is `heading`.
[[nodiscard]] Eigen::Vector3d AxisIn(double heading);
[[nodiscard]] Eigen::Vector3d AcrossIn(double heading);

// How far a line misses the point where a direction vanishes, in sigmas: sine
// of the angle between the line and the way from its middle to the point, by
// what offset and direction leave open. Finite also for a point at infinity.
[[nodiscard]] double VanishingResidual(const SeenLine& line,
                                       const Eigen::Vector3d& vanishing_pixel);

// The heading at which `direction` in L (unit, horizontal: 0 the axis, pi / 2
// across) vanishes on the line, modulo pi, and its sigma; nullopt where no
// heading or every one does that.
struct LineHeading {
  double heading = 0.0;  // In (-pi / 2, pi / 2].
  double sigma = 0.0;
};
[[nodiscard]] std::optional<LineHeading> HeadingOfLine(const CorridorView& view,
                                                       const SeenLine& line,
                                                       double direction_L);

// Where an edge of the corridor is in its cross-section (y, z), m. nullopt
// where that is not known.
[[nodiscard]] std::optional<Eigen::Vector2d> PlaceOf(
    CorridorEdge edge, const CorridorGeometry& corridor);

// Image of an edge for a robot at y with that heading: l^T (u, v, 1) = 0 with
// a unit normal; nullopt where the camera looks along no line of it (it lies
// on the edge).
[[nodiscard]] std::optional<Eigen::Vector3d> ImageOfEdge(
    const CorridorView& view,
    const Eigen::Vector2d& place,
    double y,
    double heading);

// A pixel's ray in that cross-section, (left, up) as seen along the axis; not
// normalised.
[[nodiscard]] Eigen::Vector2d RayAcross(const CorridorView& view,
                                        const Eigen::Vector2d& pixel,
                                        double heading);

// The camera's centre in the cross-section (y, z) of L for a robot there.
[[nodiscard]] Eigen::Vector2d CameraIn(const CorridorView& view,
                                       double y,
                                       double heading);

}  // namespace waymark
