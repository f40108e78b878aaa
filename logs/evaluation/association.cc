#include "logs/evaluation/association.h"

#include "estimation/geometry/angle.h"

#include <algorithm>
#include <stdexcept>

namespace waymark {
namespace {

// The estimates in order of time, the last given of several at one time.
std::vector<EstimatedPose> Sorted(std::span<const EstimatedPose> estimates) {
  std::vector<EstimatedPose> sorted(estimates.begin(), estimates.end());
  std::stable_sort(
      sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
        return a.time < b.time;
      });
  std::vector<EstimatedPose> unique;
  for (const EstimatedPose& pose : sorted) {
    if (!unique.empty() && unique.back().time == pose.time) {
      unique.back() = pose;
    } else {
      unique.push_back(pose);
    }
  }
  return unique;
}

EstimatedPose Interpolate(const EstimatedPose& a,
                          const EstimatedPose& b,
                          Time time) {
  const double s = Seconds(time - a.time) / Seconds(b.time - a.time);
  EstimatedPose pose;
  pose.time = time;
  pose.X_WR = {a.X_WR.x + s * (b.X_WR.x - a.X_WR.x),
               a.X_WR.y + s * (b.X_WR.y - a.X_WR.y),
               WrapAngle(a.X_WR.heading +
                         s * WrapAngle(b.X_WR.heading - a.X_WR.heading))};
  // A convex combination of covariances is a covariance.
  if (a.covariance && b.covariance) {
    pose.covariance = (1.0 - s) * *a.covariance + s * *b.covariance;
  }
  return pose;
}

}  // namespace

void AssociationOptions::Check() const {
  if (!(max_gap_s > 0.0)) {
    throw std::invalid_argument("max_gap_s must be positive");
  }
}

Association Associate(std::span<const TruthSample> truth,
                      std::span<const EstimatedPose> estimates,
                      const AssociationOptions& options) {
  options.Check();
  const std::vector<EstimatedPose> sorted = Sorted(estimates);
  std::vector<TruthSample> samples(truth.begin(), truth.end());
  std::stable_sort(
      samples.begin(), samples.end(), [](const auto& a, const auto& b) {
        return a.time < b.time;
      });
  const Duration max_gap = DurationFromSeconds(options.max_gap_s);

  Association result;
  for (const TruthSample& sample : samples) {
    const auto after = std::lower_bound(
        sorted.begin(),
        sorted.end(),
        sample.time,
        [](const EstimatedPose& p, Time t) { return p.time < t; });
    if (after != sorted.end() && after->time == sample.time) {
      result.pairs.push_back({sample, *after});
    } else if (after == sorted.begin() || after == sorted.end()) {
      ++result.num_outside;
    } else if (after->time - std::prev(after)->time > max_gap) {
      ++result.num_in_gaps;
    } else {
      result.pairs.push_back(
          {sample, Interpolate(*std::prev(after), *after, sample.time)});
    }
  }
  return result;
}

}  // namespace waymark
