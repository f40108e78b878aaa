#include "estimation/corridor/corridor_tracker.h"

#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

namespace waymark {
namespace {

std::optional<AxisPrior> HeadingPriorOf(
    const std::optional<CorridorPrior>& prior, double max_sigma) {
  if (!prior) return std::nullopt;
  const double sigma = std::sqrt(prior->covariance(2, 2));
  if (!(sigma < max_sigma) || !std::isfinite(prior->X_LR.heading)) {
    return std::nullopt;
  }
  return AxisPrior{prior->X_LR.heading, sigma};
}

std::optional<LateralPrior> LateralPriorOf(
    const std::optional<CorridorPrior>& prior) {
  if (!prior) return std::nullopt;
  return LateralPrior{prior->X_LR.y,
                      std::sqrt(prior->covariance(1, 1)),
                      prior->X_LR.x,
                      std::sqrt(prior->covariance(0, 0))};
}

// Whether the corridor ends within `end_m` in front of the robot.
bool IsAtEnd(const CorridorGeometry& corridor,
             const std::optional<CorridorPrior>& prior,
             double end_m) {
  if (!prior) return false;
  const bool is_forward = std::cos(prior->X_LR.heading) > 0.0;
  const double left = is_forward ? corridor.x_max - prior->X_LR.x
                                 : prior->X_LR.x - corridor.x_min;
  // Who hardly knows where along it the robot is cannot say so.
  const bool is_known = prior->covariance(0, 0) < end_m * end_m;
  return is_known && left < end_m;
}

bool IsKnownEdge(CorridorEdge edge) {
  return edge != CorridorEdge::kNone && edge != CorridorEdge::kAlong;
}

void SayNo(CorridorStatus status,
           std::string reason,
           CorridorEstimate* estimate) {
  estimate->status = status;
  estimate->reason = std::move(reason);
}

// Vanishing point, and which lines are along the axis.
void NoteFamilies(const CorridorView& view,
                  const AxisHeading& heading,
                  CorridorEstimate* estimate) {
  const Eigen::Vector3d point = view.PixelOf(AxisIn(heading.heading));
  // Farther than any image is at infinity.
  if (std::abs(point.z()) > 1e-3) {
    estimate->vanishing_point = Eigen::Vector2d(point.hnormalized());
  }
  for (std::size_t i = 0; i < estimate->lines.size(); ++i) {
    if (heading.families[i] == LineFamily::kAlong) {
      estimate->lines[i].edge = CorridorEdge::kAlong;
    }
  }
}

void NotePose(const JointPose& pose, CorridorEstimate* estimate) {
  estimate->y = pose.y;
  estimate->heading = pose.heading;
  estimate->covariance = pose.covariance;
  for (std::size_t i = 0; i < estimate->lines.size(); ++i) {
    estimate->lines[i].edge = pose.edges[i];
    estimate->lines[i].is_used = pose.y && IsKnownEdge(pose.edges[i]);
  }
}

std::optional<AxisHeading> FindHeading(const CorridorView& view,
                                       const LineSet& lines,
                                       const std::vector<SeenLine>& seen,
                                       const std::optional<AxisPrior>& prior,
                                       const CorridorTrackerOptions& options) {
  if (options.method == CorridorMethod::kPaper) {
    return EstimatePaperHeading(
        view, lines.segments, seen, prior, options.paper);
  }
  return EstimateAxisHeading(view, seen, prior, options.heading);
}

JointPose FindPose(const CorridorView& view,
                   const CorridorGeometry& corridor,
                   const std::vector<SeenLine>& seen,
                   const AxisHeading& heading,
                   const std::optional<CorridorPrior>& prior,
                   const CorridorTrackerOptions& options) {
  if (options.method == CorridorMethod::kPaper) {
    return EstimatePaperPose(view, corridor, seen, heading, options.paper);
  }
  return EstimateJointPose(
      view, corridor, seen, heading, LateralPriorOf(prior), options.pose);
}

// The heading alone, with what remains of its error however many lines agree.
JointPose PoseWithoutPosition(const AxisHeading& heading,
                              const std::vector<CorridorLine>& lines,
                              const CorridorTrackerOptions& options) {
  const bool is_joint = options.method == CorridorMethod::kJoint;
  JointPose pose;
  pose.heading = heading.heading;
  const double sigma =
      std::hypot(heading.sigma, is_joint ? options.pose.floor_rad : 0.0);
  pose.covariance(1, 1) = sigma * sigma;
  for (const CorridorLine& line : lines) pose.edges.push_back(line.edge);
  return pose;
}

}  // namespace

void CorridorTrackerOptions::Check() const {
  lines.Check();
  heading.Check();
  pose.Check();
  paper.Check();
  gate.Check();
  const auto require = [](bool is_good, const char* what) {
    if (!is_good) throw std::invalid_argument(what);
  };
  require(model_px >= 0.0 && model_px <= 100.0, "model_px: in [0, 100]");
  require(model_rad >= 0.0 && model_rad <= 1.0, "model_rad: in [0, 1]");
  require(max_prior_rad > 0.0 && max_prior_rad <= kPi,
          "max_prior_rad: in (0, pi]");
  require(end_m >= 0.0, "end_m: must not be negative");
}

double RegularProbabilityOf(const CorridorEstimate& estimate,
                            const CorridorPrior& prior,
                            const GateOptions& options) {
  const Eigen::Vector2d residual(
      estimate.y.value_or(0.0) - prior.X_LR.y,
      WrapAngle(estimate.heading.value() - prior.X_LR.heading));
  const Eigen::Matrix2d P = prior.covariance.bottomRightCorner<2, 2>();
  Innovation innovation;
  if (estimate.y) {
    innovation.residual = residual;
    innovation.HPH = P;
    innovation.R = estimate.covariance;
  } else {
    innovation.residual = residual.tail<1>();
    innovation.HPH = FixMatrix::Constant(1, 1, P(1, 1));
    innovation.R = FixMatrix::Constant(1, 1, estimate.covariance(1, 1));
  }
  return RegularProbability(
      {false, estimate.y.has_value(), true}, innovation, options);
}

CorridorEstimate EstimateCorridor(const CorridorView& view,
                                  const LineSet& lines,
                                  const CorridorGeometry& corridor,
                                  const std::optional<CorridorPrior>& prior,
                                  const CorridorTrackerOptions& options) {
  CorridorEstimate estimate;
  std::vector<SeenLine> seen;
  for (const LineSegment& segment : lines.segments) {
    estimate.lines.push_back({segment, CorridorEdge::kNone, false});
    seen.push_back(SeenLineOf(segment, options.model_px, options.model_rad));
  }
  const bool is_at_end = IsAtEnd(corridor, prior, options.end_m);
  if (seen.empty()) {
    SayNo(is_at_end ? CorridorStatus::kEnds : CorridorStatus::kNoLines,
          is_at_end ? "the corridor ends ahead" : "no lines in the image",
          &estimate);
    return estimate;
  }
  const auto prior_heading = HeadingPriorOf(prior, options.max_prior_rad);
  const auto heading = FindHeading(view, lines, seen, prior_heading, options);
  if (!heading) {
    SayNo(is_at_end ? CorridorStatus::kEnds : CorridorStatus::kNoVanishingPoint,
          is_at_end ? "the corridor ends ahead"
                    : "lines do not agree on the corridor's direction",
          &estimate);
    return estimate;
  }
  NoteFamilies(view, *heading, &estimate);
  if (!prior_heading) {
    estimate.p_regular = 1.0;
    SayNo(CorridorStatus::kAmbiguous,
          "either way along the corridor: no heading known well enough before",
          &estimate);
    return estimate;
  }
  const bool stands_out = StandsOut(*heading, options.heading);
  if (!corridor.width && stands_out) {
    NotePose(PoseWithoutPosition(*heading, estimate.lines, options), &estimate);
    SayNo(CorridorStatus::kUnknownSize,
          "the corridor's width is not known: heading alone",
          &estimate);
  } else {
    JointPose pose;
    if (corridor.width) {
      pose = FindPose(view, corridor, seen, *heading, prior, options);
    }
    if (!pose.y && !stands_out) {
      SayNo(
          is_at_end ? CorridorStatus::kEnds : CorridorStatus::kNoVanishingPoint,
          "the corridor's direction might nearly as well be another",
          &estimate);
      return estimate;
    }
    NotePose(pose, &estimate);
    estimate.status = CorridorStatus::kAccepted;
    if (!pose.y) {
      SayNo(is_at_end ? CorridorStatus::kEnds : CorridorStatus::kNoPosition,
            pose.reason,
            &estimate);
    }
  }
  estimate.p_regular = RegularProbabilityOf(estimate, *prior, options.gate);
  // A heading alone is tested as well.
  if (!(estimate.p_regular > options.gate.min_regular)) {
    SayNo(CorridorStatus::kFaulty,
          "too far from what was expected to be a regular answer",
          &estimate);
  }
  return estimate;
}

CorridorTracker::CorridorTracker(const CameraView& camera,
                                 const CorridorTrackerOptions& options)
    : options_(options), lines_(camera, options.lines) {
  options.Check();
}

CorridorEstimate CorridorTracker::Estimate(
    const cv::Mat1b& image,
    const Eigen::Isometry3d& X_RC,
    const CorridorGeometry& corridor,
    const std::optional<CorridorPrior>& prior) {
  return EstimateFrom(FindLines(image), X_RC, corridor, prior);
}

LineSet CorridorTracker::FindLines(const cv::Mat1b& image) {
  return lines_.Find(image);
}

CorridorEstimate CorridorTracker::EstimateFrom(
    const LineSet& lines,
    const Eigen::Isometry3d& X_RC,
    const CorridorGeometry& corridor,
    const std::optional<CorridorPrior>& prior) const {
  CorridorEstimate estimate =
      EstimateCorridor({lines_.intrinsics(), lines_.view().size, X_RC},
                       lines,
                       corridor,
                       prior,
                       options_);
  // A line of which an end is nowhere in the camera's image stays as it is.
  for (CorridorLine& line : estimate.lines) {
    const auto a = lines_.CameraPixel(line.line.a);
    const auto b = lines_.CameraPixel(line.line.b);
    if (!a || !b) continue;
    line.line.a = *a;
    line.line.b = *b;
  }
  if (estimate.vanishing_point) {
    estimate.vanishing_point = lines_.CameraPixel(*estimate.vanishing_point);
  }
  return estimate;
}

}  // namespace waymark
