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

// Likelihoods of all lines over those at random, bin by bin, as products: one
// multiplication a line instead of a logarithm.
class Votes {
 public:
  Votes() { products_.fill(1.0); }

  // A line about its heading.
  void Add(const LineHeading& line, double share) {
    if (!(line.sigma < kMaxSigma)) return;
    const double sigma = std::max(line.sigma, kMinSigma);
    const double scale =
        share / (1.0 - share) * kPi / (sigma * std::sqrt(2.0 * kPi));
    const int reach = static_cast<int>(std::ceil(4.0 * sigma / kBin));
    const int middle =
        static_cast<int>(std::floor((line.heading + 0.5 * kPi) / kBin));
    // exp(-u^2 / 2) in equal steps du of u: each value is the one before times
    // a ratio, which itself changes by exp(-du^2).
    const double du = kBin / sigma;
    const double u =
        ((middle - reach + 0.5) * kBin - 0.5 * kPi - line.heading) / sigma;
    double value = scale * std::exp(-0.5 * u * u);
    double ratio = std::exp(-du * (u + 0.5 * du));
    const double change = std::exp(-du * du);
    int bin = ((middle - reach) % kNumBins + kNumBins) % kNumBins;
    for (int i = 0; i <= 2 * reach; ++i) {
      Multiply(static_cast<std::size_t>(bin), 1.0 + value);
      value *= ratio;
      ratio *= change;
      if (++bin == kNumBins) bin = 0;
    }
  }

  [[nodiscard]] double LogAt(int bin) const {
    const auto i = static_cast<std::size_t>(bin);
    return std::log(products_[i]) + logarithms_[i];
  }

 private:
  void Multiply(std::size_t bin, double factor) {
    constexpr double kLarge = 1e100;
    products_[bin] *= factor;
    if (products_[bin] < kLarge) return;
    logarithms_[bin] += std::log(products_[bin]);
    products_[bin] = 1.0;
  }

  std::array<double, kNumBins> products_{};
  std::array<double, kNumBins> logarithms_{};  // Of what became too large.
};

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

  // `pixel`: where a direction vanishes; `d_pixel`: how that moves with the
  // heading.
  void Add(const SeenLine& line,
           const Eigen::Vector3d& pixel,
           const Eigen::Vector3d& d_pixel,
           double max_sigmas,
           double slack) {
    // Sigma hardly changes along the way.
    const double r = VanishingResidual(line, pixel);
    const double ahead = VanishingResidual(line, pixel + kDelta * d_pixel);
    const double slope = (ahead - r) / kDelta;
    const double width =
        max_sigmas * max_sigmas * (1.0 + slope * slope * slack * slack);
    const double share = r * r / width;
    if (share >= 1.0) return;
    const double weight = (1.0 - share) * (1.0 - share);
    sum_ww += weight * slope * slope;
    sum_wr += weight * slope * r;
  }

  static constexpr double kDelta = 1e-6;
};

double HeadingOf(int bin) {
  return (bin + 0.5) * kBin - 0.5 * kPi;
}

// The bin with the highest likelihood, with the prior, and its margin over all
// that are not its own foot; false where no bin is near the prior.
bool FindPeak(const Votes& votes,
              const std::optional<AxisPrior>& prior,
              AxisHeading* peak) {
  constexpr double kNowhere = -std::numeric_limits<double>::infinity();
  const double foot = RadiansFromDegrees(1.5);
  std::array<double, kNumBins> scores{};
  for (int i = 0; i < kNumBins; ++i) {
    const double heading = HeadingOf(i);
    // Nearer to across than to along: the prior tells the two apart, however
    // many lines a tiled floor has.
    const bool is_across =
        prior &&
        std::abs(std::remainder(heading - prior->heading, kPi)) > 0.25 * kPi;
    scores[static_cast<std::size_t>(i)] =
        is_across ? kNowhere
                  : votes.LogAt(i) + (prior ? LogPrior(heading, *prior) : 0.0);
  }
  const auto best = std::max_element(scores.begin(), scores.end());
  if (*best == kNowhere) return false;
  const auto bin = static_cast<int>(best - scores.begin());
  peak->heading = HeadingOf(bin);
  peak->evidence = votes.LogAt(bin);
  // A rival is another peak: beyond a valley, not the same one's foot.
  double rival = kNowhere;
  const double rise = 0.1 * peak->evidence;
  for (const int direction : {1, -1}) {
    double lowest = *best;
    for (int i = 1; i < kNumBins; ++i) {
      const int at = ((bin + direction * i) % kNumBins + kNumBins) % kNumBins;
      const double score = scores[static_cast<std::size_t>(at)];
      if (score == kNowhere) break;
      lowest = std::min(lowest, score);
      if (i * kBin > foot && score > lowest + rise) {
        rival = std::max(rival, score);
      }
    }
  }
  peak->margin = *best - rival;
  return true;
}

}  // namespace

