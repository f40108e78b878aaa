// What every camera model gives for a ray and for a pixel.
//
// Camera frame C: x right, y down, z forward (of a mirror camera: z from the
// mirror to the lens). Pixels: x right, y down, the centre of the top-left
// pixel is (0, 0).
#pragma once

#include <Eigen/Core>

namespace waymark {

struct ImageSize {
  int width = 0;
  int height = 0;
  bool operator==(const ImageSize&) const = default;
};

// Focal lengths and principal point, px. A focal length is not zero; a negative
// one mirrors the image, as a mirror camera's lens does.
struct Intrinsics {
  double fx = 1.0;
  double fy = 1.0;
  double cx = 0.0;
  double cy = 0.0;
  bool operator==(const Intrinsics&) const = default;
};

struct Projection {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  // By the point in C that was projected. Its rows are orthogonal to the point:
  // the distance along the ray does not matter.
  Eigen::Matrix<double, 2, 3> d_point = Eigen::Matrix<double, 2, 3>::Zero();
};

struct BackProjection {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();  // Unit bearing n_C.
  Eigen::Matrix<double, 3, 2> d_pixel = Eigen::Matrix<double, 3, 2>::Zero();
};

// Derivative of a unit bearing by its pixel from that of the pixel by the
// bearing: the inverse on the plane at right angles to the bearing.
[[nodiscard]] Eigen::Matrix<double, 3, 2> InverseJacobian(
    const Eigen::Matrix<double, 2, 3>& d_point);

}  // namespace waymark
