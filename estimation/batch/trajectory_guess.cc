#include "estimation/batch/trajectory_guess.h"

#include "estimation/batch/partial_guess.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace waymark {
namespace {

// A fix with x and y, beside where dead reckoning puts its sensor.
struct Anchor {
  double time = 0.0;
  double travelled = 0.0;  // Along the dead-reckoned path, m.
  double sigma = 0.0;      // Of the measured position, m.
  Pose2 X_OR;              // Dead reckoning.
  Eigen::Vector2d p_OS;
  Eigen::Vector2d p_WS;  // Measured.
  std::optional<double> heading_W;
};

// Dead reckoning that can be asked at ascending times.
class Reckoner {
 public:
  Reckoner(const TickTrack& track, const BatchOptions& options)
      : track_(track), options_(options) {}

  const Pose2& To(double time) {
    const TrackMotion step = track_.Integrate(time_,
                                              std::max(time, time_),
                                              options_.initial,
                                              DriveNoise{},
                                              options_.integration);
    X_OR_ = X_OR_ * step.X_R0R1;
    // Straight-line distance: anchors are close compared to a turn's size.
    travelled_ += step.X_R0R1.position().norm();
    time_ = std::max(time, time_);
    return X_OR_;
  }
  [[nodiscard]] double travelled() const { return travelled_; }

 private:
  const TickTrack& track_;
  const BatchOptions& options_;
  double time_ = 0.0;
  double travelled_ = 0.0;
  Pose2 X_OR_;
};

std::vector<Anchor> AnchorsOf(const BatchLogInput& log,
                              std::span<const BatchSensorSlot> sensors,
                              const BatchOptions& options) {
  std::vector<Anchor> anchors;
  Reckoner reckoner(log.track, options);
  for (const BatchFixInput& input : log.fixes) {
    const AbsoluteFix& fix = *input.fix;
    if (!fix.has[0] || !fix.has[1]) continue;
    const Eigen::Vector4d& sensor =
        sensors[static_cast<std::size_t>(input.sensor)].nominal;
    Anchor anchor;
    anchor.time = input.time - sensor(3);
    anchor.X_OR = reckoner.To(anchor.time);
    anchor.travelled = reckoner.travelled();
    anchor.sigma = std::sqrt(fix.covariance.topLeftCorner<2, 2>().trace());
    anchor.p_OS = anchor.X_OR * Eigen::Vector2d(sensor.head<2>());
    anchor.p_WS = fix.X_WF * Eigen::Vector2d(fix.value.head<2>());
    if (fix.has[2]) {
      anchor.heading_W = fix.X_WF.heading + fix.value(2) - sensor(2);
    }
    anchors.push_back(anchor);
  }
  return anchors;
}

// Weighted rigid least squares: X_WO that lays the anchors onto their fixes.
// Nullopt where they do not spread enough to tell the heading.
std::optional<Pose2> AlignWeighted(std::span<const Anchor> anchors,
                                   const std::vector<double>& weights,
                                   double min_spread) {
  Eigen::Vector2d mean_O = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_W = Eigen::Vector2d::Zero();
  double sum = 0.0;
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    mean_O += weights[i] * anchors[i].p_OS;
    mean_W += weights[i] * anchors[i].p_WS;
    sum += weights[i];
  }
  mean_O /= sum;
  mean_W /= sum;
  double along = 0.0;
  double across = 0.0;
  double spread = 0.0;
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    const Eigen::Vector2d o = anchors[i].p_OS - mean_O;
    const Eigen::Vector2d w = anchors[i].p_WS - mean_W;
    along += weights[i] * o.dot(w);
    across += weights[i] * (o.x() * w.y() - o.y() * w.x());
    spread = std::max(spread, o.norm());
  }
  if (spread < min_spread) return std::nullopt;
  Pose2 X_WO{0.0, 0.0, std::atan2(across, along)};
  const Eigen::Vector2d p = mean_W - X_WO * mean_O;
  X_WO.x = p.x();
  X_WO.y = p.y();
  return X_WO;
}

// The same with the sum of distances in place of their squares (Weiszfeld's
// weights): a few wild fixes hardly pull.
std::optional<Pose2> Align(std::span<const Anchor> anchors, double min_spread) {
  constexpr int kNumIterations = 15;  // Halve an outlier's pull each at worst.
  std::vector<double> weights(anchors.size(), 1.0);
  std::optional<Pose2> X_WO;
  for (int k = 0; k < kNumIterations; ++k) {
    X_WO = AlignWeighted(anchors, weights, min_spread);
    if (!X_WO) return X_WO;
    for (std::size_t i = 0; i < anchors.size(); ++i) {
      const double error = (anchors[i].p_WS - *X_WO * anchors[i].p_OS).norm();
      weights[i] = 1.0 / std::max(error, anchors[i].sigma);
    }
  }
  return X_WO;
}

