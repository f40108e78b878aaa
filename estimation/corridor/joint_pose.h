// Lateral position and heading together, from all lines of one image.
#pragma once

#include "estimation/corridor/axis_heading.h"
#include "estimation/corridor/corridor_types.h"
#include "estimation/corridor/corridor_view.h"
#include "estimation/corridor/edge_evidence.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace waymark {

struct JointPoseOptions {
  EdgeEvidenceOptions evidence;
  double min_evidence = 5.0;  // Logarithm, over lines at random.
  // Another position as good as that, beyond exp(margin), makes it ambiguous.
  double min_margin = 5.0;
  // The edges of one wall alone are a pair of parallel lines, as two joints of
  // a floor are: they must stand out by more, and lie closer to where they
  // should be, root mean square of their distances.
  double min_margin_one_wall = 6.0;
  double max_rms_one_wall_px = 0.7;
  double min_seen_px = 100.0;  // Of edges, all together.
  int min_edges = 2;           // Different ones.
  // What remains however many lines agree, and is much the same from image to
  // image: walls are not straight, cameras not mounted quite as stated.
  double floor_m = 0.01;
  double floor_rad = 0.002;
  double max_sigma_m = 0.1;  // Known worse than that is no answer.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct JointPose {
  std::optional<double> y;  // Of R in L, m; absent: see reason.
  double heading = 0.0;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  // Of (y, heading).
  std::string reason;
  // Of each line.
  std::vector<CorridorEdge> edges;
};

// Every line along the corridor is one of its known edges, in the quadrant
// about the vanishing point where it lies [1, section III.C], or none of them.
// The position that explains them best (see edge_evidence.h) must stand out
// from all others; position and heading are then refined together from offsets
// and directions of all lines (least squares with Tukey's weights), and so is
// their covariance.
//
//   heading   of all lines, with their families.
//
// The corridor's width is known. Without enough edges, or with two positions
// equally good, there is no y, and the heading is the one that was given.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] JointPose EstimateJointPose(
    const CorridorView& view,
    const CorridorGeometry& corridor,
    std::span<const SeenLine> lines,
    const AxisHeading& heading,
    const std::optional<LateralPrior>& prior,
    const JointPoseOptions& options);

}  // namespace waymark
