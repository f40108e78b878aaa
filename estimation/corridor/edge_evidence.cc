#include "estimation/corridor/edge_evidence.h"

#include "estimation/corridor/lateral_candidates.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

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

bool IsCeiling(std::size_t edge) {
  return kCorridorEdges[edge] == CorridorEdge::kCeilingLeft ||
         kCorridorEdges[edge] == CorridorEdge::kCeilingRight;
}

// Of [a, b], in the camera's frame, what lies on the positive side of a plane
// through the camera; false where nothing does.
bool Clip(const Eigen::Vector3d& normal,
          double offset,
          Eigen::Vector3d* a,
          Eigen::Vector3d* b) {
  const double at_a = normal.dot(*a) - offset;
  const double at_b = normal.dot(*b) - offset;
  if (at_a < 0.0 && at_b < 0.0) return false;
  if (at_a < 0.0) *a += (at_a / (at_a - at_b)) * (*b - *a);
  if (at_b < 0.0) *b += (at_b / (at_b - at_a)) * (*a - *b);
  return true;
}

double LogPrior(const LateralPrior& prior, double width, double y) {
  // Robust: a prior may be wrong altogether.
  constexpr double kWrong = 0.02;
  const double sigma = std::hypot(prior.sigma, 0.02);
  const double off = (y - prior.y) / sigma;
  return std::log((1.0 - kWrong) * std::exp(-0.5 * off * off) * width /
                      (sigma * std::sqrt(2.0 * kPi)) +
                  kWrong);
}

// Logarithm of the likelihood that so much of an edge is covered, over that of
// a place where no edge is.
double LogRatio(double coverage,
                bool is_ceiling,
                const EdgeEvidenceOptions& options) {
  constexpr double kNone = 0.05;  // Less is as good as nothing.
  const double missing =
      is_ceiling ? options.ceiling_missing : options.floor_missing;
  if (coverage < kNone) return std::log(missing / (1.0 - options.chance));
  // More is likelier for an edge, less for what only happens to lie there.
  const double edge = 2.0 * coverage;
  const double rate = 1.0 / options.chance_coverage;
  const double other =
      rate * std::exp(-rate * coverage) / (1.0 - std::exp(-rate));
  return std::log((1.0 - missing) * edge / (options.chance * other));
}

// Length of a union of intervals, which is emptied.
double UnionOf(std::vector<std::pair<double, double>>* intervals) {
  std::sort(intervals->begin(), intervals->end());
  double length = 0.0;
  double end = 0.0;
  for (const auto& [from, to] : *intervals) {
    const double begin = std::max(from, end);
    if (to <= begin) continue;
    length += to - begin;
    end = to;
  }
  intervals->clear();
  return length;
}

}  // namespace

void EdgeEvidenceOptions::Check() const {
  const auto require = [](bool is_good, const char* what) {
    if (!is_good) throw std::invalid_argument(what);
  };
  const auto is_share = [](double p) { return p > 0.0 && p < 1.0; };
  require(is_share(floor_missing), "floor_missing: in (0, 1)");
  require(is_share(ceiling_missing), "ceiling_missing: in (0, 1)");
  require(is_share(chance), "chance: in (0, 1)");
  require(is_share(chance_coverage), "chance_coverage: in (0, 1)");
  require(reach_m > 0.0, "reach_m: must be positive");
  require(min_length_px > 0.0, "min_length_px: must be positive");
  require(max_sigmas > 0.0, "max_sigmas: must be positive");
  require(scatter_m > 0.0, "scatter_m: must be positive");
}

