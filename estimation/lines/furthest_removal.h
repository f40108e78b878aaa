// Consensus by taking away the furthest point again and again.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

struct FurthestRemoval {
  std::vector<int> removed;  // Indices, in the order of their removal.
  std::vector<int> kept;     // Indices, ascending.
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // Mean of those kept.
  // Nodes and points that were looked at: the cost, whatever the machine.
  std::int64_t num_visits = 0;
};

// Removes the point furthest from the centre of gravity of those that remain,
// one at a time, until `num_kept` are left [1, section III.B]. Of points
// equally far the one of the lowest index goes first. With `num_kept` of N or
// more none is removed.
//
// A quad-tree whose nodes remember their furthest point finds the next one:
// O(N log N) visits for points in general position, up to N^2 where all lie on
// one circle.
//
// Throws std::logic_error if num_kept < 1 or a point is not finite.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] FurthestRemoval RemoveFurthest(
    std::span<const Eigen::Vector2d> points, int num_kept);

// The same on a line; the centre's y is 0.
[[nodiscard]] FurthestRemoval RemoveFurthest(std::span<const double> values,
                                             int num_kept);

}  // namespace waymark
