// How far an estimated path is from the reference: absolute error (ATE) and
// relative error (RPE).
#pragma once

#include "estimation/base/statistics.h"
#include "logs/evaluation/association.h"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace waymark {

// What is done to the estimate before it is compared.
enum class Alignment {
  kNone,   // Nothing: the estimate's world is the reference's.
  kStart,  // Moved rigidly so that the first pair agrees (its heading too,
           // where the reference has one; otherwise only shifted).
  kSe2,    // Moved rigidly so that the sum of squared distances is least [1].
};
[[nodiscard]] std::string_view NameOf(Alignment alignment);

struct AbsoluteError {
  Alignment alignment = Alignment::kNone;
  Pose2 X_WE;  // The motion applied to the estimate, from its frame E.
  std::vector<Time> times;          // Of the pairs.
  std::vector<double> position;     // |p_WS estimate - p_WS reference|, m.
  std::vector<Time> heading_times;  // Of the pairs whose reference has one.
  std::vector<double> heading;      // Estimate - reference, rad, wrapped.
  Summary position_summary;
  Summary heading_summary;  // Of the absolute values.
};

// Absolute trajectory error: the translation part of evo_ape [2] with
// alignment none, --align_origin (for kStart with headings) or --align (kSe2),
// without scale. nullopt without pairs; kSe2 needs two different positions,
// otherwise it only shifts.
//
// [1] S. Umeyama. Least-squares estimation of transformation parameters
//     between two point patterns. PAMI 13(4), 376-380, 1991; scale fixed to 1.
// [2] M. Grupp. evo: Python package for the evaluation of odometry and SLAM.
//     github.com/MichaelGrupp/evo.
[[nodiscard]] std::optional<AbsoluteError> EvaluateAbsoluteError(
    std::span<const AssociatedPair> pairs, Alignment alignment);

enum class DeltaUnit { kMetres, kSeconds };

struct RelativeErrorOptions {
  double delta = 1.0;  // m of reference path, or s.
  DeltaUnit unit = DeltaUnit::kMetres;
  // A pair is used where its length is within this share of delta.
  double relative_tolerance = 0.1;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct RelativeError {
  RelativeErrorOptions options;
  bool has_heading = false;  // False: `translation` compares lengths only.
  Summary translation;       // m.
  Summary rotation;          // rad; num = 0 without headings.
};

// Relative pose error. For every sample i, j is the later sample whose length
// from i (reference path, or time) is nearest to delta, the first of equals;
// the pair counts where that length is within the tolerance. With Q the
// reference's and P the estimate's poses of the point S (axes of the robot),
//
//   E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j),
//
// `translation` is |trans(E)| and `rotation` |angle(E)|: evo_rpe [2] with
// --all_pairs --pairs_from_reference --delta_unit m, and rotation
// --pose_relation angle_rad. Where the reference has no headings, `translation`
// is | |p_j - p_i| of P - |p_j - p_i| of Q |: evo's point_distance. evo has no
// delta in seconds; ours is the same rule on time. Summaries with num = 0
// where no pair is long enough.
[[nodiscard]] RelativeError EvaluateRelativeError(
    std::span<const AssociatedPair> pairs, const RelativeErrorOptions& options);

// Length of the reference's path over the pairs, m.
[[nodiscard]] double PathLength(std::span<const AssociatedPair> pairs);

}  // namespace waymark
