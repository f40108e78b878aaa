// Heading in a corridor from lines along and across it, gravity known.
#pragma once

#include "estimation/corridor/corridor_view.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace waymark {

struct AxisHeadingOptions {
  // Share of lines that are along the corridor, and across it.
  double along_share = 0.3;
  double across_share = 0.1;
  // A line that misses the vanishing point by more is none of them.
  double max_sigmas = 4.0;
  // Logarithm of the likelihood, over that of lines at random, that an answer
  // needs.
  double min_evidence = 10.0;
  // Along the corridor and across it; two along. Two alone where both are as
  // long as that: skirting board and floor edge of the wall before a robot that
  // turns.
  int min_lines = 3;
  double min_pair_px = 200.0;
  // Where lines at random happen to agree, they do so nearly as well elsewhere:
  // a heading stands by itself, without a position that goes with it, where
  // its margin is at least so much of its evidence.
  double min_margin_share = 0.5;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

enum class LineFamily : std::uint8_t { kOther, kAlong, kAcross };

struct AxisHeading {
  double heading = 0.0;  // Of R in L, rad; modulo pi without a prior.
  double sigma = 0.0;
  // Logarithm of the likelihood over that of lines at random, without the
  // prior; and by how much that, with the prior, is more than at any other
  // heading.
  double evidence = 0.0;
  double margin = 0.0;
  std::vector<LineFamily> families;  // Of each line.
};

// Whether a heading stands by itself.
[[nodiscard]] bool StandsOut(const AxisHeading& heading,
                             const AxisHeadingOptions& options);

struct AxisPrior {
  double heading = 0.0;
  double sigma = 0.0;
};

// The most likely heading: every line says at which headings it would pass
// through the axis's vanishing point, or through that of what lies across the
// axis, with what its errors leave open; all headings are looked at (steps of
// an eighth of a degree), the best is refined. Lines at random count as they
// would be by chance, so that one long line outweighs many short ones.
//
//   prior   heading and its sigma; it chooses between the axis and what lies
//           across it, and between both directions.
//
// This replaces intersections and their cluster [1, section III.B] where the
// camera's tilt is known: a vanishing point then has one unknown, not two.
// nullopt where the lines do not agree.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] std::optional<AxisHeading> EstimateAxisHeading(
    const CorridorView& view,
    std::span<const SeenLine> lines,
    const std::optional<AxisPrior>& prior,
    const AxisHeadingOptions& options);

}  // namespace waymark
