#include "estimation/batch/batch_refiner.h"

#include "estimation/batch/batch_graph.h"
#include "estimation/batch/batch_input.h"
#include "estimation/batch/batch_marginal.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace waymark {
namespace {

// Rounds end when no wheel parameter moved by more than this share of its own
// value: a hundredth of the 1e-4 that the best recordings resolve.
constexpr double kSettled = 1e-6;
// ... and no sensor by more than this (m, rad, s): a tenth of a micrometre.
constexpr double kSensorSettled = 1e-7;
// Bounds of a plausible wheel parameter as a multiple of its initial value.
constexpr double kMaxScale = 4.0;

struct RoundReport {
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int num_iterations = 0;
  bool is_usable = false;
};

RoundReport SolveRound(const BatchInput& input,
                       const BatchOptions& options,
                       const std::vector<BatchFactor>& factors,
                       bool is_first,
                       BatchState* state) {
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  for (const BatchFactor& factor : factors) {
    problem.AddResidualBlock(
        factor.cost.get(), factor.loss.get(), factor.blocks);
  }
  for (std::size_t i = 0; i < state->sensors.size(); ++i) {
    const std::array<bool, 4> is_estimated = input.sensors[i].IsEstimated();
    std::vector<int> held;
    for (int k = 0; k < 4; ++k) {
      if (!is_estimated[static_cast<std::size_t>(k)]) held.push_back(k);
    }
    double* block = state->sensors[i].data();
    if (held.size() == 4) {
      problem.SetParameterBlockConstant(block);
    } else if (!held.empty()) {
      problem.SetManifold(block, new ceres::SubsetManifold(4, held));
    }
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // Single-threaded and without BLAS: the same bits on every run.
  solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  solver.num_threads = 1;
  solver.max_num_iterations = options.max_iterations;
  // The first round's weights are replaced anyway. Later ones stop where a cost
  // of some thousands changes by far less than the 1 that means one sigma.
  solver.function_tolerance = is_first ? 1e-6 : 1e-11;
  solver.parameter_tolerance = 1e-12;
  solver.gradient_tolerance = 1e-12;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  return {summary.initial_cost,
          summary.final_cost,
          static_cast<int>(summary.iterations.size()),
          summary.IsSolutionUsable()};
}

// Largest change between two states beside what counts as settled.
double ChangeOf(const BatchState& before, const BatchState& after) {
  double change = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    change = std::max(change,
                      std::abs(after.wheels[i] - before.wheels[i]) / kSettled);
  }
  for (std::size_t i = 0; i < before.sensors.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      change = std::max(change,
                        std::abs(after.sensors[i][k] - before.sensors[i][k]) /
                            kSensorSettled);
    }
  }
  return change;
}

double MedianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string TextOf(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

class Refinement {
 public:
  Refinement(std::span<const BatchLog> logs, const BatchOptions& options)
      : options_(options), input_(PrepareBatch(logs, options)) {
    result_.num_refused = input_.num_refused;
    result_.num_measurements = input_.num_measurements;
    result_.travel_m = input_.travel_m;
    result_.newest = input_.newest;
  }

  BatchResult Run() {
    if (input_.num_measurements == 0) {
      NoAnswer(BatchStatus::kNoData,
               "no usable measurement inside the encoder readings");
    } else if (input_.travel_m < options_.min_travel_m) {
      NoAnswer(BatchStatus::kTooLittleMotion,
               "the wheels travelled " + TextOf(input_.travel_m) +
                   " m, less than " + TextOf(options_.min_travel_m) + " m");
    } else {
      state_ = FirstState(input_, options_);
      if (SolveRounds()) Conclude();
    }
    return std::move(result_);
  }

 private:
  void NoAnswer(BatchStatus status, std::string reason) {
    result_.status = status;
    result_.reason = std::move(reason);
    result_.parameters = options_.initial;
    result_.covariance = options_.initial.vector()
                             .cwiseProduct(options_.relative_sigma)
                             .cwiseAbs2()
                             .asDiagonal();
    result_.observability.setZero();
  }

  bool SolveRounds() {
    bool is_settled = false;
    for (int round = 0; round < options_.max_rounds && !is_settled; ++round) {
      if (round > 0) RenewKeyframes(input_, options_, &state_);
      // Huber first: far outliers cannot be told before the fit.
      const bool is_first = round == 0 && options_.loss != BatchLoss::kNone;
      const BatchState before = state_;
      const std::vector<BatchFactor> factors =
          BuildFactors(input_,
                       options_,
                       is_first ? BatchLoss::kHuber : options_.loss,
                       &state_);
      const RoundReport report =
          SolveRound(input_, options_, factors, is_first, &state_);
      result_.num_rounds = round + 1;
      result_.num_iterations += report.num_iterations;
      result_.final_cost = report.final_cost;
      if (round == 0) result_.initial_cost = report.initial_cost;
      if (!report.is_usable) {
        NoAnswer(BatchStatus::kNotConverged,
                 "the solver gave up on round " + std::to_string(round + 1));
        return false;
      }
      if (!IsPlausible()) return false;
      is_settled = !is_first && ChangeOf(before, state_) < 1.0;
    }
    return true;
  }

  bool IsPlausible() {
    constexpr std::array<const char*, 3> kNames{
        "k_right", "k_left", "wheel_base"};
    for (std::size_t i = 0; i < 3; ++i) {
      const double scale = state_.wheels[i];
      if (scale > kMaxScale || scale < 1.0 / kMaxScale) {
        NoAnswer(BatchStatus::kImplausible,
                 std::string(kNames[i]) + " went to " + TextOf(scale) +
                     " times its initial value: wheels swapped or reversed?");
        return false;
      }
    }
    return true;
  }

  void Conclude() {
    const std::vector<BatchFactor> factors =
        BuildFactors(input_, options_, options_.loss, &state_);
    const auto marginal = ComputeMarginal(input_, state_, factors);
    if (!marginal) {
      NoAnswer(BatchStatus::kNotConverged,
               "the information matrix is not positive definite");
      return;
    }
    const int num_keyframes = CountKeyframes();
    const double freedom = marginal->num_residuals - 3.0 * num_keyframes -
                           static_cast<double>(marginal->covariance.rows());
    result_.num_keyframes = num_keyframes;
    result_.variance_factor =
        freedom >= 1.0 ? marginal->weighted_squares / freedom : 1.0;
    const double scale = options_.scale_covariance
                             ? std::max(1.0, result_.variance_factor)
                             : 1.0;
    FillWheels(marginal->covariance, scale);
    FillSensors(*marginal, scale);
    FillResiduals(factors);
    if (options_.keep_trajectory) FillTrajectories();
    Judge();
  }

  int CountKeyframes() const {
    std::size_t count = 0;
    for (const auto& log : state_.logs) count += log.size();
    return static_cast<int>(count);
  }

  void FillWheels(const Eigen::MatrixXd& covariance, double scale) {
    result_.parameters = state_.Wheels(options_.initial);
    const Eigen::Vector3d unit = options_.initial.vector();
    result_.covariance = scale * unit.asDiagonal() *
                         covariance.topLeftCorner<3, 3>() * unit.asDiagonal();
    for (int i = 0; i < 3; ++i) {
      const double prior = std::pow(options_.relative_sigma(i), 2);
      // Scaled too: noise that was stated too small is no knowledge.
      result_.observability(i) =
          std::clamp(1.0 - scale * covariance(i, i) / prior, 0.0, 1.0);
    }
  }

  void FillSensors(const BatchMarginal& marginal, double scale) {
    for (std::size_t i = 0; i < input_.sensors.size(); ++i) {
      const BatchSensorSlot& slot = input_.sensors[i];
      const std::array<double, 4>& block = state_.sensors[i];
      BatchSensor sensor;
      sensor.source = slot.source;
      sensor.log = slot.log;
      sensor.X_RS = {block[0], block[1], WrapAngle(block[2])};
      sensor.time_offset_s = block[3];
      sensor.is_estimated = slot.IsEstimated();
      const Eigen::Vector4d prior = slot.PriorSigma().cwiseAbs2();
      const std::array<int, 4>& columns = marginal.sensor_columns[i];
      for (int a = 0; a < 4; ++a) {
        const int row = columns[static_cast<std::size_t>(a)];
        if (row < 0) continue;
        for (int b = 0; b < 4; ++b) {
          const int column = columns[static_cast<std::size_t>(b)];
          if (column < 0) continue;
          sensor.covariance(a, b) = scale * marginal.covariance(row, column);
        }
        sensor.observability(a) =
            std::clamp(1.0 - sensor.covariance(a, a) / prior(a), 0.0, 1.0);
      }
      result_.sensors.push_back(std::move(sensor));
    }
  }

  void FillResiduals(const std::vector<BatchFactor>& factors);
  void FillTrajectories();
  void Judge();

  const BatchOptions& options_;
  BatchInput input_;
  BatchState state_;
  BatchResult result_;
};

// Position and heading parts of a measurement's residual in m and rad.
struct PlainResidual {
  std::optional<double> position_m;
  std::optional<double> heading_rad;
};

PlainResidual PlainResidualOf(const Eigen::VectorXd& whitened,
                              const std::array<bool, 3>& has,
                              const Eigen::Matrix3d& covariance) {
  std::vector<int> present;
  for (int i = 0; i < 3; ++i) {
    if (has[static_cast<std::size_t>(i)]) present.push_back(i);
  }
  const Eigen::LLT<Eigen::MatrixXd> llt(
      Eigen::MatrixXd(covariance(present, present)));
  const Eigen::VectorXd plain = llt.matrixL() * whitened;
  PlainResidual residual;
  double squares = 0.0;
  for (std::size_t i = 0; i < present.size(); ++i) {
    const double value = plain(static_cast<Eigen::Index>(i));
    if (present[i] == 2) {
      residual.heading_rad = std::abs(value);
    } else {
      squares += value * value;
      residual.position_m = std::sqrt(squares);
    }
  }
  return residual;
}

void Refinement::FillResiduals(const std::vector<BatchFactor>& factors) {
  std::vector<std::vector<double>> positions(result_.sensors.size());
  std::vector<std::vector<double>> headings(result_.sensors.size());
  int num_inliers = 0;
  int num_all = 0;
  for (const BatchFactor& factor : factors) {
    if (factor.sensor < 0) continue;
    const auto slot = static_cast<std::size_t>(factor.sensor);
    const BatchLogInput& log =
        input_.logs[static_cast<std::size_t>(factor.log)];
    const auto index = static_cast<std::size_t>(factor.index);
    Eigen::VectorXd r(factor.cost->num_residuals());
    factor.cost->Evaluate(factor.blocks.data(), r.data(), nullptr);
    const bool is_fix = factor.kind == FactorKind::kFix;
    const PlainResidual plain = PlainResidualOf(
        r,
        is_fix ? log.fixes[index].fix->has : std::array{true, true, true},
        is_fix ? log.fixes[index].fix->covariance
               : log.motions[index].motion->covariance);
    if (plain.position_m) positions[slot].push_back(*plain.position_m);
    if (plain.heading_rad) headings[slot].push_back(*plain.heading_rad);
    BatchSensor& sensor = result_.sensors[slot];
    const bool is_inlier =
        r.squaredNorm() <= InlierGate(static_cast<int>(r.size()));
    ++sensor.num_measurements;
    sensor.num_inliers += is_inlier ? 1 : 0;
    ++num_all;
    num_inliers += is_inlier ? 1 : 0;
  }
  for (std::size_t i = 0; i < result_.sensors.size(); ++i) {
    result_.sensors[i].median_position_m = MedianOf(std::move(positions[i]));
    result_.sensors[i].median_heading_rad = MedianOf(std::move(headings[i]));
  }
  result_.inlier_share =
      num_all > 0 ? static_cast<double>(num_inliers) / num_all : 0.0;
}

void Refinement::FillTrajectories() {
  for (std::size_t i = 0; i < state_.logs.size(); ++i) {
    std::vector<TimedPose> trajectory;
    for (const BatchState::Keyframe& keyframe : state_.logs[i]) {
      trajectory.push_back(
          {input_.logs[i].track.TimeAt(keyframe.time),
           Pose2::FromVector(Eigen::Vector3d(keyframe.pose.data()))});
    }
    result_.trajectories.push_back(std::move(trajectory));
  }
}

void Refinement::Judge() {
  constexpr std::array<const char*, 3> kNames{
      "k_right", "k_left", "wheel_base"};
  std::string unknown;
  int num_unknown = 0;
  for (int i = 0; i < 3; ++i) {
    if (result_.observability(i) >= options_.min_observability) continue;
    unknown += (unknown.empty() ? "" : ", ") +
               std::string(kNames[static_cast<std::size_t>(i)]);
    ++num_unknown;
  }
  if (num_unknown == 0) {
    result_.status = BatchStatus::kSolved;
  } else if (num_unknown < 3) {
    result_.status = BatchStatus::kPartly;
    result_.reason = "not observable: " + unknown;
  } else {
    NoAnswer(BatchStatus::kNotObservable,
             "no wheel parameter is observable in these measurements");
  }
}

}  // namespace

BatchResult RefineBatch(std::span<const BatchLog> logs,
                        const BatchOptions& options) {
  options.Check();
  return Refinement(logs, options).Run();
}

}  // namespace waymark
