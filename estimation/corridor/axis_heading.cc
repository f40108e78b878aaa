#include "estimation/corridor/axis_heading.h"

#include "estimation/geometry/angle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

namespace waymark {
namespace {

constexpr int kNumBins = 1440;  // An eighth of a degree over pi.
constexpr double kBin = kPi / kNumBins;
// Lines known worse than that say nothing.
constexpr double kMaxSigma = 0.2;
// Half a bin, so that no peak falls between two.
constexpr double kMinSigma = 0.6 * kBin;

using Votes = std::array<double, kNumBins>;

// Logarithm of the likelihood of a line about its heading, over that at random.
void Vote(const LineHeading& line, double share, Votes* votes) {
  if (!(line.sigma < kMaxSigma)) return;
  const double sigma = std::max(line.sigma, kMinSigma);
  const double scale =
      share / (1.0 - share) * kPi / (sigma * std::sqrt(2.0 * kPi));
  const int reach = static_cast<int>(std::ceil(4.0 * sigma / kBin));
  const int middle =
      static_cast<int>(std::floor((line.heading + 0.5 * kPi) / kBin));
  for (int i = middle - reach; i <= middle + reach; ++i) {
    const double at = (i + 0.5) * kBin - 0.5 * kPi;
    const double off = (at - line.heading) / sigma;
    (*votes)[static_cast<std::size_t>(((i % kNumBins) + kNumBins) %
                                      kNumBins)] +=
        std::log1p(scale * std::exp(-0.5 * off * off));
  }
}

// Robust: a prior may be wrong altogether.
double LogPrior(double heading, const AxisPrior& prior) {
  const double sigma = std::hypot(prior.sigma, 0.01);
  // Modulo pi.
  const double off = std::remainder(heading - prior.heading, kPi) / sigma;
  constexpr double kWrong = 0.02;
  return std::log((1.0 - kWrong) * std::exp(-0.5 * off * off) /
                      (sigma * std::sqrt(2.0 * kPi)) +
                  kWrong / kPi);
}

// Weighted least squares about a heading; weights by Tukey's function, for
// lines that may be off by `slack`, rad, besides.
struct Step {
  double sum_ww = 0.0;
  double sum_wr = 0.0;
};
void AddLine(const CorridorView& view,
             const SeenLine& line,
             const Eigen::Vector3d& direction,
             const Eigen::Vector3d& d_direction,
             double max_sigmas,
             double slack,
             Step* step) {
  const double r = VanishingResidual(line, view.PixelOf(direction));
  // The denominator hardly changes along the way.
  constexpr double kDelta = 1e-6;
  const double ahead =
      VanishingResidual(line, view.PixelOf(direction + kDelta * d_direction));
  const double slope = (ahead - r) / kDelta;
  const double cut = r / (max_sigmas * std::hypot(1.0, slope * slack));
  if (std::abs(cut) >= 1.0) return;
  const double weight = (1.0 - cut * cut) * (1.0 - cut * cut);
  step->sum_ww += weight * slope * slope;
  step->sum_wr += weight * slope * r;
}

}  // namespace

void AxisHeadingOptions::Check() const {
  if (!(along_share > 0.0 && across_share > 0.0 &&
        along_share + across_share < 1.0)) {
    throw std::invalid_argument(
        "along_share, across_share: must be positive, their sum below 1");
  }
  if (!(max_sigmas > 0.0)) {
    throw std::invalid_argument("max_sigmas: must be positive");
  }
  if (min_lines < 1) throw std::invalid_argument("min_lines: at least 1");
}

std::optional<AxisHeading> EstimateAxisHeading(
    const CorridorView& view,
    std::span<const SeenLine> lines,
    const std::optional<AxisPrior>& prior,
    const AxisHeadingOptions& options) {
  Votes votes{};
  for (const SeenLine& line : lines) {
    if (const auto along = HeadingOfLine(view, line, 0.0)) {
      Vote(*along, options.along_share, &votes);
    }
    if (const auto across = HeadingOfLine(view, line, 0.5 * kPi)) {
      Vote(*across, options.across_share, &votes);
    }
  }
  double best_score = -std::numeric_limits<double>::infinity();
  AxisHeading result;
  for (int i = 0; i < kNumBins; ++i) {
    const double heading = (i + 0.5) * kBin - 0.5 * kPi;
    // Nearer to across than to along: the prior tells the two apart, however
    // many lines a tiled floor has.
    if (prior &&
        std::abs(std::remainder(heading - prior->heading, kPi)) > 0.25 * kPi) {
      continue;
    }
    const double evidence = votes[static_cast<std::size_t>(i)];
    const double score = evidence + (prior ? LogPrior(heading, *prior) : 0.0);
    if (score <= best_score) continue;
    best_score = score;
    result.heading = heading;
    result.evidence = evidence;
  }
  if (result.evidence < options.min_evidence) return std::nullopt;

  Step step;
  // The peak is known to a bin at first; lines may be known far better.
  constexpr int kNumIterations = 8;
  double slack = kBin;
  for (int k = 0; k < kNumIterations; ++k) {
    step = Step();
    const Eigen::Vector3d axis = AxisIn(result.heading);
    const Eigen::Vector3d across = AcrossIn(result.heading);
    for (const SeenLine& line : lines) {
      // d axis / d heading = -across, d across / d heading = axis.
      AddLine(view, line, axis, -across, options.max_sigmas, slack, &step);
      AddLine(view, line, across, axis, options.max_sigmas, slack, &step);
    }
    if (!(step.sum_ww > 0.0)) return std::nullopt;
    // Never farther than the peak is wide.
    const double change =
        std::clamp(-step.sum_wr / step.sum_ww, -4.0 * kBin, 4.0 * kBin);
    result.heading += change;
    slack = k + 3 < kNumIterations ? 0.1 * slack : 0.0;
  }
  result.sigma = 1.0 / std::sqrt(step.sum_ww);
  if (prior) {
    // Of both directions the one that was expected.
    result.heading += kPi * std::round((prior->heading - result.heading) / kPi);
  }
  result.heading = WrapAngle(result.heading);

  const Eigen::Vector3d axis = view.PixelOf(AxisIn(result.heading));
  const Eigen::Vector3d across = view.PixelOf(AcrossIn(result.heading));
  int num_along = 0;
  for (const SeenLine& line : lines) {
    const double off = std::abs(VanishingResidual(line, axis));
    const double off_across = std::abs(VanishingResidual(line, across));
    LineFamily family = LineFamily::kOther;
    if (off <= options.max_sigmas && off <= off_across) {
      family = LineFamily::kAlong;
      ++num_along;
    } else if (off_across <= options.max_sigmas) {
      family = LineFamily::kAcross;
    }
    result.families.push_back(family);
  }
  if (num_along < options.min_lines) return std::nullopt;
  return result;
}

}  // namespace waymark
