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

constexpr std::array kEdges = {CorridorEdge::kFloorLeft,
                               CorridorEdge::kFloorRight,
                               CorridorEdge::kCeilingLeft,
                               CorridorEdge::kCeilingRight,
                               CorridorEdge::kSkirtingLeft,
                               CorridorEdge::kSkirtingRight};

// A line, taken for an edge, puts the robot at y.
struct Candidate {
  std::size_t line = 0;
  CorridorEdge edge = CorridorEdge::kNone;
  double y = 0.0;
  double sigma = 0.0;
};

// The edge lies on the side of the camera where the line is seen.
bool IsInQuadrant(const Eigen::Vector2d& ray, const Eigen::Vector2d& to_edge) {
  return ray.x() * to_edge.x() > 0.0 && ray.y() * to_edge.y() > 0.0;
}

// Angle of a line about the vanishing point: by its direction, and by where its
// middle lies; sigma of both together, as seen from its middle across it.
double SigmaAcross(const SeenLine& line, const Eigen::Vector3d& vanishing) {
  // Distance to the vanishing point; infinite where that is at infinity.
  const double way =
      (vanishing.head<2>() - vanishing.z() * line.middle).norm() /
      std::abs(vanishing.z());
  const double by_direction = line.sigma_rad * way;
  return 1.0 / std::hypot(1.0 / line.sigma_px, 1.0 / by_direction);
}

std::vector<Candidate> CandidatesOf(const CorridorView& view,
                                    const CorridorGeometry& corridor,
                                    std::span<const SeenLine> lines,
                                    const AxisHeading& heading) {
  std::vector<Candidate> candidates;
  const Eigen::Vector3d vanishing = view.PixelOf(AxisIn(heading.heading));
  const Eigen::Vector3d across = AcrossIn(heading.heading);
  const Eigen::Vector2d lever = CameraIn(view, 0.0, heading.heading);
  const double half = 0.5 * corridor.width.value();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (heading.families[i] != LineFamily::kAlong) continue;
    // Its ray in the cross-section (y, z), from the camera.
    const auto ray_at = [&](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
      const Eigen::Vector3d ray_R = view.RayOf(pixel);
      return {ray_R.dot(across), ray_R.z()};
    };
    const Eigen::Vector2d ray = ray_at(lines[i].middle);
    const double sigma_px = SigmaAcross(lines[i], vanishing);
    const Eigen::Vector2d normal(-lines[i].direction.y(),
                                 lines[i].direction.x());
    const Eigen::Vector2d beside = ray_at(lines[i].middle + normal);
    for (const CorridorEdge edge : kEdges) {
      const auto place = PlaceOf(edge, corridor);
      if (!place) continue;
      const double up = place->y() - lever.y();
      if (!(up * ray.y() > 0.0)) continue;
      // Equation 3: the camera's y is where the ray, back from the edge, has
      // come down (or up) to the camera's height.
      const double y_C = place->x() - up * ray.x() / ray.y();
      if (!(std::abs(y_C) < half) ||
          !IsInQuadrant(ray, {place->x() - y_C, up})) {
        continue;
      }
      const double by_pixel =
          std::abs(up * (beside.x() / beside.y() - ray.x() / ray.y()));
      candidates.push_back({i, edge, y_C - lever.x(), by_pixel * sigma_px});
    }
  }
  return candidates;
}

std::size_t IndexOf(CorridorEdge edge) {
  return static_cast<std::size_t>(
      std::find(kEdges.begin(), kEdges.end(), edge) - kEdges.begin());
}

// Logarithm of the likelihood of a position over that of lines at random.
class Evidence {
 public:
  Evidence(std::span<const Candidate> candidates,
           double width,
           const std::optional<LateralPrior>& prior,
           const JointPoseOptions& options)
      : candidates_(candidates),
        prior_(prior),
        width_(width),
        odds_(options.edge_share / (1.0 - options.edge_share)),
        max_edge_(options.max_edge_evidence),
        scatter_m_(options.scatter_m) {}

  [[nodiscard]] double At(double y) const {
    std::array<double, kEdges.size()> of_edge{};
    // Candidates of one line stand together; it counts for its likeliest edge.
    for (std::size_t i = 0; i < candidates_.size();) {
      const std::size_t line = candidates_[i].line;
      double likelihood = 0.0;
      double most = 0.0;
      CorridorEdge edge = kEdges[0];
      for (; i < candidates_.size() && candidates_[i].line == line; ++i) {
        const double sigma = std::hypot(candidates_[i].sigma, scatter_m_);
        const double off = (y - candidates_[i].y) / sigma;
        if (std::abs(off) > 6.0) continue;
        const double own = std::exp(-0.5 * off * off) * width_ /
                           (sigma * std::sqrt(2.0 * kPi));
        likelihood += own;
        if (own <= most) continue;
        most = own;
        edge = candidates_[i].edge;
      }
      of_edge[IndexOf(edge)] += std::log1p(odds_ * likelihood);
    }
    double sum = prior_ ? LogPrior(y) : 0.0;
    for (const double evidence : of_edge) sum += std::min(evidence, max_edge_);
    return sum;
  }

