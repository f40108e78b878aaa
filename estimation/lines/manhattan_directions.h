// The three orthogonal directions of a building from line segments.
#pragma once

#include "estimation/lines/line_direction.h"
#include "estimation/lines/line_types.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace waymark {

struct ManhattanOptions {
  int max_lines = 250;  // The longest; at least 3.
  int num_seeds = 18;   // Longest lines whose pairs are tried; >= 3.
  int num_refined = 6;  // Best hypotheses that are refined; at least 1.
  double model_sigma_rad = 0.006;  // Of edges against their axis; (0, 0.1].
  double inlier_share = 0.5;       // Of lines along an axis; in (0, 1).

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct ManhattanDirections {
  // Columns: the axes in C, a rotation; which is which, and their signs, are
  // arbitrary.
  Eigen::Matrix3d R_CM = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // Of a turn in C.
  std::vector<int> axis_of_line;  // 0, 1, 2 or -1, one for each line.
};

// Pairs of long lines propose one axis, a histogram of the headings of all
// lines about it the other two; the best are refined by expectation and
// maximisation on the rotations, and the likeliest is returned. Lines near two
// axes count for both, which leaves a bias of up to a milliradian.
//
// nullopt where lines support fewer than two axes, 0 to 2 lines included.
// Throws as LineDirections and Check do. Deterministic. Cost
// O(num_seeds^2 max_lines).
[[nodiscard]] std::optional<ManhattanDirections> FindManhattanDirections(
    std::span<const LineSegment> lines,
    const PinholeView& view,
    const ManhattanOptions& options);

}  // namespace waymark
