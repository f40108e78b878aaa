#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"
#include "estimation/lines/vanishing_point.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

using Eigen::Vector3d;

constexpr int kNumBins = 720;
constexpr double kStep = kPi / kNumBins;
// A normal density is as good as 0 from here on, sigmas.
constexpr double kTail = 4.0;
// Maxima closer than this are one, sigmas of the sharper.
constexpr double kSame = 4.0;

// Right-handed: forward, right; both horizontal.
struct Horizon {
  Vector3d forward_C;
  Vector3d right_C;
};

Horizon HorizonOf(const Vector3d& gravity_C) {
  // A unit vector but for rounding of its source.
  WAYMARK_CHECK(std::abs(gravity_C.norm() - 1.0) < 1e-6);
  const Vector3d down = gravity_C.normalized();
  Vector3d forward = Vector3d::UnitZ() - down.z() * down;
  // Looking straight up or down: a thousandth of a radian leaves no heading of
  // the optical axis worth its name.
  if (forward.norm() < 1e-3) {
    const Vector3d right = (Vector3d::UnitX() - down.x() * down).normalized();
    return {right, down.cross(right)};
  }
  forward.normalize();
  return {forward, down.cross(forward)};
}

// Difference of two headings of axes, in (-pi/2, pi/2].
double AxisDifference(double a, double b) {
  return 0.5 * WrapAngle(2.0 * (a - b));
}

// A line, as what it says of the heading.
struct Vote {
  std::size_t line;
  double heading;  // Modulo pi.
  double sigma;
  double odds;  // That it belongs here rather than anywhere, where it fits.
};

double Belief(const Vote& vote, double heading) {
  const double z = AxisDifference(vote.heading, heading) / vote.sigma;
  return vote.odds * std::exp(-0.5 * z * z);
}

std::vector<Vote> VotesOf(const std::vector<LineDirection>& lines,
                          const Vector3d& gravity_C,
                          const Horizon& horizon,
                          const HorizontalDirectionOptions& options) {
  std::vector<Vote> votes;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const LineDirection& line = lines[i];
    if (std::abs(line.Residual(gravity_C)) < options.vertical_sigmas) continue;
    const double a = line.across_C.dot(horizon.forward_C);
    const double b = line.across_C.dot(horizon.right_C);
    const double slope = std::hypot(a, b);
    // a cos(h) + b sin(h) = slope sin(h - heading).
    const double heading = std::atan2(-a, b);
    const Vector3d n_C = std::cos(heading) * horizon.forward_C +
                         std::sin(heading) * horizon.right_C;
    const double own = line.Sigma(n_C);
    if (!(own < options.max_sigma_rad * slope)) continue;
    const double sigma = std::hypot(own / slope, options.model_sigma_rad);
    // A normal density's height over that of the even one over pi.
    const double odds = options.inlier_share / (1.0 - options.inlier_share) *
                        std::sqrt(0.5 * kPi) / sigma;
    votes.push_back({i, heading, sigma, odds});
  }
  return votes;
}

// Headings of the maxima of the likelihood, blurred by the step.
std::vector<double> Maxima(const std::vector<Vote>& votes) {
  std::vector<double> score(kNumBins, 0.0);
  for (const Vote& vote : votes) {
    const double sigma = std::hypot(vote.sigma, kStep);
    const double odds = vote.odds * vote.sigma / sigma;
    const int reach =
        std::min(static_cast<int>(kTail * sigma / kStep), kNumBins / 2 - 1);
    const int middle = static_cast<int>(std::lround(vote.heading / kStep));
    for (int bin = middle - reach; bin <= middle + reach; ++bin) {
      const double z = (bin * kStep - vote.heading) / sigma;
      const int wrapped = (bin % kNumBins + kNumBins) % kNumBins;
      score[static_cast<std::size_t>(wrapped)] +=
          std::log1p(odds * std::exp(-0.5 * z * z));
    }
  }
  std::vector<double> maxima;
  for (std::size_t i = 0; i < kNumBins; ++i) {
    const double before = score[(i + kNumBins - 1) % kNumBins];
    const double after = score[(i + 1) % kNumBins];
    if (score[i] > before && score[i] >= after) {
      maxima.push_back(static_cast<double>(i) * kStep);
    }
  }
  return maxima;
}

struct Peak {
  double heading;
  double sigma;
  double support;
};

// Expectation and maximisation: each line counts as much as it belongs.
std::optional<Peak> Refine(const std::vector<Vote>& votes, double heading) {
  constexpr int kMaxIterations = 50;
  constexpr double kConverged = 1e-12;
  double information = 0.0;
  for (int i = 0; i < kMaxIterations; ++i) {
    information = 0.0;
    double pull = 0.0;
    for (const Vote& vote : votes) {
      const double belief = Belief(vote, heading);
      const double weight = belief / (1.0 + belief) / (vote.sigma * vote.sigma);
      information += weight;
      pull += weight * AxisDifference(vote.heading, heading);
    }
    if (!(information > 0.0)) return std::nullopt;
    const double step = pull / information;
    heading += step;
    if (std::abs(step) < kConverged) break;
  }
  double support = 0.0;
  for (const Vote& vote : votes) support += std::log1p(Belief(vote, heading));
  return Peak{
      AxisDifference(heading, 0.0), 1.0 / std::sqrt(information), support};
}

// The widest angle between the planes of the camera and lines of the mask.
bool IsOneLine(const std::vector<LineDirection>& lines,
               const std::vector<char>& mask,
               double min_angle) {
  std::optional<Vector3d> first;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (mask[i] == 0) continue;
    if (!first) first = lines[i].Normal();
    if (first->cross(lines[i].Normal()).norm() > min_angle) return false;
  }
  return true;
}

