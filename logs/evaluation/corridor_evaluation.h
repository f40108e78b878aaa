// What was seen of a corridor, and how far off it was.
#pragma once

#include "estimation/base/statistics.h"
#include "logs/evaluation/association.h"
#include "logs/evaluation/trajectory_types.h"
#include "processes/convert/corridor_convert.h"

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace waymark {

// Magnitudes of errors across a corridor.
struct CorridorErrorSummary {
  Summary y_m;
  Summary heading_rad;
  double worst_y_sigmas = 0.0;  // Of what was stated.
  double worst_heading_sigmas = 0.0;
};

// One image, against the reference at its time.
struct CorridorSight {
  Time time;
  CorridorStatus status = CorridorStatus::kNoLines;
  std::optional<double> y;        // As it was said, m.
  std::optional<double> heading;  // rad.
  std::optional<double> true_y;   // In the same corridor; absent: no reference.
  std::optional<double> true_heading;
  std::optional<double> fused_y;  // POSE at that time.
};

struct CorridorEvaluation {
  int num = 0;  // CORRIDOR_POSE messages.
  std::map<std::string, int> statuses;
  std::map<std::string, std::string> reasons;  // Of the last of each status.
  std::vector<CorridorSight> sights;           // In order of time.
  // Of the accepted ones, and of POSE at the times of all images.
  CorridorErrorSummary seen;
  CorridorErrorSummary fused;
  // What the tracker took for an image's lines, and for the pose from them;
  // nothing offline.
  Summary lines_ms;
  Summary pose_ms;

  [[nodiscard]] double accepted_share() const;
};

// nullopt without answers. `path`: POSE. Reference samples without a heading
// are not used.
[[nodiscard]] std::optional<CorridorEvaluation> EvaluateCorridor(
    std::span<const CorridorAnswer> answers,
    std::span<const TruthSample> truth,
    std::span<const EstimatedPose> path,
    const AssociationOptions& options);

}  // namespace waymark
