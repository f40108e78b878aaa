#include "estimation/lines/vanishing_point.h"

#include "estimation/base/check.h"
#include "estimation/lines/furthest_removal.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Two unit vectors that make a right-handed basis with n.
Eigen::Matrix<double, 3, 2> AcrossOf(const Vector3d& n) {
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = n.unitOrthogonal();
  across.col(1) = n.cross(across.col(0));
  return across;
}

// Where two lines meet in the plane across the prior, and who they are.
struct Crossing {
  int i;
  int j;
};

// Line as g' p = c in that plane, g unit.
struct PlaneLine {
  Vector2d g;
  double c;
  double scale;  // From pixels times n_z to distance across, in that plane.
};

class Crossings {
 public:
  Crossings(const std::vector<LineDirection>& lines,
            const DirectionPrior& prior,
            const VanishingPointOptions& options)
      : lines_(lines), n_C_(prior.n_C.normalized()), across_C_(AcrossOf(n_C_)) {
    plane_lines_.reserve(lines.size());
    for (const LineDirection& line : lines) {
      const Vector2d g = across_C_.transpose() * line.across_C;
      const double norm = g.norm();
      // A line in the plane across the prior has norm 0: it never crosses.
      plane_lines_.push_back(
          norm > 0.0
              ? PlaneLine{g / norm, -line.across_C.dot(n_C_) / norm, 1.0 / norm}
              : PlaneLine{Vector2d::Zero(), 0.0, 0.0});
    }
    const double gate =
        std::tan(std::min(options.gate_sigmas * prior.sigma_rad, kWidestGate));
    for (int i = 0; i < static_cast<int>(lines.size()); ++i) {
      for (int j = i + 1; j < static_cast<int>(lines.size()); ++j) {
        TryPair(i, j, gate, options.min_angle_rad);
      }
    }
  }

  [[nodiscard]] const std::vector<Vector2d>& points() const { return points_; }
  [[nodiscard]] const Eigen::Matrix<double, 3, 2>& across_C() const {
    return across_C_;
  }
  [[nodiscard]] Vector3d DirectionOf(const Vector2d& p) const {
    return (n_C_ + across_C_ * p).normalized();
  }

  // Of the mean of `kept`. To first order it is linear in the offsets of the
  // lines, each of which moves all its own crossings.
  [[nodiscard]] Matrix2d Covariance(const std::vector<int>& kept,
                                    const Vector2d& centre) const {
    std::vector<Vector2d> moved(lines_.size(), Vector2d::Zero());
    for (const int k : kept) {
      const Crossing& pair = pairs_[static_cast<std::size_t>(k)];
      const auto i = static_cast<std::size_t>(pair.i);
      const auto j = static_cast<std::size_t>(pair.j);
      Matrix2d m;
      m.row(0) = plane_lines_[i].g.transpose();
      m.row(1) = plane_lines_[j].g.transpose();
      const Matrix2d inverse = m.inverse();
      moved[i] += inverse.col(0) / static_cast<double>(kept.size());
      moved[j] += inverse.col(1) / static_cast<double>(kept.size());
    }
    Matrix2d covariance = Matrix2d::Zero();
    const Vector3d at = n_C_ + across_C_ * centre;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const double sigma = lines_[i].Sigma(at) * plane_lines_[i].scale;
      covariance += sigma * sigma * moved[i] * moved[i].transpose();
    }
    return covariance;
  }

 private:
  // Of the plane across the prior no more than this is used: 80 degrees.
  static constexpr double kWidestGate = 1.4;

  void TryPair(int i, int j, double gate, double min_angle) {
    const LineDirection& a = lines_[static_cast<std::size_t>(i)];
    const LineDirection& b = lines_[static_cast<std::size_t>(j)];
    const double sine = a.Normal().cross(b.Normal()).norm();
    if (sine <
        std::max(min_angle, 3.0 * std::hypot(a.sigma_rad, b.sigma_rad))) {
      return;
    }
    const PlaneLine& k = plane_lines_[static_cast<std::size_t>(i)];
    const PlaneLine& l = plane_lines_[static_cast<std::size_t>(j)];
    const double det = k.g.x() * l.g.y() - k.g.y() * l.g.x();
    const Vector2d scaled(k.c * l.g.y() - l.c * k.g.y(),
                          l.c * k.g.x() - k.c * l.g.x());
    if (!(scaled.norm() <= gate * std::abs(det)) || det == 0.0) return;
    points_.push_back(scaled / det);
    pairs_.push_back({i, j});
  }

  const std::vector<LineDirection>& lines_;
  Vector3d n_C_;
  Eigen::Matrix<double, 3, 2> across_C_;
  std::vector<PlaneLine> plane_lines_;
  std::vector<Vector2d> points_;
  std::vector<Crossing> pairs_;
};

}  // namespace

void VanishingPointOptions::Check() const {
  if (!(gate_sigmas > 0.0) || !(gate_sigmas <= 100.0)) {
    throw std::invalid_argument("gate_sigmas must be in (0, 100]");
  }
  if (num_kept < 1) throw std::invalid_argument("num_kept: at least 1");
  if (!(min_angle_rad > 0.0) || !(min_angle_rad <= 1.0)) {
    throw std::invalid_argument("min_angle_rad must be in (0, 1]");
  }
  if (!(support_sigmas > 0.0)) {
    throw std::invalid_argument("support_sigmas must be positive");
  }
}

std::optional<VanishingPoint> FindVanishingPoint(
    std::span<const LineSegment> lines,
    const PinholeView& view,
    const DirectionPrior& prior,
    const VanishingPointOptions& options) {
  options.Check();
  if (!(prior.sigma_rad > 0.0) || !(prior.sigma_rad <= 0.5)) {
    throw std::invalid_argument("sigma_rad must be in (0, 0.5]");
  }
  // A unit vector but for rounding of its source.
  WAYMARK_CHECK(std::abs(prior.n_C.norm() - 1.0) < 1e-6);
  const std::vector<LineDirection> directions = LineDirections(lines, view);
  const Crossings crossings(directions, prior, options);
  if (crossings.points().empty()) return std::nullopt;
  const FurthestRemoval removal =
      RemoveFurthest(crossings.points(), options.num_kept);

  VanishingPoint result;
  result.num_intersections = static_cast<int>(crossings.points().size());
  result.n_C = crossings.DirectionOf(removal.centre);
  result.across_C = AcrossOf(result.n_C);
  // From the plane across the prior to the sphere about the result.
  const double length = std::sqrt(1.0 + removal.centre.squaredNorm());
  const Matrix2d turn =
      result.across_C.transpose() * crossings.across_C() / length;
  result.covariance = turn *
                      crossings.Covariance(removal.kept, removal.centre) *
                      turn.transpose();
  for (const LineDirection& line : directions) {
    const bool is_inlier =
        std::abs(line.Residual(result.n_C)) <= options.support_sigmas;
    result.inlier_mask.push_back(is_inlier ? 1 : 0);
    result.num_inliers += is_inlier ? 1 : 0;
  }
  return result;
}

}  // namespace waymark