// Refined maxima, each once.
std::vector<Peak> DistinctPeaks(const std::vector<Vote>& votes) {
  std::vector<Peak> peaks;
  for (const double start : Maxima(votes)) {
    const std::optional<Peak> peak = Refine(votes, start);
    if (!peak) continue;
    const bool is_known =
        std::any_of(peaks.begin(), peaks.end(), [&](const Peak& other) {
          return std::abs(AxisDifference(other.heading, peak->heading)) <
                 kSame * std::min(other.sigma, peak->sigma);
        });
    if (!is_known) peaks.push_back(*peak);
  }
  return peaks;
}

HorizontalDirection DirectionOf(const Peak& peak,
                                double heading,
                                const std::vector<LineDirection>& lines,
                                const std::vector<Vote>& votes,
                                const Vector3d& gravity_C,
                                const HorizontalDirectionOptions& options) {
  HorizontalDirection direction;
  direction.heading = heading;
  direction.sigma_rad = peak.sigma;
  direction.support = peak.support;
  direction.n_C = DirectionOfHeading(heading, gravity_C);
  direction.inlier_mask.assign(lines.size(), 0);
  for (const LineDirection& line : lines) {
    direction.residuals.push_back(line.Residual(direction.n_C));
  }
  for (const Vote& vote : votes) {
    const double z = AxisDifference(vote.heading, heading) / vote.sigma;
    direction.residuals[vote.line] = z;
    if (std::abs(z) > options.inlier_sigmas) continue;
    direction.inlier_mask[vote.line] = 1;
    ++direction.num_inliers;
  }
  return direction;
}

// The best supported first; with a prior by both.
void SortBySupport(const std::optional<HeadingPrior>& prior,
                   std::vector<HorizontalDirection>* found) {
  const auto rank = [&](const HorizontalDirection& direction) {
    if (!prior) return direction.support;
    const double z = AxisDifference(direction.heading, prior->heading) /
                     std::hypot(prior->sigma_rad, direction.sigma_rad);
    return direction.support - 0.5 * z * z;
  };
  std::stable_sort(
      found->begin(), found->end(), [&](const auto& a, const auto& b) {
        return rank(a) > rank(b);
      });
}

}  // namespace

void HorizontalDirectionOptions::Check() const {
  const auto require = [](bool holds, const char* text) {
    if (!holds) throw std::invalid_argument(text);
  };
  require(model_sigma_rad >= 0.0 && model_sigma_rad <= 0.1,
          "model_sigma_rad must be in [0, 0.1]");
  require(inlier_share > 0.0 && inlier_share < 1.0,
          "inlier_share must be in (0, 1)");
  require(max_sigma_rad > 0.0 && max_sigma_rad <= 0.5,
          "max_sigma_rad must be in (0, 0.5]");
  require(vertical_sigmas >= 0.0, "vertical_sigmas must not be negative");
  require(inlier_sigmas > 0.0 && inlier_sigmas <= 10.0,
          "inlier_sigmas must be in (0, 10]");
  require(min_lines >= 2, "min_lines: at least 2");
  require(min_angle_rad > 0.0 && min_angle_rad <= 1.0,
          "min_angle_rad must be in (0, 1]");
  require(gate_sigmas > 0.0 && gate_sigmas <= 100.0,
          "gate_sigmas must be in (0, 100]");
  require(max_directions >= 1, "max_directions: at least 1");
}

double HeadingOf(const Vector3d& n_C, const Vector3d& gravity_C) {
  const Horizon horizon = HorizonOf(gravity_C);
  return WrapAngle(
      std::atan2(n_C.dot(horizon.right_C), n_C.dot(horizon.forward_C)));
}

Vector3d DirectionOfHeading(double heading, const Vector3d& gravity_C) {
  const Horizon horizon = HorizonOf(gravity_C);
  return std::cos(heading) * horizon.forward_C +
         std::sin(heading) * horizon.right_C;
}

std::vector<HorizontalDirection> FindHorizontalDirections(
    std::span<const LineSegment> lines,
    const PinholeView& view,
    const Vector3d& gravity_C,
    const std::optional<HeadingPrior>& prior,
    const HorizontalDirectionOptions& options) {
  options.Check();
  if (prior) {
    WAYMARK_CHECK(std::isfinite(prior->heading) && prior->sigma_rad > 0.0);
  }
  const Horizon horizon = HorizonOf(gravity_C);
  const std::vector<LineDirection> directions = LineDirections(lines, view);
  const std::vector<Vote> votes =
      VotesOf(directions, gravity_C, horizon, options);
  std::vector<HorizontalDirection> found;
  for (const Peak& peak : DistinctPeaks(votes)) {
    double heading = peak.heading;
    if (prior) {
      const double off = AxisDifference(peak.heading, prior->heading);
      const double sigma = std::hypot(prior->sigma_rad, peak.sigma);
      if (std::abs(off) > options.gate_sigmas * sigma) continue;
      heading = WrapAngle(prior->heading + off);
    }
    HorizontalDirection direction =
        DirectionOf(peak, heading, directions, votes, gravity_C, options);
    if (direction.num_inliers < options.min_lines ||
        IsOneLine(directions, direction.inlier_mask, options.min_angle_rad)) {
      continue;
    }
    found.push_back(std::move(direction));
  }
  SortBySupport(prior, &found);
  if (found.size() > static_cast<std::size_t>(options.max_directions)) {
    found.resize(static_cast<std::size_t>(options.max_directions));
  }
  return found;
}

}  // namespace waymark
