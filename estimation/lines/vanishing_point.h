// Where parallel edges vanish: the published estimator, and one along a known
// horizontal plane.
#pragma once

#include "estimation/lines/line_direction.h"
#include "estimation/lines/line_types.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace waymark {

// ---- the published one -----------------------------------------------------

struct VanishingPointOptions {
  double gate_sigmas = 3.0;  // Of the prior; in (0, 100].
  int num_kept = 30;         // Intersections left by the removal; at least 1.
  // Lines whose planes with the camera are closer than this, or than three of
  // their sigmas, do not intersect: pieces of one line. In (0, 1].
  double min_angle_rad = 0.03;
  double support_sigmas = 3.0;  // Lines this close to the result support it.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct VanishingPoint {
  Eigen::Vector3d n_C = Eigen::Vector3d::UnitZ();  // Unit; prior's half.
  // Two unit vectors across n_C, and the covariance of n_C along them, to
  // first order from the errors of the lines whose intersections were kept.
  Eigen::Matrix<double, 3, 2> across_C = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  std::vector<char> inlier_mask;  // One for each line.
  int num_inliers = 0;
  int num_intersections = 0;  // Within the gate.
};

// All pairs of lines are intersected, the intersections are gated about the
// prior (eq. 1), and the furthest from the centre of gravity of the rest is
// taken away until num_kept are left; the answer is their centre [1, section
// III.B]. Points are those of an image plane across the prior's direction,
// which any vanishing point within its gate can reach, at infinity of the
// camera's image or not.
//
//   prior   sigma in (0, 0.5]
//
// nullopt without an intersection in the gate. Throws std::logic_error for
// lines, and std::invalid_argument for options or a prior, that are out of
// range. Cost O(N^2 log N).
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] std::optional<VanishingPoint> FindVanishingPoint(
    std::span<const LineSegment> lines,
    const PinholeView& view,
    const DirectionPrior& prior,
    const VanishingPointOptions& options);

// ---- along a known horizontal plane ----------------------------------------

// Heading of a direction in C about the vertical, given where gravity pulls
// (unit): 0 along the optical axis levelled (the image's right where that is
// vertical), positive to the right, in (-pi, pi]. For a camera tilted by tau
// down, without roll, it is atan(x_v cos(tau)) of a vanishing point at image
// plane coordinate x_v on the horizon, to which 'theta = atan(x_v)' shrinks.
[[nodiscard]] double HeadingOf(const Eigen::Vector3d& n_C,
                               const Eigen::Vector3d& gravity_C);
// The horizontal direction of that heading; the inverse of HeadingOf.
[[nodiscard]] Eigen::Vector3d DirectionOfHeading(
    double heading, const Eigen::Vector3d& gravity_C);

struct HorizontalDirectionOptions {
  // Of an edge against the direction it belongs to: buildings are not exact.
  double model_sigma_rad = 0.002;  // In [0, 0.1].
  // Share of lines that belong to a direction, before any is seen; in (0, 1).
  double inlier_share = 0.2;
  // Lines whose own heading is less certain than this, near the horizon, do
  // not count; in (0, 0.5].
  double max_sigma_rad = 0.2;
  double vertical_sigmas = 3.0;  // As close to vertical: left out; >= 0.
  double inlier_sigmas = 3.0;    // In (0, 10].
  int min_lines = 2;             // That support a direction; at least 2.
  // The planes through the camera and two of the lines, the widest apart:
  // pieces of one line are no evidence. In (0, 1].
  double min_angle_rad = 0.03;
  double gate_sigmas = 3.0;  // Of the prior; in (0, 100].
  int max_directions = 8;    // At least 1.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct HeadingPrior {
  double heading = 0.0;    // As HeadingOf.
  double sigma_rad = 0.1;  // Positive.
};

struct HorizontalDirection {
  Eigen::Vector3d n_C = Eigen::Vector3d::UnitZ();  // Unit.
  double heading = 0.0;    // In (-pi, pi]; with a prior the way it looks, else
                           // in (-pi/2, pi/2].
  double sigma_rad = 0.0;  // Of the heading, gravity being exact.
  double support = 0.0;    // Logarithm of the likelihood over that of chance.
  std::vector<double> residuals;  // One for each line, sigmas.
  std::vector<char> inlier_mask;
  int num_inliers = 0;
};

// All horizontal directions along which lines of the image run, the best
// supported first; with a prior those within its gate, ranked by both. The
// prior is not part of the estimate, so a filter may fuse that.
//
// Each line meets the horizontal plane in one heading with an error of its
// own. The likelihood of a heading is a product over lines of a mixture: of
// this direction, or of any. All headings are searched in steps of a quarter
// of a degree, and each maximum is refined to the weighted mean of the lines
// that belong to it. Lines along gravity are left out.
//
//   gravity_C   unit vector.
//
// Empty if nothing is supported well enough, 0 and 1 line included. Throws
// std::logic_error for lines or a gravity, and std::invalid_argument for
// options, out of range. Cost O(N). Deterministic.
[[nodiscard]] std::vector<HorizontalDirection> FindHorizontalDirections(
    std::span<const LineSegment> lines,
    const PinholeView& view,
    const Eigen::Vector3d& gravity_C,
    const std::optional<HeadingPrior>& prior,
    const HorizontalDirectionOptions& options);

}  // namespace waymark
