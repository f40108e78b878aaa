// Evaluation of one recording: every estimate it holds, side by side.
#pragma once

#include "logs/evaluation/consistency.h"
#include "logs/evaluation/corridor_evaluation.h"
#include "logs/evaluation/dead_reckoning.h"
#include "logs/evaluation/log_recording.h"
#include "logs/evaluation/trajectory_error.h"

#include <optional>
#include <string>
#include <vector>

namespace waymark {

struct EvaluationOptions {
  AssociationOptions association;
  std::vector<RelativeErrorOptions> relative_errors = {
      {.delta = 1.0, .unit = DeltaUnit::kMetres},
      {.delta = 1.0, .unit = DeltaUnit::kSeconds}};
  // Known wheel parameters; otherwise the batch result is the reference.
  std::optional<WheelParameters> known_parameters;
};

// One path against the reference.
struct EstimateEvaluation {
  std::string id;       // "raw", "online", ...; stable, for scripts.
  std::string label;    // For people.
  std::string how;      // Where the path comes from and how it is anchored.
  std::string missing;  // Why there is no path; empty where there is one.
  std::vector<EstimatedPose> path;  // In W, or where that is unknown, in O.
  int num_pairs = 0;
  int num_outside = 0;
  int num_in_gaps = 0;
  // As it is: the frame is the world's (or anchored at the start).
  std::optional<AbsoluteError> absolute;
  std::optional<AbsoluteError> aligned;  // SE(2).
  std::vector<RelativeError> relative;
  std::optional<Nees> nees_position;  // Published covariances only.
  std::optional<Nees> nees_pose;
};

struct ParameterEvaluation {
  std::string source;  // "nominal", "online", "batch", "truth" (simulated).
  std::vector<ParameterSample> samples;
  ParameterConvergence convergence;
};

struct LogEvaluation {
  LogRecording recording;
  std::string name;  // The log's file name without its ending.
  double truth_duration_s = 0.0;
  double path_m = 0.0;  // Of the reference.
  bool has_truth_heading = false;
  // Always in this order: raw, raw_nominal, online, settled,
  // dead_reckoning_online, dead_reckoning_batch.
  std::vector<EstimateEvaluation> estimates;
  std::vector<ParameterEvaluation> parameters;
  std::optional<CorridorEvaluation> corridor;
  std::string parameter_reference;  // "known", "truth", "batch" or empty.
  std::vector<std::string> notes;   // What is missing, one sentence each.

  [[nodiscard]] const EstimateEvaluation* Find(std::string_view id) const;
};

// Dead reckoning starts in a frame of its own. It is anchored, in this order
// of preference, at INITIAL_POSE, at the first reference sample with a heading,
// or at the first known POSE_SETTLED or POSE; without any of these only the
// SE(2)-aligned error exists.
[[nodiscard]] LogEvaluation EvaluateRecording(LogRecording recording,
                                              const EvaluationOptions& options);

}  // namespace waymark
