#include "logs/evaluation/dead_reckoning.h"

#include "estimation/base/check.h"
#include "logs/evaluation/association.h"

#include <algorithm>
#include <cmath>

namespace waymark {

std::vector<EstimatedPose> DeadReckon(std::span<const EncoderReading> readings,
                                      const WheelParameters& parameters) {
  std::vector<EstimatedPose> path;
  path.reserve(readings.size());
  Pose2 X_OR;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (i > 0) {
      const WheelTicks ticks{
          static_cast<double>(readings[i].right - readings[i - 1].right),
          static_cast<double>(readings[i].left - readings[i - 1].left)};
      X_OR = X_OR * IntegrateTicks(
                        ticks, parameters, DriveNoise{}, DriveIntegration::kArc)
                        .X_R0R1;
    }
    path.push_back({readings[i].time, X_OR, std::nullopt});
  }
  return path;
}

std::vector<EstimatedPose> Anchor(std::vector<EstimatedPose> path,
                                  Time time,
                                  const Pose2& X_WR) {
  if (path.empty()) return path;
  TruthSample when;
  when.time = std::clamp(time, path.front().time, path.back().time);
  AssociationOptions any_gap;
  any_gap.max_gap_s = Seconds(path.back().time - path.front().time) + 1.0;
  const Association at = Associate({&when, 1}, path, any_gap);
  WAYMARK_CHECK(at.pairs.size() == 1, at.pairs.size());
  const Pose2 X_WO = X_WR * Inverse(at.pairs[0].estimate.X_WR);
  for (EstimatedPose& pose : path) pose.X_WR = X_WO * pose.X_WR;
  return path;
}

ParameterConvergence EvaluateConvergence(
    std::span<const ParameterSample> samples,
    const std::optional<WheelParameters>& reference) {
  WAYMARK_CHECK(!samples.empty());
  constexpr double kWithin = 0.01;  // Row Y23 counts updates to 1 %.
  ParameterConvergence result;
  result.final = samples.back().parameters;
  result.sigma = samples.back().covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  result.observability = samples.back().observability;
  if (!reference) return result;
  result.has_reference = true;
  const Eigen::Vector3d truth = reference->vector();
  const Eigen::Vector3d error = result.final.vector() - truth;
  for (int k = 0; k < 3; ++k) {
    result.relative_error(k) = error(k) / truth(k);
    if (result.sigma(k) > 0.0) {
      result.normalised_error(k) = std::abs(error(k)) / result.sigma(k);
    }
    // Backwards from the end while the estimate is inside.
    for (std::size_t i = samples.size(); i-- > 0;) {
      const double value = samples[i].parameters.vector()(k);
      if (!(std::abs(value / truth(k) - 1.0) <= kWithin)) break;
      result.settled_s[static_cast<std::size_t>(k)] =
          Seconds(samples[i].time - samples[0].time);
    }
  }
  return result;
}

}  // namespace waymark