std::vector<EdgeCandidate> FindEdgeCandidates(const CorridorView& view,
                                              const CorridorGeometry& corridor,
                                              std::span<const SeenLine> lines,
                                              const AxisHeading& heading) {
  // The heading is refined only afterwards: 0.05 degrees.
  constexpr double kHeadingPx = 0.4;
  std::vector<EdgeCandidate> candidates;
  const Eigen::Vector3d vanishing = view.PixelOf(AxisIn(heading.heading));
  const Eigen::Vector2d lever = CameraIn(view, 0.0, heading.heading);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (heading.families[i] != LineFamily::kAlong) continue;
    const Eigen::Vector2d ray =
        RayAcross(view, lines[i].middle, heading.heading);
    const double sigma_px =
        std::hypot(SigmaAcross(lines[i], vanishing), kHeadingPx);
    const Eigen::Vector2d normal(-lines[i].direction.y(),
                                 lines[i].direction.x());
    const Eigen::Vector2d beside =
        RayAcross(view, lines[i].middle + normal, heading.heading);
    for (const CorridorEdge edge : kCorridorEdges) {
      const auto place = PlaceOf(edge, corridor);
      if (!place) continue;
      const auto y_C =
          LateralOfRay(ray, *place, lever.y(), corridor.width.value());
      if (!y_C) continue;
      const double by_pixel =
          std::abs((place->y() - lever.y()) *
                   (beside.x() / beside.y() - ray.x() / ray.y()));
      candidates.push_back({i, edge, *y_C - lever.x(), by_pixel * sigma_px});
    }
  }
  return candidates;
}

std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> VisibleEdge(
    const CorridorView& view,
    const Eigen::Vector2d& place,
    double y,
    double heading,
    double from,
    double to) {
  constexpr double kNear = 0.05;  // m before the camera.
  const Eigen::Vector3d beside = (place.x() - y) * AcrossIn(heading) +
                                 place.y() * Eigen::Vector3d::UnitZ();
  const Eigen::Isometry3d X_CR = view.X_RC.inverse();
  Eigen::Vector3d a = X_CR * (beside + from * AxisIn(heading));
  Eigen::Vector3d b = X_CR * (beside + to * AxisIn(heading));
  const Intrinsics& K = view.intrinsics;
  const double right = view.size.width - 1;
  const double bottom = view.size.height - 1;
  // Planes through the camera's centre and the image's borders.
  if (!Clip({0.0, 0.0, 1.0}, kNear, &a, &b) ||
      !Clip({K.fx, 0.0, K.cx}, 0.0, &a, &b) ||
      !Clip({-K.fx, 0.0, right - K.cx}, 0.0, &a, &b) ||
      !Clip({0.0, K.fy, K.cy}, 0.0, &a, &b) ||
      !Clip({0.0, -K.fy, bottom - K.cy}, 0.0, &a, &b)) {
    return std::nullopt;
  }
  const auto pixel = [&K](const Eigen::Vector3d& p) {
    return Eigen::Vector2d(K.fx * p.x() / p.z() + K.cx,
                           K.fy * p.y() / p.z() + K.cy);
  };
  return std::pair(pixel(a), pixel(b));
}

namespace {

// Evidence for positions, one after another.
class Evidence {
 public:
  Evidence(const CorridorView& view,
           const CorridorGeometry& corridor,
           std::span<const SeenLine> lines,
           double heading,
           const std::optional<LateralPrior>& prior,
           const EdgeEvidenceOptions& options)
      : view_(view),
        width_(corridor.width.value()),
        lines_(lines),
        heading_(heading),
        prior_(prior),
        options_(options),
        from_(-options.reach_m),
        to_(options.reach_m),
        farthest_from_(-options.reach_m),
        farthest_to_(options.reach_m),
        of_line_(lines.size(), kNowhere) {
    if (prior) {
      // What is there for certain, almost; but half the way to each end always.
      // An edge is mostly seen near by: where it ends in truth, if the robot is
      // farther along than believed, changes little of its length in the image.
      const double margin = 2.0 * prior->sigma_x;
      const double behind = corridor.x_min - prior->x;
      const double ahead = corridor.x_max - prior->x;
      from_ = std::max(from_, std::min(behind + margin, 0.5 * behind));
      to_ = std::min(to_, std::max(ahead - margin, 0.5 * ahead));
      farthest_from_ = std::max(farthest_from_, behind - margin);
      farthest_to_ = std::min(farthest_to_, ahead + margin);
    }
    for (std::size_t i = 0; i < kCorridorEdges.size(); ++i) {
      places_[i] = PlaceOf(kCorridorEdges[i], corridor);
    }
  }

