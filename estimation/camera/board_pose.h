// Pose of a flat board from bearings.
#pragma once

#include <Eigen/Geometry>

#include <optional>
#include <span>

namespace waymark {

// Pose X_CB of a board whose points lie in its plane z = 0.
//
//   rays_C     N unit bearings.
//   points_B   N points (x, y) on the board, m; entry i is what ray i sees.
//
// Linear: n x (h1 x + h2 y + h3) = 0 gives the nine numbers of a homography,
// whose first two columns are made orthonormal [1]; exact for exact data, a
// start for refinement otherwise. Works for any camera with one viewpoint, also
// where the board is beside or behind it. Needs N >= 4.
//
// Returns nullopt where the points do not fix a pose (three of four on a line)
// or the result has points on the wrong side of their rays. Throws
// std::invalid_argument if the spans differ in length.
//
// [1] Z. Zhang. A flexible new technique for camera calibration. IEEE TPAMI
//     22(11), 2000, appendix.
[[nodiscard]] std::optional<Eigen::Isometry3d> BoardPoseFromRays(
    std::span<const Eigen::Vector3d> rays_C,
    std::span<const Eigen::Vector2d> points_B);

}  // namespace waymark
