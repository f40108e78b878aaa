// What an image line says about the direction of its edge in space.
#pragma once

#include "estimation/lines/line_types.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace waymark {

// A camera without distortion, px: x = fx X / Z + cx, y = fy Y / Z + cy.
struct PinholeView {
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// An edge along n_C vanishes where n_C's ray meets the image; the line must
// pass through that point. Both forms are linear in n_C, so that points at
// infinity are like any other, and n_C and -n_C are the same.
struct LineDirection {
  Eigen::Vector3d across_C;  // across_C' n_C / n_z: px from the point across
  Eigen::Vector3d along_C;   // the line, and along it from its middle.
  double sigma_px = 0.0;
  double sigma_rad = 0.0;

  // Of the distance across, times n_z as that itself is.
  [[nodiscard]] double Sigma(const Eigen::Vector3d& n_C) const;
  // In sigmas, with a sign.
  [[nodiscard]] double Residual(const Eigen::Vector3d& n_C) const;
  // Unit normal of the plane through the camera and the edge.
  [[nodiscard]] Eigen::Vector3d Normal() const { return across_C.normalized(); }
};

// What is known of a direction in C before lines are seen.
struct DirectionPrior {
  Eigen::Vector3d n_C = Eigen::Vector3d::UnitZ();  // Unit.
  double sigma_rad = 0.1;  // 1 sigma about any axis across it.
};

// One for each line. Throws std::logic_error if an end is not finite, both
// ends are one, or a sigma is not positive.
[[nodiscard]] std::vector<LineDirection> LineDirections(
    std::span<const LineSegment> lines, const PinholeView& view);

}  // namespace waymark