  // `near`: candidates that may belong to a robot at y.
  LateralPeak At(double y, std::span<const EdgeCandidate> near) {
    LateralPeak peak;
    peak.y = y;
    peak.evidence = prior_ ? LogPrior(*prior_, width_, y) : 0.0;
    TakeNearest(y, near);
    for (std::size_t i = 0; i < kCorridorEdges.size(); ++i) {
      const auto match = MatchOf(i, y);
      peak.coverage[i] = match ? match->coverage : -1.0;
      if (!match) continue;
      // Lines that fit so badly are better taken for others; nothing speaks
      // against an edge that may have ended before.
      peak.evidence += std::max(
          LogRatio(match->coverage, IsCeiling(i), options_) - match->misfit,
          match->is_certain ? LogRatio(0.0, IsCeiling(i), options_) : 0.0);
    }
    return peak;
  }

 private:
  struct Match {
    double coverage = 0.0;
    double misfit = 0.0;      // Half the mean squared sigmas.
    bool is_certain = false;  // That the edge is there.
  };

  struct Taken {
    std::size_t line = 0;
    CorridorEdge edge = CorridorEdge::kNone;
    double off = 0.0;  // In sigmas.
  };

  // A line is one edge at most: of those that it may be, the nearest.
  void TakeNearest(double y, std::span<const EdgeCandidate> near) {
    for (const Taken& taken : taken_) of_line_[taken.line] = kNowhere;
    taken_.clear();
    for (const EdgeCandidate& candidate : near) {
      const double off = std::abs(y - candidate.y) /
                         std::hypot(candidate.sigma, options_.scatter_m);
      if (off > options_.max_sigmas) continue;
      std::size_t& at = of_line_[candidate.line];
      if (at == kNowhere) {
        at = taken_.size();
        taken_.push_back({candidate.line, candidate.edge, off});
      } else if (off < taken_[at].off) {
        taken_[at] = {candidate.line, candidate.edge, off};
      }
    }
  }

  std::optional<Match> MatchOf(std::size_t edge, double y) {
    if (!places_[edge]) return std::nullopt;
    bool is_certain = true;
    auto visible = LongEnough(edge, y, from_, to_);
    if (!visible) {
      // Where the corridor ends its edges are short; the longer stretch up to
      // where it may end can be there. Positions at which nothing is expected
      // would else have no say.
      is_certain = false;
      visible = LongEnough(edge, y, farthest_from_, farthest_to_);
    }
    if (!visible) return std::nullopt;
    const auto& [a, b] = *visible;
    const double length = (b - a).norm();
    const Eigen::Vector2d along = (b - a) / length;
    double sum = 0.0;
    double weight = 0.0;
    for (const Taken& taken : taken_) {
      if (taken.edge != kCorridorEdges[edge]) continue;
      const SeenLine& line = lines_[taken.line];
      const double middle = along.dot(line.middle - a);
      const double from = std::max(0.0, middle - 0.5 * line.length);
      const double to = std::min(length, middle + 0.5 * line.length);
      if (to <= from) continue;
      covered_.emplace_back(from, to);
      sum += (to - from) * taken.off * taken.off;
      weight += to - from;
    }
    if (covered_.empty()) return Match{0.0, 0.0, is_certain};
    return Match{UnionOf(&covered_) / length, 0.5 * sum / weight, is_certain};
  }

  // The stretch of an edge in the image, where it is as long as it must be.
  [[nodiscard]] std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>>
  LongEnough(std::size_t edge, double y, double from, double to) const {
    if (to <= from) return std::nullopt;
    const auto visible =
        VisibleEdge(view_, places_[edge].value(), y, heading_, from, to);
    if (!visible ||
        (visible->second - visible->first).norm() < options_.min_length_px) {
      return std::nullopt;
    }
    return visible;
  }

