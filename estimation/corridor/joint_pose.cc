#include "estimation/corridor/joint_pose.h"

#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

namespace waymark {
namespace {

// What a line is off from its edge at (y, heading): across its middle, and in
// direction, both in sigmas.
std::optional<Eigen::Vector2d> EdgeResidual(const CorridorView& view,
                                            const Eigen::Vector2d& place,
                                            const SeenLine& line,
                                            const Eigen::Vector2d& state) {
  const auto image = ImageOfEdge(view, place, state(0), state(1));
  if (!image) return std::nullopt;
  const double offset = image->dot(line.middle.homogeneous()) / line.sigma_px;
  // Sine of the angle between them.
  const double turn = image->head<2>().dot(line.direction) / line.sigma_rad;
  return Eigen::Vector2d(offset, turn);
}

double TukeyWeight(double squared, double max_sigmas) {
  const double share = squared / (max_sigmas * max_sigmas);
  return share >= 1.0 ? 0.0 : (1.0 - share) * (1.0 - share);
}

// Normal equations of all lines about a state (y, heading).
class Normals {
 public:
  Normals(const CorridorView& view,
          const CorridorGeometry& corridor,
          const JointPoseOptions& options)
      : view_(view), corridor_(corridor), options_(options) {}

  void Add(const SeenLine& line,
           LineFamily family,
           CorridorEdge edge,
           const Eigen::Vector2d& state) {
    if (const auto place = PlaceOf(edge, corridor_)) {
      AddEdge(line, *place, state);
    } else if (family != LineFamily::kOther) {
      AddVanishing(line, family, state);
    }
  }

  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();

 private:
  static constexpr double kDelta = 1e-6;

  void AddEdge(const SeenLine& line,
               const Eigen::Vector2d& place,
               const Eigen::Vector2d& state) {
    const auto r = EdgeResidual(view_, place, line, state);
    if (!r) return;
    Eigen::Matrix2d J;
    for (int k = 0; k < 2; ++k) {
      const auto ahead = EdgeResidual(
          view_, place, line, state + kDelta * Eigen::Vector2d::Unit(k));
      if (!ahead) return;
      J.col(k) = (*ahead - *r) / kDelta;
    }
    const double weight = TukeyWeight(
        r->squaredNorm(), std::sqrt(2.0) * options_.evidence.max_sigmas);
    A += weight * J.transpose() * J;
    b += weight * J.transpose() * *r;
  }

  void AddVanishing(const SeenLine& line,
                    LineFamily family,
                    const Eigen::Vector2d& state) {
    const auto residual = [&](double heading) {
      return VanishingResidual(
          line,
          view_.PixelOf(family == LineFamily::kAlong ? AxisIn(heading)
                                                     : AcrossIn(heading)));
    };
    const double r = residual(state(1));
    const double slope = (residual(state(1) + kDelta) - r) / kDelta;
    const double weight = TukeyWeight(r * r, options_.evidence.max_sigmas);
    A(1, 1) += weight * slope * slope;
    b(1) += weight * slope * r;
  }

  const CorridorView& view_;
  const CorridorGeometry& corridor_;
  const JointPoseOptions& options_;
};

// Each line's edge at this position; kAlong or kNone where it is none.
void Assign(std::span<const EdgeCandidate> candidates,
            const AxisHeading& heading,
            double y,
            double max_sigmas,
            double scatter_m,
            std::vector<CorridorEdge>* edges) {
  std::vector<double> nearest(edges->size(),
                              std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < edges->size(); ++i) {
    (*edges)[i] = heading.families[i] == LineFamily::kAlong
                      ? CorridorEdge::kAlong
                      : CorridorEdge::kNone;
  }
  for (const EdgeCandidate& candidate : candidates) {
    const double off =
        std::abs(candidate.y - y) / std::hypot(candidate.sigma, scatter_m);
    if (off > max_sigmas || off >= nearest[candidate.line]) continue;
    nearest[candidate.line] = off;
    (*edges)[candidate.line] = candidate.edge;
  }
}

bool IsEdge(CorridorEdge edge) {
  return edge != CorridorEdge::kNone && edge != CorridorEdge::kAlong;
}

bool IsLeft(CorridorEdge edge) {
  return edge == CorridorEdge::kFloorLeft ||
         edge == CorridorEdge::kCeilingLeft ||
         edge == CorridorEdge::kSkirtingLeft;
}

// Whether all edges that lines were taken for are of one wall.
bool IsOneWall(const std::vector<CorridorEdge>& edges) {
  bool has_left = false;
  bool has_right = false;
  for (const CorridorEdge edge : edges) {
    if (!IsEdge(edge)) continue;
    (IsLeft(edge) ? has_left : has_right) = true;
  }
  return !(has_left && has_right);
}

// Of the lines' middles from their edges, px, by the lines' lengths.
double RmsOf(const CorridorView& view,
             const CorridorGeometry& corridor,
             std::span<const SeenLine> lines,
             const std::vector<CorridorEdge>& edges,
             const Eigen::Vector2d& state) {
  double sum = 0.0;
  double length = 0.0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!IsEdge(edges[i])) continue;
    const auto image = ImageOfEdge(
        view, PlaceOf(edges[i], corridor).value(), state(0), state(1));
    if (!image) continue;
    const double off = image->dot(lines[i].middle.homogeneous());
    sum += lines[i].length * off * off;
    length += lines[i].length;
  }
  return length > 0.0 ? std::sqrt(sum / length) : 0.0;
}