 private:
  // Robust: a prior may be wrong altogether.
  [[nodiscard]] double LogPrior(double y) const {
    constexpr double kWrong = 0.02;
    const double sigma = std::hypot(prior_->sigma, 0.02);
    const double off = (y - prior_->y) / sigma;
    return std::log((1.0 - kWrong) * std::exp(-0.5 * off * off) * width_ /
                        (sigma * std::sqrt(2.0 * kPi)) +
                    kWrong);
  }

  std::span<const Candidate> candidates_;
  std::optional<LateralPrior> prior_;
  double width_;
  double odds_;
  double max_edge_;
  double scatter_m_;
};

struct Peak {
  double y = 0.0;
  double evidence = -std::numeric_limits<double>::infinity();
  double rival = -std::numeric_limits<double>::infinity();
};

Peak BestOf(const Evidence& evidence, double half, double step) {
  std::vector<double> values;
  const int reach = static_cast<int>(half / step);
  for (int i = -reach; i <= reach; ++i) values.push_back(evidence.At(i * step));
  const auto best = std::max_element(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(best - values.begin());
  Peak peak;
  peak.evidence = *best;
  peak.y = (static_cast<double>(at) - reach) * step;
  // A rival is another peak: beyond a valley, not the same one's foot.
  const auto climb = [&](std::size_t from, int direction) {
    double lowest = values[from];
    for (auto i = static_cast<std::ptrdiff_t>(from);
         i >= 0 && i < static_cast<std::ptrdiff_t>(values.size());
         i += direction) {
      const double value = values[static_cast<std::size_t>(i)];
      lowest = std::min(lowest, value);
      if (value > lowest + 1.0) peak.rival = std::max(peak.rival, value);
    }
  };
  climb(at, 1);
  climb(at, -1);
  return peak;
}

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
    const double weight =
        TukeyWeight(r->squaredNorm(), std::sqrt(2.0) * options_.max_sigmas);
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
    const double weight = TukeyWeight(r * r, options_.max_sigmas);
    A(1, 1) += weight * slope * slope;
    b(1) += weight * slope * r;
  }

  const CorridorView& view_;
  const CorridorGeometry& corridor_;
  const JointPoseOptions& options_;
};

// Each line's edge at this position; kAlong or kNone where it is none.
void Assign(std::span<const Candidate> candidates,
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
  for (const Candidate& candidate : candidates) {
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

// Why what was found does not do; empty where it does.
std::string FaultOf(std::span<const SeenLine> lines,
                    const std::vector<CorridorEdge>& edges,
                    const JointPoseOptions& options) {
  double seen_px = 0.0;
  std::array<bool, kEdges.size()> is_seen{};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!IsEdge(edges[i])) continue;
    seen_px += lines[i].length;
    const auto at = std::find(kEdges.begin(), kEdges.end(), edges[i]);
    is_seen[static_cast<std::size_t>(at - kEdges.begin())] = true;
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
  const auto require = [](bool is_good, const char* what) {
    if (!is_good) throw std::invalid_argument(what);
  };
  require(edge_share > 0.0 && edge_share < 1.0, "edge_share: in (0, 1)");
  require(step_m >= 1e-4 && step_m <= 0.1, "step_m: in [0.0001, 0.1]");
  require(max_sigmas > 0.0, "max_sigmas: must be positive");
  require(max_edge_evidence > 0.0, "max_edge_evidence: must be positive");
  require(scatter_m > 0.0, "scatter_m: must be positive");
  require(floor_m > 0.0, "floor_m: must be positive");
  require(floor_rad > 0.0, "floor_rad: must be positive");
  require(max_sigma_m > 0.0, "max_sigma_m: must be positive");
  require(min_edges >= 1, "min_edges: at least 1");
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
  std::vector<Candidate> candidates = CandidatesOf(view, corridor, lines, at);
  const double width = corridor.width.value();
  const Peak peak = BestOf(
      Evidence(candidates, width, prior, options), 0.5 * width, options.step_m);
  Assign(candidates,
         at,
         peak.y,
         options.max_sigmas,
         options.scatter_m,
         &pose.edges);
  if (!(peak.evidence >= options.min_evidence)) {
    pose.reason = "lines do not agree on a position";
    return pose;
  }
  if (peak.evidence - peak.rival < options.min_margin) {
    pose.reason = "two positions are equally likely";
    return pose;
  }
  Eigen::Vector2d state(peak.y, heading.heading);
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  constexpr int kNumIterations = 6;  // Edges are looked at anew in each.
  for (int k = 0; k < kNumIterations; ++k) {
    at.heading = state(1);
    candidates = CandidatesOf(view, corridor, lines, at);
    Assign(candidates,
           at,
           state(0),
           options.max_sigmas,
           options.scatter_m,
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
  pose.y = state(0);
  pose.heading = WrapAngle(state(1));
  pose.covariance = covariance;
  return pose;
}

}  // namespace waymark
