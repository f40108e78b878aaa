// The least-squares problem behind calibrate_camera.h.
#pragma once

#include "estimation/camera/calibrate_camera.h"

#include <ceres/problem.h>

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace waymark {

// What is known. Outlives what is built from it.
struct CalibrationProblem {
  CalibrationOptions options;
  std::span<const BoardView> views;
  std::vector<std::vector<char>> is_used;  // Per view and corner.

  // Nullopt where no camera has these numbers, or a focal length changed its
  // sign, which would be another image.
  [[nodiscard]] std::optional<CameraModel> CameraOf(
      const Eigen::VectorXd& values) const;
};

// What is estimated.
struct CalibrationState {
  using Pose = Eigen::Matrix<double, 6, 1>;  // Rotation vector, translation.
  Eigen::VectorXd values;                    // Of ParameterNames(kind).
  std::vector<Pose> poses;                   // X_CB of each view.
  double cost = std::numeric_limits<double>::infinity();
};

[[nodiscard]] CalibrationState::Pose BlockFromPose(
    const Eigen::Isometry3d& X_CB);
[[nodiscard]] Eigen::Isometry3d PoseFromBlock(
    const CalibrationState::Pose& block);
[[nodiscard]] Eigen::Vector3d OnBoard(const Eigen::Vector2d& point_B);

// Always with the poses.
enum class CalibrationStage { kPoses, kFocalLengths, kAll };

// Indices of the camera's numbers that stay as they are.
[[nodiscard]] std::vector<int> ConstantParameters(
    const CalibrationOptions& options, CalibrationStage stage);

// Residuals: all used corners, pixels that the model gives minus those seen.
[[nodiscard]] std::unique_ptr<ceres::Problem> BuildProblem(
    const CalibrationProblem& problem,
    CalibrationStage stage,
    CalibrationState* state);

// Distances of all corners from where the state has them, used or not, px;
// infinite where the camera does not see them.
[[nodiscard]] std::vector<std::vector<double>> CornerDistances(
    const CalibrationProblem& problem, const CalibrationState& state);

// Of the cost, below which a step's gain ends the minimisation: to rounding,
// and enough to tell which start leads where.
constexpr double kFineGain = 1e-14;
constexpr double kCoarseGain = 1e-4;

// False where the minimiser found no usable state.
[[nodiscard]] bool Solve(const CalibrationProblem& problem,
                         CalibrationStage stage,
                         double least_gain,
                         CalibrationState* state);

}  // namespace waymark
