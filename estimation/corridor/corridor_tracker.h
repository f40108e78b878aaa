// From an image to the robot's place in a corridor.
#pragma once

#include "estimation/corridor/axis_heading.h"
#include "estimation/corridor/corridor_types.h"
#include "estimation/corridor/corridor_view.h"
#include "estimation/corridor/joint_pose.h"
#include "estimation/corridor/paper_pose.h"
#include "estimation/corridor/pinhole_lines.h"
#include "estimation/filter/two_hypothesis_gate.h"
#include "estimation/geometry/angle.h"
#include "estimation/lines/line_extractor.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <optional>

namespace waymark {

enum class CorridorMethod {
  kJoint,  // Heading and position together, errors from the lines' own.
  kPaper,  // One after the other with constant errors, as published.
};

struct CorridorTrackerOptions {
  CorridorMethod method = CorridorMethod::kJoint;
  LineExtractorOptions lines;
  // Of the straight walls that lines are taken for, added to the lines' own.
  double model_px = 0.15;
  double model_rad = 0.0005;
  AxisHeadingOptions heading;  // For kJoint.
  JointPoseOptions pose;
  PaperPoseOptions paper;  // For kPaper.
  GateOptions gate;
  // A prior heading known worse than this does not choose a direction: what is
  // more than 45 degrees from it counts as across, three sigmas.
  double max_prior_rad = RadiansFromDegrees(15.0);
  // So near to the corridor's end, ahead, it counts as ending there.
  double end_m = 1.0;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// The pose from the lines of one view, and whether it is to be believed.
// Pixels are those of the view. Deterministic.
[[nodiscard]] CorridorEstimate EstimateCorridor(
    const CorridorView& view,
    const LineSet& lines,
    const CorridorGeometry& corridor,
    const std::optional<CorridorPrior>& prior,
    const CorridorTrackerOptions& options);

// P(regular) of an estimate that has a heading, against what was believed
// before [1, section III.D]; the position counts where there is one.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
[[nodiscard]] double RegularProbabilityOf(const CorridorEstimate& estimate,
                                          const CorridorPrior& prior,
                                          const GateOptions& options);

// EstimateCorridor for images of one camera, of any model. Keeps its buffers.
class CorridorTracker {
 public:
  // Throws std::invalid_argument as options.Check() does, and where the camera
  // does not see forward (a panorama).
  CorridorTracker(const CameraView& camera,
                  const CorridorTrackerOptions& options);

  // `image`: of the camera's size. Lines and vanishing point of the result are
  // in its pixels (a line's ends are; between them a lens may bend it).
  [[nodiscard]] CorridorEstimate Estimate(
      const cv::Mat1b& image,
      const Eigen::Isometry3d& X_RC,
      const CorridorGeometry& corridor,
      const std::optional<CorridorPrior>& prior);

  // Its two halves: the lines, in pixels of view(), and the pose from them.
  [[nodiscard]] LineSet FindLines(const cv::Mat1b& image);
  [[nodiscard]] CorridorEstimate EstimateFrom(
      const LineSet& lines,
      const Eigen::Isometry3d& X_RC,
      const CorridorGeometry& corridor,
      const std::optional<CorridorPrior>& prior) const;

  // What lines are looked for in.
  [[nodiscard]] const CameraView& view() const { return lines_.view(); }

 private:
  CorridorTrackerOptions options_;
  PinholeLines lines_;
};

}  // namespace waymark
