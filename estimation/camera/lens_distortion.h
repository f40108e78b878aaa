// Brown's radial and tangential distortion of normalised image points.
#pragma once

#include <Eigen/Core>

#include <limits>
#include <optional>

namespace waymark {

// Of a point (x, y) at radius r, with OpenCV's names and signs [1]:
//   x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
//   y' = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y
// [1] D. C. Brown. Decentering distortion of lenses. Photogrammetric
//     Engineering 32(3), 444-462, 1966.
struct LensDistortion {
  double k1 = 0.0;
  double k2 = 0.0;
  double p1 = 0.0;
  double p2 = 0.0;
  double k3 = 0.0;
  bool operator==(const LensDistortion&) const = default;
};

// Radius (of the undistorted point) up to which the radial part grows, so that
// it has an inverse; infinite where it always does.
[[nodiscard]] double MaxRadius(const LensDistortion& distortion);

struct DistortedPoint {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  Eigen::Matrix2d d_point = Eigen::Matrix2d::Identity();
};
[[nodiscard]] DistortedPoint Distort(const LensDistortion& distortion,
                                     const Eigen::Vector2d& point);

// Derivative of the distorted point by k1, k2, p1, p2, k3; the same for all
// distortions.
[[nodiscard]] Eigen::Matrix<double, 2, 5> DistortedByCoefficients(
    const Eigen::Vector2d& point);

// The point within `max_radius` that is distorted to this one, to 1e-14 of its
// radius; nullopt where there is none. Newton's method, some four steps.
[[nodiscard]] std::optional<Eigen::Vector2d> Undistort(
    const LensDistortion& distortion,
    const Eigen::Vector2d& distorted,
    double max_radius);

}  // namespace waymark
