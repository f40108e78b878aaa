// Lateral positions from single lines of a corridor, and what they agree on.
#pragma once

#include "estimation/corridor/corridor_types.h"
#include "estimation/corridor/corridor_view.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace waymark {

// Where across the corridor the robot is, y of R in L, if `line` is that edge:
// the second constraint of equation 3 [1],
//
//   a p_x + b p_y = c p_z,
//
// for the line a x + b y = c of the image and a point p of the edge, in the
// camera's frame, solved for y. Of all points of the edge p is that which is
// seen in the line's middle, where the line is known best; where the line
// passes through the vanishing point of `heading` (the first constraint) any
// other gives the same.
//
// nullopt where the edge's place is not known (no width, for the ceiling no
// height), where no such edge can be seen in that line, and where the camera
// would not be between the walls.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009, section III.C.
[[nodiscard]] std::optional<double> LateralCandidate(
    const CorridorView& view,
    const SeenLine& line,
    CorridorEdge edge,
    const CorridorGeometry& corridor,
    double heading);

// The same for the camera itself, its ray to a point of an edge at `place`,
// both in the cross-section: y where the ray, back from the edge, has come to
// the camera's height. nullopt where the edge is on the other side of the
// camera, and where that would not be between the walls.
[[nodiscard]] std::optional<double> LateralOfRay(const Eigen::Vector2d& ray,
                                                 const Eigen::Vector2d& place,
                                                 double camera_z,
                                                 double width);

struct LateralConsensusOptions {
  int num_kept = 4;  // Candidates left by the removal; at least 1.
  // Both walls must be among them: whatever runs along one wall agrees with
  // itself.
  bool needs_both_walls = true;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct LateralConsensus {
  std::optional<double> y;        // m; absent: see reason.
  std::string reason;             // One line; empty where there is y.
  std::vector<char> inlier_mask;  // Of each line, 1 where its candidate is
                                  // among those kept.
};

// Candidates of all lines; the furthest from their mean is taken away until
// num_kept are left, their mean is the answer [1, section III.C]. With no more
// than num_kept none is taken away.
//
//   edges   what each line is, as ClassifyLine says; kNone and kAlong have no
//           candidate.
//
// Throws std::logic_error where lines and edges differ in number.
[[nodiscard]] LateralConsensus AgreeOnLateral(
    const CorridorView& view,
    std::span<const SeenLine> lines,
    std::span<const CorridorEdge> edges,
    const CorridorGeometry& corridor,
    double heading,
    const LateralConsensusOptions& options);

}  // namespace waymark
