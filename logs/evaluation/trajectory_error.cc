#include "logs/evaluation/trajectory_error.h"

#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

Pose2 StartAlignment(const AssociatedPair& first) {
  const Pose2& estimate = first.estimate.X_WR;
  if (!first.truth.heading) {
    const Eigen::Vector2d shift = first.truth.p_WS - first.EstimatedPoint();
    return {shift.x(), shift.y(), 0.0};
  }
  // X_WR of the reference: S sits at p_RS of a robot that faces `heading`.
  Pose2 X_WR{0.0, 0.0, WrapAngle(*first.truth.heading)};
  const Eigen::Vector2d p_WR = first.truth.p_WS - X_WR * first.truth.p_RS;
  X_WR.x = p_WR.x();
  X_WR.y = p_WR.y();
  return X_WR * Inverse(estimate);
}

// In the plane Umeyama's rotation is the angle of the summed cross-products.
Pose2 Se2Alignment(std::span<const AssociatedPair> pairs) {
  Eigen::Vector2d mean_W = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_E = Eigen::Vector2d::Zero();
  for (const AssociatedPair& pair : pairs) {
    mean_W += pair.truth.p_WS;
    mean_E += pair.EstimatedPoint();
  }
  mean_W /= static_cast<double>(pairs.size());
  mean_E /= static_cast<double>(pairs.size());
  double dot = 0.0;
  double cross = 0.0;
  for (const AssociatedPair& pair : pairs) {
    const Eigen::Vector2d w = pair.truth.p_WS - mean_W;
    const Eigen::Vector2d e = pair.EstimatedPoint() - mean_E;
    dot += e.dot(w);
    cross += e.x() * w.y() - e.y() * w.x();
  }
  const double angle = std::atan2(cross, dot);  // 0 where both are 0.
  const Pose2 turn{0.0, 0.0, WrapAngle(angle)};
  const Eigen::Vector2d shift = mean_W - turn * mean_E;
  return {shift.x(), shift.y(), turn.heading};
}

Pose2 AlignmentOf(std::span<const AssociatedPair> pairs, Alignment alignment) {
  switch (alignment) {
    case Alignment::kNone:
      return {};
    case Alignment::kStart:
      return StartAlignment(pairs.front());
    case Alignment::kSe2:
      return Se2Alignment(pairs);
  }
  return {};
}

// Lengths from the first pair: reference path in m, or time in s.
std::vector<double> LengthsOf(std::span<const AssociatedPair> pairs,
                              DeltaUnit unit) {
  std::vector<double> lengths;
  lengths.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i == 0) {
      lengths.push_back(0.0);
    } else if (unit == DeltaUnit::kSeconds) {
      lengths.push_back(Seconds(pairs[i].truth.time - pairs[0].truth.time));
    } else {
      lengths.push_back(lengths.back() +
                        (pairs[i].truth.p_WS - pairs[i - 1].truth.p_WS).norm());
    }
  }
  return lengths;
}

// Index of the sample after i whose length from i is nearest to delta.
std::size_t PartnerOf(const std::vector<double>& lengths,
                      std::size_t i,
                      double delta) {
  const auto begin = lengths.begin() + static_cast<std::ptrdiff_t>(i) + 1;
  const double target = lengths[i] + delta;
  auto best = std::lower_bound(begin, lengths.end(), target);
  if (best == lengths.end()) --best;
  if (best != begin && target - *std::prev(best) <= std::abs(*best - target)) {
    --best;
  }
  // The first of equal lengths: the robot may have stood still.
  best = std::lower_bound(begin, best, *best);
  return static_cast<std::size_t>(best - lengths.begin());
}

}  // namespace

std::string_view NameOf(Alignment alignment) {
  switch (alignment) {
    case Alignment::kNone:
      return "none";
    case Alignment::kStart:
      return "start";
    case Alignment::kSe2:
      return "se2";
  }
  return "none";
}

std::optional<AbsoluteError> EvaluateAbsoluteError(
    std::span<const AssociatedPair> pairs, Alignment alignment) {
  if (pairs.empty()) return std::nullopt;
  AbsoluteError error;
  error.alignment = alignment;
  error.X_WE = AlignmentOf(pairs, alignment);
  std::vector<double> absolute_heading;
  for (const AssociatedPair& pair : pairs) {
    error.times.push_back(pair.truth.time);
    error.position.push_back(
        (error.X_WE * pair.EstimatedPoint() - pair.truth.p_WS).norm());
    if (pair.truth.heading) {
      error.heading_times.push_back(pair.truth.time);
      error.heading.push_back(WrapAngle(error.X_WE.heading +
                                        pair.estimate.X_WR.heading -
                                        *pair.truth.heading));
      absolute_heading.push_back(std::abs(error.heading.back()));
    }
  }
  error.position_summary = Summarise(error.position);
  error.heading_summary = Summarise(absolute_heading);
  return error;
}

void RelativeErrorOptions::Check() const {
  if (!(delta > 0.0)) throw std::invalid_argument("delta must be positive");
  if (!(relative_tolerance >= 0.0 && relative_tolerance < 1.0)) {
    throw std::invalid_argument("relative_tolerance must be in [0, 1)");
  }
}

RelativeError EvaluateRelativeError(std::span<const AssociatedPair> pairs,
                                    const RelativeErrorOptions& options) {
  options.Check();
  RelativeError error;
  error.options = options;
  error.has_heading =
      !pairs.empty() &&
      std::all_of(pairs.begin(), pairs.end(), [](const auto& p) {
        return p.truth.heading.has_value();
      });
  const std::vector<double> lengths = LengthsOf(pairs, options.unit);
  const double tolerance = options.relative_tolerance * options.delta;
  std::vector<double> translation;
  std::vector<double> rotation;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i) {
    const std::size_t j = PartnerOf(lengths, i, options.delta);
    // A rounding error of the sums must not drop a pair that fits exactly.
    constexpr double kRounding = 1e-9;
    if (std::abs(lengths[j] - lengths[i] - options.delta) >
        tolerance + kRounding) {
      continue;
    }
    const AssociatedPair& a = pairs[i];
    const AssociatedPair& b = pairs[j];
    const Eigen::Vector2d p_a = a.EstimatedPoint();
    const Eigen::Vector2d p_b = b.EstimatedPoint();
    if (!error.has_heading) {
      translation.push_back(
          std::abs((p_b - p_a).norm() - (b.truth.p_WS - a.truth.p_WS).norm()));
      continue;
    }
    const auto pose = [](const Eigen::Vector2d& p, double heading) {
      return Pose2{p.x(), p.y(), WrapAngle(heading)};
    };
    const Pose2 Q = Between(pose(a.truth.p_WS, *a.truth.heading),
                            pose(b.truth.p_WS, *b.truth.heading));
    const Pose2 P = Between(pose(p_a, a.estimate.X_WR.heading),
                            pose(p_b, b.estimate.X_WR.heading));
    const Pose2 E = Between(Q, P);
    translation.push_back(E.position().norm());
    rotation.push_back(std::abs(E.heading));
  }
  error.translation = Summarise(translation);
  error.rotation = Summarise(rotation);
  return error;
}

double PathLength(std::span<const AssociatedPair> pairs) {
  return pairs.empty() ? 0.0 : LengthsOf(pairs, DeltaUnit::kMetres).back();
}

}  // namespace waymark
