#include "estimation/lines/manhattan_directions.h"

#include "estimation/base/check.h"
#include "estimation/lines/manhattan_likelihood.h"
#include "estimation/lines/manhattan_search.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Longest lines that a search for rotations is content with.
constexpr std::size_t kNumSearched = 200;

// Of a line that likelier runs along it than not; -1: along none.
int AxisOf(const ManhattanLikelihood& likelihood,
           const LineDirection& line,
           const Matrix3d& R_CM) {
  const int axis = likelihood.ClosestAxis(line, R_CM);
  if (axis < 0) return -1;
  return likelihood.FitOf(line, R_CM.col(axis)).belief > 1.0 ? axis : -1;
}

// Axes with two lines that are not pieces of one.
int NumSupported(const std::vector<LineDirection>& directions,
                 const std::vector<int>& axis_of_line,
                 int num_axes,
                 double min_angle_rad) {
  int num = 0;
  for (int k = 0; k < num_axes; ++k) {
    std::optional<Vector3d> first;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      if (axis_of_line[i] != k) continue;
      const Vector3d normal = directions[i].Normal();
      if (!first) first = normal;
      if (first->cross(normal).norm() <= min_angle_rad) continue;
      ++num;
      break;
    }
  }
  return num;
}

std::span<const LineSegment> FirstOf(const std::vector<LineSegment>& lines,
                                     int num) {
  return std::span<const LineSegment>(lines).first(
      std::min(lines.size(), static_cast<std::size_t>(num)));
}

// The likeliest of the proposals, near its maximum.
std::optional<Matrix3d> BestRotation(const std::vector<LineDirection>& lines,
                                     const std::optional<DirectionPrior>& prior,
                                     const ManhattanOptions& options) {
  // Enough to tell them apart; the best goes on.
  constexpr int kMaxSteps = 6;
  constexpr double kConverged = 1e-4;
  const ManhattanSearch search(
      std::span<const LineDirection>(lines).first(
          std::min(lines.size(), kNumSearched)),
      ManhattanLikelihood::OddsOf(options.inlier_share));
  const ManhattanLikelihood likelihood(lines,
                                       std::vector<double>(lines.size(), 1.0),
                                       prior,
                                       options.model_sigma_rad,
                                       options.inlier_share);
  std::optional<Matrix3d> best;
  double most = 0.0;
  for (Matrix3d R_CM : search.Propose(
           options.num_seeds,
           prior ? std::optional<Vector3d>(-prior->n_C) : std::nullopt,
           options.num_refined)) {
    if (!likelihood.Climb(&R_CM, kMaxSteps, kConverged)) continue;
    const double support = likelihood.Support(R_CM);
    if (support <= most) continue;
    most = support;
    best = R_CM;
  }
  return best;
}

std::optional<DirectionPrior> Checked(
    const std::optional<DirectionPrior>& gravity) {
  if (!gravity) return std::nullopt;
  if (!(gravity->sigma_rad > 0.0) || !(gravity->sigma_rad <= 0.05)) {
    throw std::invalid_argument("gravity's sigma_rad must be in (0, 0.05]");
  }
  // A unit vector but for rounding of its source.
  WAYMARK_CHECK(std::abs(gravity->n_C.norm() - 1.0) < 1e-6);
  return DirectionPrior{gravity->n_C.normalized(), gravity->sigma_rad};
}

}  // namespace

void ManhattanOptions::Check() const {
  collinear.Check();
  if (max_lines < 4) throw std::invalid_argument("max_lines: at least 4");
  if (num_seeds < 3) throw std::invalid_argument("num_seeds: at least 3");
  if (num_refined < 1) throw std::invalid_argument("num_refined: at least 1");
  if (!(model_sigma_rad > 0.0) || !(model_sigma_rad <= 0.1)) {
    throw std::invalid_argument("model_sigma_rad must be in (0, 0.1]");
  }
  if (!(inlier_share > 0.0) || !(inlier_share < 1.0)) {
    throw std::invalid_argument("inlier_share must be in (0, 1)");
  }
  if (!(min_angle_rad > 0.0) || !(min_angle_rad <= 1.0)) {
    throw std::invalid_argument("min_angle_rad must be in (0, 1]");
  }
}

ManhattanReport FindManhattanDirections(
    std::span<const LineSegment> lines,
    const PinholeView& view,
    const std::optional<DirectionPrior>& gravity,
    const ManhattanOptions& options) {
  options.Check();
  const std::optional<DirectionPrior> prior = Checked(gravity);
  const std::vector<LineDirection> directions = LineDirections(lines, view);
  const std::size_t least = prior ? 2 : 4;
  if (lines.size() < least) {
    return {std::nullopt,
            std::to_string(lines.size()) + " lines: at least " +
                std::to_string(least) + " are needed"};
  }
  const JoinedSegments joined = JoinCollinear(lines, options.collinear);
  std::optional<Matrix3d> R_CM = BestRotation(
      LineDirections(FirstOf(joined.segments, options.max_lines), view),
      prior,
      options);
  if (!R_CM) return {std::nullopt, "the lines agree on no directions"};
  std::vector<double> weights;
  for (const int num : joined.num_pieces) weights.push_back(1.0 / num);
  const ManhattanLikelihood likelihood(directions,
                                       std::move(weights),
                                       prior,
                                       options.model_sigma_rad,
                                       options.inlier_share);
  const std::optional<Matrix3d> covariance = likelihood.Settle(&*R_CM);
  if (!covariance) return {std::nullopt, "the lines leave a turn open"};
  ManhattanDirections found{*R_CM, *covariance, {}};
  for (const LineDirection& direction : directions) {
    found.axis_of_line.push_back(AxisOf(likelihood, direction, *R_CM));
  }
  const int num_supported = NumSupported(
      directions, found.axis_of_line, prior ? 2 : 3, options.min_angle_rad);
  if (num_supported < (prior ? 1 : 2)) {
    return {std::nullopt,
            num_supported == 0 ? "no two lines run along one direction"
                               : "lines run along one direction alone"};
  }
  return {std::move(found), {}};
}

}  // namespace waymark
