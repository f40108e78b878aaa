#include "estimation/camera/calibration_problem.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

// exp(w + d) = exp(w) exp(J d) to first order in d.
Eigen::Matrix3d RightJacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = Cross(w);
  // Below this the next terms of both series are rounding.
  constexpr double kSmall = 1e-4;
  double first = 0.5 - angle * angle / 24.0;
  double second = 1.0 / 6.0 - angle * angle / 120.0;
  if (angle > kSmall) {
    first = (1.0 - std::cos(angle)) / (angle * angle);
    second = (angle - std::sin(angle)) / (angle * angle * angle);
  }
  return Eigen::Matrix3d::Identity() - first * W + second * W * W;
}

// All used corners of a view: pixels that the model gives minus those seen.
class ViewCost final : public ceres::CostFunction {
 public:
  ViewCost(const CalibrationProblem& problem, std::size_t view)
      : problem_(problem), view_(problem.views[view]) {
    for (std::size_t i = 0; i < view_.pixels.size(); ++i) {
      if (problem.is_used[view][i] != 0) corners_.push_back(i);
    }
    num_parameters_ =
        static_cast<Eigen::Index>(ParameterNames(problem.options.kind).size());
    set_num_residuals(static_cast<int>(2 * corners_.size()));
    *mutable_parameter_block_sizes() = {static_cast<int>(num_parameters_), 6};
  }

  bool Evaluate(double const* const* blocks,
                double* residuals,
                double** jacobians) const override {
    const Eigen::VectorXd values =
        Eigen::Map<const Eigen::VectorXd>(blocks[0], num_parameters_);
    const auto camera = problem_.CameraOf(values);
    if (!camera) return false;
    const Eigen::Isometry3d X_CB =
        PoseFromBlock(Eigen::Map<const CalibrationState::Pose>(blocks[1]));
    const Eigen::Matrix3d J =
        RightJacobian(Eigen::Map<const Eigen::Vector3d>(blocks[1]));
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Eigen::Vector3d point_B = OnBoard(view_.points_B[corners_[k]]);
      const auto seen = PixelFromRay(*camera, X_CB * point_B);
      if (!seen) return false;
      Eigen::Map<Eigen::Vector2d>(residuals + 2 * k) =
          seen->pixel - view_.pixels[corners_[k]];
      if (jacobians == nullptr || jacobians[1] == nullptr) continue;
      Eigen::Matrix<double, 3, 6> d_pose;
      d_pose << -X_CB.linear() * Cross(point_B) * J,
          Eigen::Matrix3d::Identity();
      Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>>(
          jacobians[1] + 12 * k) = seen->d_point * d_pose;
    }
    return jacobians == nullptr || jacobians[0] == nullptr ||
           DifferentiateByCamera(values, X_CB, jacobians[0]);
  }

 private:
  // Central differences: one way for every model, and exact to nine digits.
  bool DifferentiateByCamera(const Eigen::VectorXd& values,
                             const Eigen::Isometry3d& X_CB,
                             double* jacobian) const {
    const auto rows = static_cast<Eigen::Index>(2 * corners_.size());
    Eigen::Map<
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
        d_camera(jacobian, rows, num_parameters_);
    for (Eigen::Index p = 0; p < num_parameters_; ++p) {
      const double step = 1e-6 * (p < 4 ? values(0) : 1.0);
      std::array<std::optional<CameraModel>, 2> cameras;
      for (const int side : {0, 1}) {
        Eigen::VectorXd changed = values;
        changed(p) += side == 0 ? step : -step;
        cameras[static_cast<std::size_t>(side)] = problem_.CameraOf(changed);
      }
      if (!cameras[0] || !cameras[1]) return false;
      for (std::size_t k = 0; k < corners_.size(); ++k) {
        const Eigen::Vector3d point =
            X_CB * OnBoard(view_.points_B[corners_[k]]);
        const auto plus = PixelFromRay(*cameras[0], point);
        const auto minus = PixelFromRay(*cameras[1], point);
        if (!plus || !minus) return false;
        d_camera.block<2, 1>(static_cast<Eigen::Index>(2 * k), p) =
            (plus->pixel - minus->pixel) / (2.0 * step);
      }
    }
    return true;
  }

  const CalibrationProblem& problem_;
  const BoardView& view_;
  std::vector<std::size_t> corners_;
  Eigen::Index num_parameters_ = 0;
};

}  // namespace

std::optional<CameraModel> CalibrationProblem::CameraOf(
    const Eigen::VectorXd& values) const {
  if (!(values(0) > 0.0) || (values(1) < 0.0) != options.is_mirrored) {
    return std::nullopt;
  }
  try {
    return CameraFromParameters(options.kind, values);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

CalibrationState::Pose BlockFromPose(const Eigen::Isometry3d& X_CB) {
  const Eigen::AngleAxisd turn(X_CB.linear());
  CalibrationState::Pose block;
  block << turn.angle() * turn.axis(), X_CB.translation();
  return block;
}

Eigen::Isometry3d PoseFromBlock(const CalibrationState::Pose& block) {
  const Eigen::Vector3d w = block.head<3>();
  const double angle = w.norm();
  Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
  if (angle > 0.0) {
    X_CB.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  }
  X_CB.translation() = block.tail<3>();
  return X_CB;
}

Eigen::Vector3d OnBoard(const Eigen::Vector2d& point) {
  return {point.x(), point.y(), 0.0};
}

std::vector<int> ConstantParameters(const CalibrationOptions& options,
                                    CalibrationStage stage) {
  std::vector<int> constant;
  const bool is_sphere = options.kind == CameraKind::kSphere;
  const int lens = is_sphere ? 5 : 4;
  const int size = static_cast<int>(ParameterNames(options.kind).size());
  for (int i = 2; i < size; ++i) {
    const bool is_xi = is_sphere && i == 4;
    const bool is_kept =
        stage == CalibrationStage::kFocalLengths ||
        (is_xi ? options.xi.has_value() : i >= lens + options.num_distortion);
    if (is_kept) constant.push_back(i);
  }
  return constant;
}

std::unique_ptr<ceres::Problem> BuildProblem(const CalibrationProblem& problem,
                                             CalibrationStage stage,
                                             CalibrationState* state) {
  auto result = std::make_unique<ceres::Problem>();
  for (std::size_t i = 0; i < problem.views.size(); ++i) {
    result->AddResidualBlock(new ViewCost(problem, i),
                             nullptr,
                             state->values.data(),
                             state->poses[i].data());
  }
  const std::vector<int> constant = ConstantParameters(problem.options, stage);
  if (!constant.empty()) {
    result->SetManifold(state->values.data(),
                        new ceres::SubsetManifold(
                            static_cast<int>(state->values.size()), constant));
  }
  return result;
}

bool Solve(const CalibrationProblem& problem,
           CalibrationStage stage,
           CalibrationState* state) {
  const auto built = BuildProblem(problem, stage, state);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.num_threads = 1;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, built.get(), &summary);
  state->cost = summary.final_cost;
  return summary.IsSolutionUsable();
}

}  // namespace waymark