  const CorridorView& view_;
  double width_;
  std::span<const SeenLine> lines_;
  double heading_;
  std::optional<LateralPrior> prior_;
  const EdgeEvidenceOptions& options_;
  double from_;  // Along the axis, m from the robot: where edges are for
  double to_;    // certain, and where they may be.
  double farthest_from_;
  double farthest_to_;
  std::array<std::optional<Eigen::Vector2d>, kCorridorEdges.size()> places_;
  static constexpr auto kNowhere = static_cast<std::size_t>(-1);
  std::vector<Taken> taken_;
  std::vector<std::size_t> of_line_;  // Index in taken_, or kNowhere.
  std::vector<std::pair<double, double>> covered_;
};

// The best of those that a valley or a gap parts from the peak.
double RivalOf(const std::vector<LateralPeak>& peaks, std::size_t best) {
  constexpr double kGap = 0.02;   // m; nothing in between says anything.
  constexpr double kSame = 0.02;  // m; refining is to tell these apart.
  double rival = -std::numeric_limits<double>::infinity();
  const auto climb = [&](int direction) {
    double lowest = peaks[best].evidence;
    double before = peaks[best].y;
    for (auto i = static_cast<std::ptrdiff_t>(best) + direction;
         i >= 0 && i < static_cast<std::ptrdiff_t>(peaks.size());
         i += direction) {
      const LateralPeak& peak = peaks[static_cast<std::size_t>(i)];
      if (std::abs(peak.y - before) > kGap) {
        lowest = -std::numeric_limits<double>::infinity();
      }
      before = peak.y;
      lowest = std::min(lowest, peak.evidence);
      if (std::abs(peak.y - peaks[best].y) < kSame) continue;
      if (peak.evidence > lowest + 1.0) rival = std::max(rival, peak.evidence);
    }
  };
  climb(1);
  climb(-1);
  return rival;
}

}  // namespace

LateralPeak FindLateralPeak(const CorridorView& view,
                            const CorridorGeometry& corridor,
                            std::span<const SeenLine> lines,
                            std::span<const EdgeCandidate> candidates,
                            double heading,
                            const std::optional<LateralPrior>& prior,
                            const EdgeEvidenceOptions& options) {
  // Known worse, a candidate neither says where nor what is seen there.
  constexpr double kMaxSigma = 0.03;
  constexpr double kStep = 0.001;  // Closer positions are looked at once.
  std::vector<EdgeCandidate> sorted;
  for (const EdgeCandidate& candidate : candidates) {
    if (candidate.sigma < kMaxSigma) sorted.push_back(candidate);
  }
  std::stable_sort(
      sorted.begin(),
      sorted.end(),
      [](const EdgeCandidate& a, const EdgeCandidate& b) { return a.y < b.y; });
  const double reach =
      options.max_sigmas * std::hypot(kMaxSigma, options.scatter_m);
  Evidence evidence(view, corridor, lines, heading, prior, options);
  std::vector<LateralPeak> peaks;
  auto first = sorted.begin();
  auto last = sorted.begin();
  for (const EdgeCandidate& candidate : sorted) {
    if (!peaks.empty() && candidate.y < peaks.back().y + kStep) continue;
    while (candidate.y - first->y > reach) ++first;
    while (last != sorted.end() && last->y - candidate.y < reach) ++last;
    peaks.push_back(evidence.At(candidate.y, {first, last}));
  }
  if (peaks.empty()) return {};
  const auto best = std::max_element(
      peaks.begin(), peaks.end(), [](const auto& a, const auto& b) {
        return a.evidence < b.evidence;
      });
  const auto at = static_cast<std::size_t>(best - peaks.begin());
  LateralPeak peak = *best;
  peak.rival = RivalOf(peaks, at);
  return peak;
}

}  // namespace waymark
