#include "estimation/camera/board_pose.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <cmath>
#include <stdexcept>

namespace waymark {

std::optional<Eigen::Isometry3d> BoardPoseFromRays(
    std::span<const Eigen::Vector3d> rays,
    std::span<const Eigen::Vector2d> points) {
  if (rays.size() != points.size()) {
    throw std::invalid_argument("as many rays as points are needed");
  }
  if (rays.size() < 4) return std::nullopt;
  // About their middle and of unit size the points condition the problem best.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) middle += point;
  middle /= static_cast<double>(points.size());
  double size = 0.0;
  for (const Eigen::Vector2d& point : points) {
    size += (point - middle).squaredNorm();
  }
  size = std::sqrt(size / static_cast<double>(points.size()));
  if (!(size > 0.0)) return std::nullopt;

  using Matrix9 = Eigen::Matrix<double, 9, 9>;
  Matrix9 normal = Matrix9::Zero();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d& n = rays[i];
    const Eigen::Vector2d p = (points[i] - middle) / size;
    Eigen::Matrix3d cross;
    cross << 0.0, -n.z(), n.y(), n.z(), 0.0, -n.x(), -n.y(), n.x(), 0.0;
    Eigen::Matrix<double, 3, 9> rows;
    rows << p.x() * cross, p.y() * cross, cross;
    normal += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix9> solver(normal);
  const auto& values = solver.eigenvalues();
  // Squares of singular values: where the second is this small too, what
  // separates the solution from another is rounding.
  constexpr double kRankTolerance = 1e-12;
  if (solver.info() != Eigen::Success ||
      !(values(1) > kRankTolerance * values(8))) {
    return std::nullopt;
  }
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  Eigen::Matrix3d H = Eigen::Map<const Eigen::Matrix3d>(h.data());
  double side = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector2d p = (points[i] - middle) / size;
    side += rays[i].dot(H.col(0) * p.x() + H.col(1) * p.y() + H.col(2));
  }
  if (side < 0.0) H = -H;
  H.leftCols<2>() /= size;
  const double scale = 0.5 * (H.col(0).norm() + H.col(1).norm());
  if (!(scale > 0.0)) return std::nullopt;
  H /= scale;
  Eigen::Matrix3d R;
  R << H.col(0), H.col(1), H.col(0).cross(H.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(
      R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
  X_CB.linear() = svd.matrixU() * svd.matrixV().transpose();
  if (X_CB.linear().determinant() < 0.0) return std::nullopt;
  X_CB.translation() = H.col(2) - X_CB.linear().leftCols<2>() * middle;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d point(points[i].x(), points[i].y(), 0.0);
    if (!(rays[i].dot(X_CB * point) > 0.0)) return std::nullopt;
  }
  return X_CB;
}

}  // namespace waymark
