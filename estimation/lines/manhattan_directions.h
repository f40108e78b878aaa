// The three orthogonal directions of a building from line segments.
#pragma once

#include "estimation/lines/collinear_segments.h"
#include "estimation/lines/line_direction.h"
#include "estimation/lines/line_types.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace waymark {

struct ManhattanOptions {
  CollinearOptions collinear;
  int max_lines = 500;  // The longest of those joined; at least 4.
  int num_seeds = 22;   // Longest lines whose pairs are tried; at least 3.
  int num_refined = 2;  // Best proposals that are refined; at least 1.
  // Of an edge's image against its axis' vanishing point; (0, 0.1].
  double model_sigma_rad = 0.006;
  double inlier_share = 0.5;  // Of lines along an axis; in (0, 1).
  // Two lines of an axis must differ by so much, as planes through the camera:
  // pieces of one line are no evidence. In (0, 1].
  double min_angle_rad = 0.03;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct ManhattanDirections {
  // Columns: the axes in C, a rotation; which is which, and their signs, are
  // arbitrary. With known gravity column 2 points against it.
  Eigen::Matrix3d R_CM = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // Of a turn in C.
  std::vector<int> axis_of_line;  // 0, 1, 2 or -1, one for each line.
};

struct ManhattanReport {
  std::optional<ManhattanDirections> directions;
  std::string reason;  // One line, where there are none.
};

// Pieces of one line are joined. ManhattanSearch proposes rotations;
// ManhattanLikelihood refines the best, and of the likeliest leaves each line
// to the axis it is closest to, so that exact lines give the exact rotation.
// The covariance follows from the stated errors of lines and model, and from
// what lines in the tails count for less.
//
//   gravity   where it pulls; sigma in (0, 0.05]. It takes part in the
//             estimate: its errors are in the covariance.
//
// No directions, and a reason, where fewer than two axes, or beside gravity
// none, have two lines. Throws as LineDirections and Check do, and
// std::invalid_argument for a gravity out of range. Deterministic. Cost
// O(num_seeds^2 max_lines).
[[nodiscard]] ManhattanReport FindManhattanDirections(
    std::span<const LineSegment> lines,
    const PinholeView& view,
    const std::optional<DirectionPrior>& gravity,
    const ManhattanOptions& options);

}  // namespace waymark
