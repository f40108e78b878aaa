// Which lateral position explains the lines along a corridor.
#pragma once

#include "estimation/corridor/axis_heading.h"
#include "estimation/corridor/corridor_types.h"
#include "estimation/corridor/corridor_view.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace waymark {

// What lines may be taken for, in the order of LateralPeak::coverage.
inline constexpr std::array kCorridorEdges = {CorridorEdge::kFloorLeft,
                                              CorridorEdge::kFloorRight,
                                              CorridorEdge::kCeilingLeft,
                                              CorridorEdge::kCeilingRight,
                                              CorridorEdge::kSkirtingLeft,
                                              CorridorEdge::kSkirtingRight};

// A line, taken for an edge, puts the robot at y.
struct EdgeCandidate {
  std::size_t line = 0;
  CorridorEdge edge = CorridorEdge::kNone;
  double y = 0.0;      // Of R in L, m.
  double sigma = 0.0;  // m.
};

// Candidates of every line along the corridor: each of its edges on that side
// of the vanishing point where the line lies [1, section III.C].
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] std::vector<EdgeCandidate> FindEdgeCandidates(
    const CorridorView& view,
    const CorridorGeometry& corridor,
    std::span<const SeenLine> lines,
    const AxisHeading& heading);

// Where the robot is believed to be in L, m.
struct LateralPrior {
  double y = 0.0;
  double sigma = 0.0;
  double x = 0.0;  // Edges are not looked for beyond the corridor's ends.
  double sigma_x = 0.0;
};

// Shares are those of rendered corridors, rounded; see README.md.
struct EdgeEvidenceOptions {
  // Of the edges in view, how many no line is found on: people and furniture
  // hide the floor's, and a ceiling is often as bright as the wall.
  double floor_missing = 0.05;
  double ceiling_missing = 0.8;
  // Where no edge is, a line is found all the same with this probability, and
  // covers so much of the way on average.
  double chance = 0.2;
  double chance_coverage = 0.3;
  // Edges are looked at as far away as this, and where they are longer than
  // that in the image.
  double reach_m = 8.0;
  double min_length_px = 40.0;
  // A candidate farther off is not of that edge.
  double max_sigmas = 3.5;
  // Candidates of one edge scatter by so much besides, m.
  double scatter_m = 0.003;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct LateralPeak {
  double y = 0.0;
  // Logarithm of the likelihood over that of lines at random, with the prior;
  // of the best position, and of the best beyond a valley.
  double evidence = -std::numeric_limits<double>::infinity();
  double rival = -std::numeric_limits<double>::infinity();
  // Share of each edge in view that lines cover; negative: not in view.
  std::array<double, kCorridorEdges.size()> coverage{};
};

// Where an edge is in view for a robot at (y, heading): ends in the image, px,
// of what lies between `from` and `to` along the axis, m from the robot.
// nullopt where it is not.
[[nodiscard]] std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>>
VisibleEdge(const CorridorView& view,
            const Eigen::Vector2d& place,
            double y,
            double heading,
            double from,
            double to);

// The position at which the corridor's edges would lie where lines are found:
// of each edge the part in view that lines cover says for or against it, so
// that an edge which should be seen and is not counts against a position, and a
// hundred pieces of one line count no more than that line. Looked at wherever a
// candidate is.
[[nodiscard]] LateralPeak FindLateralPeak(
    const CorridorView& view,
    const CorridorGeometry& corridor,
    std::span<const SeenLine> lines,
    std::span<const EdgeCandidate> candidates,
    double heading,
    const std::optional<LateralPrior>& prior,
    const EdgeEvidenceOptions& options);

}  // namespace waymark
