// What vanishing points and their parts are measured against.
#pragma once

#include "estimation/lines/line_direction.h"
#include "estimation/lines/line_types.h"
#include "estimation/lines/vanishing_point.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace waymark {

// Three orthogonal directions by exhaustive search on two lines [1]. The
// intersections of all pairs of lines, weighted by both lengths and the angle
// between them, vote in a grid of a degree over the half sphere. Two lines
// propose one direction, each degree about it the second, their cross product
// the third; the three cells' votes score them. As many pairs as one good one
// among half outliers needs with 0.9999. The best is refined: least squares of
// the rotation to the lines within `gate`, again and again, which [1] leaves
// out. nullopt for fewer than two lines.
//
// [1] X. Lu, J. Yao, H. Li, Y. Liu. 2-Line exhaustive searching for real-time
//     vanishing point estimation in Manhattan world. WACV 2017.
[[nodiscard]] std::optional<Eigen::Matrix3d> TwoLineSearch(
    std::span<const LineSegment> lines, const PinholeView& view);
// The same with every pair of lines as a proposal.
[[nodiscard]] std::optional<Eigen::Matrix3d> TwoLineSearchOfAllPairs(
    std::span<const LineSegment> lines, const PinholeView& view);

// One direction near the prior by RANSAC: intersections of two lines within
// the gate, scored by the lengths of the lines that pass them within a degree,
// the best refined by least squares over those.
[[nodiscard]] std::optional<Eigen::Vector3d> RansacVanishingPoint(
    std::span<const LineSegment> lines,
    const PinholeView& view,
    const DirectionPrior& prior,
    double gate_sigmas);

// The order in which the furthest points go, by looking at all that are left
// each time.
[[nodiscard]] std::vector<int> PlainFurthestRemoval(
    std::span<const Eigen::Vector2d> points, int num_kept);

}  // namespace waymark
