// Rotations that the lines of an image may belong to, found coarsely.
#pragma once

#include "estimation/lines/line_direction.h"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace waymark {

// Searches the rotations whose axes many lines run along, to a degree or so:
// what an estimator then starts from.
//
// A line's worth at a direction is that of a truncated normal error,
// max(0, height - z^2 / 2): the logarithm of the mixture 'along it, or along
// any' but for the rounding of its corner. Lines lie in memory as columns of
// floats, so that a rotation costs a microsecond.
class ManhattanSearch {
 public:
  // Lines in the order in which they propose, the longest first. `odds`: of a
  // line along one axis rather than any, times its angular error in rad.
  ManhattanSearch(std::span<const LineDirection> lines, double odds);

  // The most valuable rotations first, each at least two degrees from the
  // others (whatever the order and signs of their columns), `num` at most.
  // Pairs of the first `num_seeds` lines propose one axis each, the headings of
  // all lines about it the others; with `axis_C` (unit) it is the only one, and
  // column 2. Cost O((num_seeds^2 + num) N).
  [[nodiscard]] std::vector<Eigen::Matrix3d> Propose(
      int num_seeds,
      const std::optional<Eigen::Vector3d>& axis_C,
      int num) const;

 private:
  struct Rotation {
    Eigen::Matrix3d R_CM;
    double worth;
  };
  struct Axis {
    Eigen::Vector3d n_C;
    double worth;
  };

  static constexpr std::size_t kBlock = 8;
  // Of kBlock lines, a column each.
  struct Block {
    std::array<std::array<float, kBlock>, 3> across{};
    std::array<std::array<float, kBlock>, 3> along{};
    std::array<float, kBlock> variance_px{};
    std::array<float, kBlock> variance_rad{};
    std::array<float, kBlock> height{};
  };
  using Lanes = std::array<float, kBlock>;

  static void HalfSquares(const Block& block,
                          const Eigen::Vector3f& n_C,
                          Lanes* half_squares);
  [[nodiscard]] double Worth(const Eigen::Vector3d& n_C) const;
  [[nodiscard]] double Worth(const Eigen::Matrix3d& R_CM) const;
  [[nodiscard]] std::vector<Axis> Axes(int num_seeds) const;
  [[nodiscard]] Eigen::Vector3d Polished(Eigen::Vector3d n_C) const;
  void Complete(const Eigen::Vector3d& axis_C,
                std::vector<Rotation>* found) const;
  [[nodiscard]] Eigen::Matrix3d Polished(Eigen::Matrix3d R_CM,
                                         bool has_axis) const;

  std::vector<LineDirection> lines_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<Block> blocks_;
};

}  // namespace waymark
