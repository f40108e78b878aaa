#include "estimation/camera/calibration_start.h"

#include "estimation/camera/board_pose.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace waymark {
namespace {

// Poses by the linear method for a camera without distortion of this focal
// length, and how far its pixels are off.
std::optional<CalibrationState> Start(const CalibrationProblem& problem,
                                      double focal) {
  const CalibrationOptions& options = problem.options;
  CalibrationState state;
  state.values.setZero(
      static_cast<Eigen::Index>(ParameterNames(options.kind).size()));
  state.values.head<4>() << focal, options.is_mirrored ? -focal : focal,
      0.5 * (options.size.width - 1), 0.5 * (options.size.height - 1);
  if (options.kind == CameraKind::kSphere) {
    state.values(4) = options.xi.value_or(1.0);
  }
  const auto camera = problem.CameraOf(state.values);
  state.cost = 0.0;
  for (const BoardView& view : problem.views) {
    std::vector<Eigen::Vector3d> rays;
    for (const Eigen::Vector2d& pixel : view.pixels) {
      const auto back = RayFromPixel(*camera, pixel);
      if (!back) return std::nullopt;
      rays.push_back(back->ray);
    }
    const auto X_CB = BoardPoseFromRays(rays, view.points_B);
    if (!X_CB) return std::nullopt;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto seen =
          PixelFromRay(*camera, *X_CB * OnBoard(view.points_B[i]));
      if (!seen) return std::nullopt;
      state.cost += (seen->pixel - view.pixels[i]).squaredNorm();
    }
    state.poses.push_back(BlockFromPose(*X_CB));
  }
  return state;
}

// The likeliest starts first.
std::vector<CalibrationState> Starts(const CalibrationProblem& problem) {
  // From a fisheye whose circle is a third of the image to a lens of 10
  // degrees, a factor of 1.25 apart: the linear poses bear that much.
  constexpr double kShortest = 0.1;
  constexpr double kLongest = 6.0;
  constexpr double kStep = 1.25;
  const int size =
      std::max(problem.options.size.width, problem.options.size.height);
  std::vector<CalibrationState> starts;
  for (double share = kShortest; share < kLongest; share *= kStep) {
    if (auto start = Start(problem, share * size)) {
      starts.push_back(std::move(*start));
    }
  }
  std::stable_sort(starts.begin(),
                   starts.end(),
                   [](const CalibrationState& a, const CalibrationState& b) {
                     return a.cost < b.cost;
                   });
  constexpr std::size_t kTried = 8;
  if (starts.size() > kTried) starts.resize(kTried);
  return starts;
}

// Sum of squares over the used corners of each view.
std::vector<double> ViewCosts(const CalibrationProblem& problem,
                              const CalibrationState& state) {
  const auto distances = CornerDistances(problem, state);
  std::vector<double> costs(distances.size(), 0.0);
  for (std::size_t v = 0; v < distances.size(); ++v) {
    for (std::size_t i = 0; i < distances[v].size(); ++i) {
      if (problem.is_used[v][i] == 0) continue;
      costs[v] += distances[v][i] * distances[v][i];
    }
  }
  return costs;
}

// The board as it looks alike from afar: tilted the other way about the line
// of sight to its middle.
Eigen::Isometry3d OtherTilt(const Eigen::Isometry3d& X_CB,
                            const BoardView& view) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& point : view.points_B) middle += OnBoard(point);
  middle /= static_cast<double>(view.points_B.size());
  const Eigen::Vector3d centre = X_CB * middle;
  const Eigen::Vector3d sight = centre.normalized();
  const Eigen::Matrix<double, 3, 2> axes = X_CB.linear().leftCols<2>();
  const Eigen::Matrix<double, 3, 2> other =
      axes - 2.0 * sight * (sight.transpose() * axes);
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() << other, other.col(0).cross(other.col(1));
  result.translation() = centre - result.linear() * middle;
  return result;
}

// A lens that is still wrong may have tipped a board over its flat position,
// from where no small step leads back. True where a pose is the better for it.
bool TipBack(const CalibrationProblem& problem, CalibrationState* state) {
  CalibrationState tipped = *state;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    tipped.poses[v] = BlockFromPose(
        OtherTilt(PoseFromBlock(state->poses[v]), problem.views[v]));
  }
  std::vector<double> after = ViewCosts(problem, tipped);
  for (std::size_t v = 0; v < after.size(); ++v) {
    if (!std::isfinite(after[v])) tipped.poses[v] = state->poses[v];
  }
  if (!Solve(problem, CalibrationStage::kPoses, kCoarseGain, &tipped))
    return false;
  const std::vector<double> before = ViewCosts(problem, *state);
  after = ViewCosts(problem, tipped);
  bool is_changed = false;
  for (std::size_t v = 0; v < before.size(); ++v) {
    if (!(after[v] < before[v])) continue;
    // Where it came back to the pose it had the two differ by rounding.
    constexpr double kSame = 1e-6;  // rad.
    const Eigen::Isometry3d change = PoseFromBlock(state->poses[v]).inverse() *
                                     PoseFromBlock(tipped.poses[v]);
    if (Eigen::AngleAxisd(change.linear()).angle() < kSame) continue;
    state->poses[v] = tipped.poses[v];
    is_changed = true;
  }
  return is_changed;
}

}  // namespace

std::optional<CalibrationState> SolveFromStarts(
    const CalibrationProblem& problem) {
  std::optional<CalibrationState> best;
  std::vector<double> costs;  // With focal lengths and poses alone.
  for (CalibrationState& start : Starts(problem)) {
    if (!Solve(problem, CalibrationStage::kFocalLengths, kCoarseGain, &start)) {
      continue;
    }
    // Where this is what another start came to, so is all that follows.
    constexpr double kSame = 1e-3;
    const bool is_known =
        std::any_of(costs.begin(), costs.end(), [&](double cost) {
          return std::abs(start.cost - cost) <= kSame * cost;
        });
    costs.push_back(start.cost);
    if (!is_known &&
        Solve(problem, CalibrationStage::kAll, kCoarseGain, &start) &&
        (!best || start.cost < best->cost)) {
      best = std::move(start);
    }
  }
  const auto refine = [&] {
    return Solve(problem, CalibrationStage::kAll, kFineGain, &*best);
  };
  if (!best || !refine()) return std::nullopt;
  constexpr int kMaxRounds = 5;
  for (int i = 0; i < kMaxRounds && TipBack(problem, &*best); ++i) {
    if (!refine()) return std::nullopt;
  }
  return best;
}

}  // namespace waymark