// Why what was found does not do; empty where it does.
std::string FaultOf(std::span<const SeenLine> lines,
                    const std::vector<CorridorEdge>& edges,
                    const JointPoseOptions& options) {
  double seen_px = 0.0;
  std::array<bool, kCorridorEdges.size()> is_seen{};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!IsEdge(edges[i])) continue;
    seen_px += lines[i].length;
    const auto at =
        std::find(kCorridorEdges.begin(), kCorridorEdges.end(), edges[i]);
    is_seen[static_cast<std::size_t>(at - kCorridorEdges.begin())] = true;
  }
  const auto num = std::count(is_seen.begin(), is_seen.end(), true);
  if (num < options.min_edges) {
    return "only " + std::to_string(num) + " of the corridor's edges seen";
  }
  if (seen_px < options.min_seen_px) {
    return "only " + std::to_string(static_cast<int>(seen_px)) +
           " px of the corridor's edges seen";
  }
  return "";
}

}  // namespace

void JointPoseOptions::Check() const {
  evidence.Check();
  const auto require = [](bool is_good, const char* what) {
    if (!is_good) throw std::invalid_argument(what);
  };
  require(floor_m > 0.0, "floor_m: must be positive");
  require(floor_rad > 0.0, "floor_rad: must be positive");
  require(max_sigma_m > 0.0, "max_sigma_m: must be positive");
  require(min_edges >= 1, "min_edges: at least 1");
  require(min_evidence >= 0.0, "min_evidence: must not be negative");
  require(min_margin >= 0.0, "min_margin: must not be negative");
  require(min_margin_one_wall >= 0.0,
          "min_margin_one_wall: must not be negative");
  require(max_rms_one_wall_px > 0.0, "max_rms_one_wall_px: must be positive");
  require(min_seen_px >= 0.0, "min_seen_px: must not be negative");
}

JointPose EstimateJointPose(const CorridorView& view,
                            const CorridorGeometry& corridor,
                            std::span<const SeenLine> lines,
                            const AxisHeading& heading,
                            const std::optional<LateralPrior>& prior,
                            const JointPoseOptions& options) {
  JointPose pose;
  pose.heading = heading.heading;
  pose.covariance(1, 1) =
      heading.sigma * heading.sigma + options.floor_rad * options.floor_rad;
  pose.edges.assign(lines.size(), CorridorEdge::kNone);
  AxisHeading at = heading;
  std::vector<EdgeCandidate> candidates =
      FindEdgeCandidates(view, corridor, lines, at);
  const LateralPeak peak = FindLateralPeak(view,
                                           corridor,
                                           lines,
                                           candidates,
                                           heading.heading,
                                           prior,
                                           options.evidence);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (heading.families[i] == LineFamily::kAlong) {
      pose.edges[i] = CorridorEdge::kAlong;
    }
  }
  if (!(peak.evidence >= options.min_evidence)) {
    pose.reason = "lines do not agree on a position";
    return pose;
  }
  if (!(peak.evidence - peak.rival >= options.min_margin)) {
    pose.reason = "two positions are equally likely";
    return pose;
  }
  Eigen::Vector2d state(peak.y, heading.heading);
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  constexpr int kNumIterations = 6;  // Edges are looked at anew in each.
  for (int k = 0; k < kNumIterations; ++k) {
    at.heading = state(1);
    candidates = FindEdgeCandidates(view, corridor, lines, at);
    Assign(candidates,
           at,
           state(0),
           options.evidence.max_sigmas,
           options.evidence.scatter_m,
           &pose.edges);
    pose.reason = FaultOf(lines, pose.edges, options);
    if (!pose.reason.empty()) return pose;
    Normals normals(view, corridor, options);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      normals.Add(lines[i], heading.families[i], pose.edges[i], state);
    }
    information = normals.A;
    const Eigen::LLT<Eigen::Matrix2d> factor(information);
    if (factor.info() != Eigen::Success) {
      pose.reason = "the edges seen do not say where";
      return pose;
    }
    state -= factor.solve(normals.b);
  }
  const Eigen::Vector2d floor(options.floor_m, options.floor_rad);
  const Eigen::Matrix2d covariance =
      Eigen::Matrix2d(information.llt().solve(Eigen::Matrix2d::Identity())) +
      Eigen::Matrix2d(floor.cwiseAbs2().asDiagonal());
  // Refining moves it by a step or two; elsewhere it is another peak's.
  const bool is_near = std::abs(state(0) - peak.y) < 0.05;
  if (!is_near ||
      !(covariance(0, 0) < options.max_sigma_m * options.max_sigma_m)) {
    pose.reason = "the edges seen do not say where exactly";
    return pose;
  }
  if (IsOneWall(pose.edges)) {
    const double margin = peak.evidence - peak.rival;
    if (!(margin >= options.min_margin_one_wall) ||
        RmsOf(view, corridor, lines, pose.edges, state) >
            options.max_rms_one_wall_px) {
      pose.reason = "the edges of one wall alone do not stand out enough";
      return pose;
    }
  }
  pose.y = state(0);
  pose.heading = WrapAngle(state(1));
  pose.covariance = covariance;
  return pose;
}

}  // namespace waymark
