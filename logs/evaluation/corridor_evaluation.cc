#include "logs/evaluation/corridor_evaluation.h"

#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace waymark {
namespace {

std::vector<EstimatedPose> PosesOf(std::span<const TruthSample> truth) {
  std::vector<EstimatedPose> poses;
  for (const TruthSample& sample : truth) {
    if (!sample.heading) continue;
    Pose2 X_WR{0.0, 0.0, *sample.heading};
    const Eigen::Vector2d p_WR = sample.p_WS - X_WR * sample.p_RS;
    X_WR.x = p_WR.x();
    X_WR.y = p_WR.y();
    poses.push_back({sample.time, X_WR, std::nullopt});
  }
  return poses;
}

// The path at each answer's time, where it says anything of it.
std::vector<std::optional<EstimatedPose>> PathAt(
    std::span<const CorridorAnswer> answers,
    std::span<const EstimatedPose> path,
    const AssociationOptions& options) {
  std::vector<TruthSample> times;
  for (const CorridorAnswer& answer : answers) {
    times.emplace_back().time = answer.time;
  }
  std::map<Time, EstimatedPose> found;
  for (const AssociatedPair& pair : Associate(times, path, options).pairs) {
    found.emplace(pair.truth.time, pair.estimate);
  }
  std::vector<std::optional<EstimatedPose>> result;
  for (const CorridorAnswer& answer : answers) {
    const auto at = found.find(answer.time);
    result.push_back(at == found.end() ? std::nullopt
                                       : std::optional(at->second));
  }
  return result;
}

struct Errors {
  std::vector<double> y;
  std::vector<double> heading;
  double worst_y_sigmas = 0.0;
  double worst_heading_sigmas = 0.0;

  void AddY(double error, double variance) {
    y.push_back(std::abs(error));
    if (variance <= 0.0) return;
    worst_y_sigmas =
        std::max(worst_y_sigmas, std::abs(error) / std::sqrt(variance));
  }
  void AddHeading(double error, double variance) {
    heading.push_back(std::abs(error));
    if (variance <= 0.0) return;
    worst_heading_sigmas =
        std::max(worst_heading_sigmas, std::abs(error) / std::sqrt(variance));
  }
  [[nodiscard]] CorridorErrorSummary Summary() const {
    return {
        Summarise(y), Summarise(heading), worst_y_sigmas, worst_heading_sigmas};
  }
};

}  // namespace

double CorridorEvaluation::accepted_share() const {
  const auto found = statuses.find(NameOf(CorridorStatus::kAccepted));
  if (found == statuses.end() || num == 0) return 0.0;
  return static_cast<double>(found->second) / num;
}

std::optional<CorridorEvaluation> EvaluateCorridor(
    std::span<const CorridorAnswer> answers,
    std::span<const TruthSample> truth,
    std::span<const EstimatedPose> path,
    const AssociationOptions& options) {
  if (answers.empty()) return std::nullopt;
  std::vector<CorridorAnswer> sorted(answers.begin(), answers.end());
  std::stable_sort(sorted.begin(),
                   sorted.end(),
                   [](const CorridorAnswer& a, const CorridorAnswer& b) {
                     return a.time < b.time;
                   });
  const auto truths = PathAt(sorted, PosesOf(truth), options);
  const auto fused = PathAt(sorted, path, options);
  CorridorEvaluation evaluation;
  std::vector<double> lines_ms;
  std::vector<double> pose_ms;
  Errors seen_errors;
  Errors fused_errors;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const CorridorAnswer& answer = sorted[i];
    const CorridorEstimate& estimate = answer.estimate;
    ++evaluation.num;
    ++evaluation.statuses[NameOf(estimate.status)];
    evaluation.reasons[NameOf(estimate.status)] = estimate.reason;
    if (answer.lines_took.count() > 0) {
      lines_ms.push_back(1e3 * Seconds(answer.lines_took));
      pose_ms.push_back(1e3 * Seconds(answer.pose_took));
    }
    CorridorSight sight;
    sight.time = answer.time;
    sight.status = estimate.status;
    sight.y = estimate.y;
    sight.heading = estimate.heading;
    // Without a corridor there is nothing to be off.
    const bool is_in_corridor = answer.corridor.has_value();
    const Pose2 X_WL = is_in_corridor ? answer.corridor->X_WL : Pose2{};
    if (is_in_corridor && fused[i]) {
      sight.fused_y = Between(X_WL, fused[i]->X_WR).y;
    }
    if (is_in_corridor && truths[i]) {
      const Pose2 X_LR = Between(X_WL, truths[i]->X_WR);
      sight.true_y = X_LR.y;
      sight.true_heading = X_LR.heading;
      if (estimate.status == CorridorStatus::kAccepted && estimate.y) {
        seen_errors.AddY(*estimate.y - X_LR.y, estimate.covariance(0, 0));
      }
      if (estimate.status == CorridorStatus::kAccepted && estimate.heading) {
        seen_errors.AddHeading(WrapAngle(*estimate.heading - X_LR.heading),
                               estimate.covariance(1, 1));
      }
      if (fused[i]) {
        const Pose2 own_LR = Between(X_WL, fused[i]->X_WR);
        const Eigen::Matrix3d P =
            fused[i]->covariance.value_or(Eigen::Matrix3d::Zero());
        const Eigen::Vector2d across(-std::sin(X_WL.heading),
                                     std::cos(X_WL.heading));
        fused_errors.AddY(own_LR.y - X_LR.y,
                          across.dot(P.topLeftCorner<2, 2>() * across));
        fused_errors.AddHeading(WrapAngle(own_LR.heading - X_LR.heading),
                                P(2, 2));
      }
    }
    evaluation.sights.push_back(sight);
  }
  evaluation.lines_ms = Summarise(lines_ms);
  evaluation.pose_ms = Summarise(pose_ms);
  evaluation.seen = seen_errors.Summary();
  evaluation.fused = fused_errors.Summary();
  return evaluation;
}

}  // namespace waymark
