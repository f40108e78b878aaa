#include "estimation/camera/calibration_problem.h"

#include <ceres/ceres.h>

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
      const Eigen::Vector3d point_C = X_CB * point_B;
      const auto seen = ExtendedPixelFromRay(*camera, point_C);
      if (!seen) return false;
      Eigen::Map<Eigen::Vector2d>(residuals + 2 * k) =
          seen->pixel - view_.pixels[corners_[k]];
      if (jacobians == nullptr) continue;
      const auto row = static_cast<Eigen::Index>(2 * k);
      if (jacobians[0] != nullptr) {
        const auto by_camera = PixelByParameters(*camera, point_C);
        if (!by_camera) return false;
        Rows(jacobians[0], num_parameters_).middleRows<2>(row) = *by_camera;
      }
      if (jacobians[1] != nullptr) {
        Eigen::Matrix<double, 3, 6> by_pose;
        by_pose << -X_CB.linear() * Cross(point_B) * J,
            Eigen::Matrix3d::Identity();
        Rows(jacobians[1], 6).middleRows<2>(row) = seen->d_point * by_pose;
      }
    }
    return true;
  }

 private:
  using RowMajor =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor> Rows(double* jacobian, Eigen::Index columns) const {
    return {jacobian, num_residuals(), columns};
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
  for (int i = stage == CalibrationStage::kPoses ? 0 : 2; i < size; ++i) {
    const bool is_xi = is_sphere && i == 4;
    const bool is_kept =
        stage != CalibrationStage::kAll ||
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
  if (constant.size() == static_cast<std::size_t>(state->values.size())) {
    result->SetParameterBlockConstant(state->values.data());
  } else if (!constant.empty()) {
    result->SetManifold(state->values.data(),
                        new ceres::SubsetManifold(
                            static_cast<int>(state->values.size()), constant));
  }
  return result;
}

std::vector<std::vector<double>> CornerDistances(
    const CalibrationProblem& problem, const CalibrationState& state) {
  const auto camera = problem.CameraOf(state.values);
  std::vector<std::vector<double>> distances;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    const BoardView& view = problem.views[v];
    const Eigen::Isometry3d X_CB = PoseFromBlock(state.poses[v]);
    std::vector<double>& list = distances.emplace_back();
    for (std::size_t i = 0; i < view.pixels.size(); ++i) {
      const auto seen = PixelFromRay(*camera, X_CB * OnBoard(view.points_B[i]));
      list.push_back(seen ? (seen->pixel - view.pixels[i]).norm()
                          : std::numeric_limits<double>::infinity());
    }
  }
  return distances;
}

bool Solve(const CalibrationProblem& problem,
           CalibrationStage stage,
           double least_gain,
           CalibrationState* state) {
  const auto built = BuildProblem(problem, stage, state);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.num_threads = 1;
  options.max_num_iterations = 200;
  options.function_tolerance = least_gain;
  options.parameter_tolerance = kFineGain;
  options.gradient_tolerance = kFineGain;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, built.get(), &summary);
  state->cost = summary.final_cost;
  return summary.IsSolutionUsable();
}

}  // namespace waymark
