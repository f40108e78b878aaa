#include "estimation/camera/calibrate_camera.h"

#include "estimation/camera/calibration_problem.h"
#include "estimation/camera/calibration_start.h"

#include <Eigen/Eigenvalues>
#include <ceres/crs_matrix.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

// Leaves out corners that are off. True where any is.
bool LeaveOut(const CalibrationState& state, CalibrationProblem* problem) {
  const auto distances = CornerDistances(*problem, state);
  std::vector<double> all;
  for (const auto& list : distances) {
    all.insert(all.end(), list.begin(), list.end());
  }
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  // Median of a Rayleigh distribution, in sigmas; below the least that corners
  // are ever known to, all are good.
  constexpr double kMedian = 1.1774;
  constexpr double kLeastSigma = 1e-3;
  const double gate = problem->options.max_corner_sigmas *
                      std::max(*middle / kMedian, kLeastSigma);
  bool is_changed = false;
  for (std::size_t v = 0; v < distances.size(); ++v) {
    for (std::size_t i = 0; i < distances[v].size(); ++i) {
      const bool is_seen = std::isfinite(distances[v][i]);
      const char is_used = is_seen && distances[v][i] <= gate ? 1 : 0;
      is_changed |= is_used != problem->is_used[v][i];
      problem->is_used[v][i] = is_used;
    }
  }
  return is_changed;
}

void AddViews(const CalibrationProblem& problem,
              const CalibrationState& state,
              CameraCalibration* result) {
  const auto distances = CornerDistances(problem, state);
  double sum = 0.0;
  int num = 0;
  for (std::size_t v = 0; v < distances.size(); ++v) {
    ViewCalibration view;
    view.X_CB = PoseFromBlock(state.poses[v]);
    double squares = 0.0;
    for (std::size_t i = 0; i < distances[v].size(); ++i) {
      if (problem.is_used[v][i] == 0) {
        ++view.num_left_out;
        continue;
      }
      ++view.num_used;
      squares += distances[v][i] * distances[v][i];
      view.max_px = std::max(view.max_px, distances[v][i]);
    }
    view.rms_px = std::sqrt(squares / view.num_used);
    sum += squares;
    num += view.num_used;
    result->views.push_back(view);
  }
  result->rms_px = std::sqrt(sum / num);
}

// Of the camera's numbers that are estimated, for corners of sigma 1 px;
// nullopt where the views do not show all of them.
std::optional<Eigen::VectorXd> CameraVariances(
    const CalibrationProblem& problem,
    Eigen::Index num_free,
    CalibrationState* state) {
  const auto built = BuildProblem(problem, CalibrationStage::kAll, state);
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = {state->values.data()};
  for (auto& pose : state->poses) {
    options.parameter_blocks.push_back(pose.data());
  }
  ceres::CRSMatrix sparse;
  if (!built->Evaluate(options, nullptr, nullptr, nullptr, &sparse)) {
    return std::nullopt;
  }
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    const auto r = static_cast<std::size_t>(row);
    for (int i = sparse.rows[r]; i < sparse.rows[r + 1]; ++i) {
      const auto k = static_cast<std::size_t>(i);
      J(row, sparse.cols[k]) = sparse.values[k];
    }
  }
  // Columns of unit length: focal lengths and tangential coefficients do not
  // share a scale.
  const Eigen::VectorXd scale = J.colwise().norm();
  if (!(scale.minCoeff() > 0.0)) return std::nullopt;
  J *= scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(J.transpose() *
                                                              J);
  // The squares of singular values, of which the smallest must not be rounding.
  constexpr double kRankTolerance = 1e-12;
  const Eigen::VectorXd& values = solver.eigenvalues();
  if (solver.info() != Eigen::Success ||
      !(values(0) > kRankTolerance * values(values.size() - 1))) {
    return std::nullopt;
  }
  const Eigen::MatrixXd rows = solver.eigenvectors().topRows(num_free);
  const Eigen::VectorXd variances =
      (rows.array().square().matrix() * values.cwiseInverse());
  return variances.cwiseQuotient(scale.head(num_free).cwiseAbs2());
}

