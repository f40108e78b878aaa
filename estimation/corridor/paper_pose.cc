#include "estimation/corridor/paper_pose.h"

#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

// The widest that a gate of the vanishing point takes, rad.
constexpr double kWidestPrior = 0.5;

DirectionPrior DirectionOf(const CorridorView& view,
                           const std::optional<AxisPrior>& prior,
                           double vision_rad) {
  if (!prior) return {Eigen::Vector3d::UnitZ(), kWidestPrior};
  return {view.X_RC.linear().transpose() * AxisIn(prior->heading),
          std::min(std::hypot(prior->sigma, vision_rad), kWidestPrior)};
}

}  // namespace

void PaperPoseOptions::Check() const {
  vanishing.Check();
  classification.Check();
  lateral.Check();
  if (min_lines < 2) throw std::invalid_argument("min_lines: at least 2");
  if (!(sigma_rad > 0.0)) {
    throw std::invalid_argument("sigma_rad: must be positive");
  }
  if (!(sigma_m > 0.0)) {
    throw std::invalid_argument("sigma_m: must be positive");
  }
}

std::optional<AxisHeading> EstimatePaperHeading(
    const CorridorView& view,
    std::span<const LineSegment> segments,
    std::span<const SeenLine> lines,
    const std::optional<AxisPrior>& prior,
    const PaperPoseOptions& options) {
  const Intrinsics& k = view.intrinsics;
  const auto point =
      FindVanishingPoint(segments,
                         {k.fx, k.fy, k.cx, k.cy},
                         DirectionOf(view, prior, options.sigma_rad),
                         options.vanishing);
  if (!point) return std::nullopt;
  const Eigen::Vector3d axis_R = view.X_RC.linear() * point->n_C;
  AxisHeading heading;
  heading.heading = std::atan2(-axis_R.y(), axis_R.x());
  heading.sigma = options.sigma_rad;
  int num_along = 0;
  for (const SeenLine& line : lines) {
    const bool is_along =
        ClassifyLine(view, line, heading.heading, options.classification) !=
        CorridorEdge::kNone;
    heading.families.push_back(is_along ? LineFamily::kAlong
                                        : LineFamily::kOther);
    num_along += is_along ? 1 : 0;
  }
  if (num_along < options.min_lines) return std::nullopt;
  return heading;
}

JointPose EstimatePaperPose(const CorridorView& view,
                            const CorridorGeometry& corridor,
                            std::span<const SeenLine> lines,
                            const AxisHeading& heading,
                            const PaperPoseOptions& options) {
  JointPose pose;
  pose.heading = heading.heading;
  pose.covariance(1, 1) = options.sigma_rad * options.sigma_rad;
  for (const SeenLine& line : lines) {
    pose.edges.push_back(
        ClassifyLine(view, line, heading.heading, options.classification));
  }
  const LateralConsensus consensus = AgreeOnLateral(
      view, lines, pose.edges, corridor, heading.heading, options.lateral);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (consensus.inlier_mask[i] == 0 && pose.edges[i] != CorridorEdge::kNone) {
      pose.edges[i] = CorridorEdge::kAlong;
    }
  }
  pose.y = consensus.y;
  pose.reason = consensus.reason;
  if (pose.y) pose.covariance(0, 0) = options.sigma_m * options.sigma_m;
  return pose;
}

}  // namespace waymark