bool StandsOut(const AxisHeading& heading, const AxisHeadingOptions& options) {
  return heading.margin >= options.min_margin_share * heading.evidence;
}

void AxisHeadingOptions::Check() const {
  if (!(along_share > 0.0 && across_share > 0.0 &&
        along_share + across_share < 1.0)) {
    throw std::invalid_argument(
        "along_share, across_share: must be positive, their sum below 1");
  }
  if (!(max_sigmas > 0.0)) {
    throw std::invalid_argument("max_sigmas: must be positive");
  }
  if (!(min_evidence >= 0.0)) {
    throw std::invalid_argument("min_evidence: must not be negative");
  }
  if (!(min_pair_px >= 0.0)) {
    throw std::invalid_argument("min_pair_px: must not be negative");
  }
  if (min_lines < 1) throw std::invalid_argument("min_lines: at least 1");
  if (!(min_margin_share >= 0.0 && min_margin_share <= 1.0)) {
    throw std::invalid_argument("min_margin_share: in [0, 1]");
  }
}

std::optional<AxisHeading> EstimateAxisHeading(
    const CorridorView& view,
    std::span<const SeenLine> lines,
    const std::optional<AxisPrior>& prior,
    const AxisHeadingOptions& options) {
  Votes votes;
  for (const SeenLine& line : lines) {
    if (const auto along = HeadingOfLine(view, line, 0.0)) {
      votes.Add(*along, options.along_share);
    }
    if (const auto across = HeadingOfLine(view, line, 0.5 * kPi)) {
      votes.Add(*across, options.across_share);
    }
  }
  AxisHeading result;
  if (!FindPeak(votes, prior, &result)) return std::nullopt;
  if (!(result.evidence >= options.min_evidence)) return std::nullopt;

  Step step;
  // The peak is known to a bin at first; lines may be known far better.
  constexpr int kNumIterations = 8;
  double slack = kBin;
  for (int k = 0; k < kNumIterations; ++k) {
    step = Step();
    const Eigen::Vector3d axis = view.PixelOf(AxisIn(result.heading));
    const Eigen::Vector3d across = view.PixelOf(AcrossIn(result.heading));
    for (const SeenLine& line : lines) {
      // d axis / d heading = -across, d across / d heading = axis.
      step.Add(line, axis, -across, options.max_sigmas, slack);
      step.Add(line, across, axis, options.max_sigmas, slack);
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
  int num_across = 0;
  int num_long = 0;  // Of those along.
  for (const SeenLine& line : lines) {
    const double off = std::abs(VanishingResidual(line, axis));
    const double off_across = std::abs(VanishingResidual(line, across));
    LineFamily family = LineFamily::kOther;
    if (off <= options.max_sigmas && off <= off_across) {
      family = LineFamily::kAlong;
      ++num_along;
      num_long += line.length >= options.min_pair_px ? 1 : 0;
    } else if (off_across <= options.max_sigmas) {
      family = LineFamily::kAcross;
      ++num_across;
    }
    result.families.push_back(family);
  }
  // One line along has its vanishing point anywhere.
  const bool has_enough =
      num_long >= 2 || num_along + num_across >= options.min_lines;
  if (num_along < 2 || !has_enough) return std::nullopt;
  return result;
}

}  // namespace waymark
