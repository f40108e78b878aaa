// Heading and lateral position step by step, as published.
#pragma once

#include "estimation/corridor/axis_heading.h"
#include "estimation/corridor/joint_pose.h"
#include "estimation/corridor/lateral_candidates.h"
#include "estimation/corridor/line_classification.h"
#include "estimation/lines/line_types.h"
#include "estimation/lines/vanishing_point.h"

#include <optional>
#include <span>

namespace waymark {

struct PaperPoseOptions {
  VanishingPointOptions vanishing;
  LineClassificationOptions classification;
  LateralConsensusOptions lateral;
  int min_lines = 2;  // Through the vanishing point.
  // The error of every answer, whatever the image [1, section IV.A].
  double sigma_rad = 0.01;
  double sigma_m = 0.03;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Heading of the vanishing point of [1, section III.B] about the vertical: of
// its two coordinates a robot on a floor needs one. Intersections are gated by
// the prior and by what a vanishing point itself is off by; without a prior all
// in front of the camera count, and the heading is modulo pi. Families say
// which lines pass through it; the evidence is not known and 0.
//
//   lines   the same as `segments`.
//
// nullopt without enough lines through one point.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] std::optional<AxisHeading> EstimatePaperHeading(
    const CorridorView& view,
    std::span<const LineSegment> segments,
    std::span<const SeenLine> lines,
    const std::optional<AxisPrior>& prior,
    const PaperPoseOptions& options);

// Lines classified, a candidate from each, the furthest taken away [1, section
// III.C]; the heading stays as it was given. Lines whose candidates were taken
// away are kAlong in the result. The corridor's width is known.
[[nodiscard]] JointPose EstimatePaperPose(const CorridorView& view,
                                          const CorridorGeometry& corridor,
                                          std::span<const SeenLine> lines,
                                          const AxisHeading& heading,
                                          const PaperPoseOptions& options);

}  // namespace waymark
