// Which edge of a corridor an image line is, by where it lies about the
// vanishing point.
#pragma once

#include "estimation/corridor/corridor_types.h"
#include "estimation/corridor/corridor_view.h"

namespace waymark {

struct LineClassificationOptions {
  // A line that misses the vanishing point by more is not along the corridor.
  double max_sigmas = 3.0;
  // Of the vanishing point, besides the line's own errors: 2 px are 0.3 degrees
  // [1, section V.A].
  double vanishing_rad = 0.005;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// kNone where the line does not pass through the point in which the axis
// vanishes at that heading; else one of the four corners: below the point is
// the floor, above it the ceiling, left of it the left wall, right the right
// one, for a robot inside the corridor and a line that is a corner at all [1,
// section III.C]. Below and left are those of the corridor's cross-section, as
// seen along the axis: what they are in the image of a level camera. kAlong
// for a line on the border between two corners.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] CorridorEdge ClassifyLine(
    const CorridorView& view,
    const SeenLine& line,
    double heading,
    const LineClassificationOptions& options);

}  // namespace waymark