// X_WO near anchor `i`.
std::optional<Pose2> FrameNear(std::span<const Anchor> anchors, std::size_t i) {
  const Anchor& anchor = anchors[i];
  // Half a window of travel: long beside the fixes' noise, short beside what
  // wrong wheel parameters bend.
  const double half_m = std::max(0.25, 10.0 * anchor.sigma);
  std::size_t begin = i;
  std::size_t end = i + 1;
  while (begin > 0 && anchor.travelled - anchors[begin].travelled < half_m) {
    --begin;
  }
  while (end < anchors.size() &&
         anchors[end - 1].travelled - anchor.travelled < half_m) {
    ++end;
  }
  // A quarter of the half window, not all of it: a tight turn covers travel
  // without covering distance.
  const auto X_WO = Align(anchors.subspan(begin, end - begin), 0.25 * half_m);
  if (X_WO) return X_WO;
  if (!anchor.heading_W) return std::nullopt;
  const Pose2 turn{0.0, 0.0, *anchor.heading_W - anchor.X_OR.heading};
  const Eigen::Vector2d p = anchor.p_WS - turn * anchor.p_OS;
  return Pose2{p.x(), p.y(), WrapAngle(turn.heading)};
}

struct Frame {
  double time = 0.0;
  Pose2 X_WO;
  Eigen::Vector2d p_OR = Eigen::Vector2d::Zero();  // Where it is used.
};

// The frame among the neighbours of `i` that agrees best with the others: one
// window full of wild fixes may lay the path down backwards.
Frame AgreedFrame(std::span<const Frame> frames, std::size_t i) {
  constexpr std::size_t kReach = 4;  // Five of nine agree where half are good.
  const std::size_t begin = i < kReach ? 0 : i - kReach;
  const std::size_t end = std::min(frames.size(), i + kReach + 1);
  Frame best = frames[i];
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t j = begin; j < end; ++j) {
    double sum = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      // 1 m weighs as much as 1 rad.
      sum +=
          std::abs(WrapAngle(frames[j].X_WO.heading - frames[k].X_WO.heading));
      sum += (frames[j].X_WO * frames[i].p_OR - frames[k].X_WO * frames[i].p_OR)
                 .norm();
    }
    if (sum < least) {
      least = sum;
      best.X_WO = frames[j].X_WO;
    }
  }
  return best;
}

// X_WO along the log; empty where no fix carries a position.
std::vector<Frame> FramesOf(const std::vector<Anchor>& anchors) {
  std::vector<Frame> raw;
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    const auto X_WO = FrameNear(anchors, i);
    if (X_WO) {
      raw.push_back({anchors[i].time, *X_WO, anchors[i].X_OR.position()});
    }
  }
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    frames.push_back(AgreedFrame(raw, i));
  }
  if (frames.empty() && !anchors.empty()) {
    // Too little spread anywhere: the place is known, the heading is not.
    const Eigen::Vector2d p = anchors[0].p_WS - anchors[0].p_OS;
    frames.push_back({.time = anchors[0].time, .X_WO = {p.x(), p.y(), 0.0}});
  }
  return frames;
}

}  // namespace

std::vector<Eigen::Vector3d> GuessTrajectory(
    const BatchLogInput& log,
    std::span<const BatchSensorSlot> sensors,
    std::span<const double> times,
    const BatchOptions& options) {
  const std::vector<Frame> frames = FramesOf(AnchorsOf(log, sensors, options));
  if (frames.empty()) return GuessFromParts(log, sensors, times, options);
  Reckoner reckoner(log.track, options);
  std::vector<Eigen::Vector3d> poses;
  std::size_t frame = 0;
  for (const double time : times) {
    while (frame + 1 < frames.size() &&
           std::abs(frames[frame + 1].time - time) <=
               std::abs(frames[frame].time - time)) {
      ++frame;
    }
    const Pose2 X_WR = frames[frame].X_WO * reckoner.To(time);
    Eigen::Vector3d pose = X_WR.vector();
    if (!poses.empty()) {
      pose(2) = poses.back()(2) + WrapAngle(pose(2) - poses.back()(2));
    }
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace waymark