// False where the views do not show all that is to be estimated.
bool AddSigmas(const CalibrationProblem& problem,
               CalibrationState* state,
               CameraCalibration* result) {
  const std::vector<int> constant =
      ConstantParameters(problem.options, CalibrationStage::kAll);
  const Eigen::Index size = state->values.size();
  const Eigen::Index num_free =
      size - static_cast<Eigen::Index>(constant.size());
  Eigen::Index surplus =
      -num_free - 6 * static_cast<Eigen::Index>(problem.views.size());
  for (const ViewCalibration& view : result->views) {
    surplus += 2 * view.num_used;
  }
  if (surplus <= 0) return false;
  result->sigma_px =
      std::sqrt(2.0 * state->cost / static_cast<double>(surplus));
  const auto variances = CameraVariances(problem, num_free, state);
  if (!variances) return false;
  result->sigma.setZero(size);
  for (Eigen::Index i = 0, k = 0; i < size; ++i) {
    const bool is_constant =
        std::find(constant.begin(), constant.end(), i) != constant.end();
    if (!is_constant) {
      result->sigma(i) = result->sigma_px * std::sqrt((*variances)(k));
      ++k;
    }
  }
  return result->sigma.allFinite();
}

void CheckViews(std::span<const BoardView> views) {
  for (const BoardView& view : views) {
    if (view.pixels.size() != view.points_B.size()) {
      throw std::invalid_argument("a view has not as many pixels as points");
    }
    for (std::size_t i = 0; i < view.pixels.size(); ++i) {
      if (!view.pixels[i].allFinite() || !view.points_B[i].allFinite()) {
        throw std::invalid_argument("a corner is not finite");
      }
    }
  }
}

}  // namespace

void CalibrationOptions::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(what);
  };
  require(kind != CameraKind::kPanorama, "kind: a panorama has no lens");
  require(size.width > 0 && size.height > 0, "size must be positive");
  const int most = kind == CameraKind::kFisheye ? 4 : 5;
  require(num_distortion >= 0 && num_distortion <= most,
          kind == CameraKind::kFisheye
              ? "num_distortion must be in [0, 4] for a fisheye"
              : "num_distortion must be in [0, 5]");
  require(!xi || (kind == CameraKind::kSphere && *xi >= 0.0 && *xi <= 10.0),
          "xi goes with a sphere camera and must be in [0, 10]");
  require(max_corner_sigmas >= 3.0, "max_corner_sigmas must be at least 3");
}

CalibrationReport CalibrateCamera(std::span<const BoardView> views,
                                  const CalibrationOptions& options) {
  options.Check();
  CheckViews(views);
  CalibrationProblem problem{options, views, {}};
  for (const BoardView& view : views) {
    if (view.pixels.size() < 4) {
      return {std::nullopt, "a view has fewer than four corners"};
    }
    problem.is_used.emplace_back(view.pixels.size(), 1);
  }
  if (views.size() < 2) return {std::nullopt, "fewer than two views"};
  std::optional<CalibrationState> state = SolveFromStarts(problem);
  if (!state) {
    return {std::nullopt,
            "no camera of this model explains the views; is the board's size "
            "right, and its corners in the same order everywhere?"};
  }
  // What is off pulls its neighbours, which are good again without it.
  constexpr int kMaxRounds = 10;
  for (int i = 0; i < kMaxRounds && LeaveOut(*state, &problem); ++i) {
    for (const auto& is_used : problem.is_used) {
      if (std::count(is_used.begin(), is_used.end(), 1) < 4) {
        return {std::nullopt, "a view's corners contradict the others'"};
      }
    }
    if (!Solve(problem, CalibrationStage::kAll, kFineGain, &*state)) {
      return {std::nullopt, "the refinement did not converge"};
    }
  }
  CameraCalibration result;
  result.camera = *problem.CameraOf(state->values);
  AddViews(problem, *state, &result);
  if (!std::isfinite(result.rms_px)) {
    return {std::nullopt, "no lens of this model reaches all corners"};
  }
  constexpr double kUseful = 0.2;  // Of the focal length.
  if (!AddSigmas(problem, &*state, &result) ||
      result.sigma(0) > kUseful * state->values(0)) {
    return {std::nullopt,
            "the views do not show all parameters: more of them are needed, "
            "with the board tilted and over the whole image"};
  }
  return {std::move(result), ""};
}

}  // namespace waymark
