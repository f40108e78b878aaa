// Residuals of the batch problem, with analytic Jacobians. All are whitened:
// unit variance under the stated noise.
//
// Parameter blocks: pose (x m, y m, heading rad) of the robot in the world at
// a keyframe, heading not wrapped; wheels (k_right, k_left, B) as multiples of
// their initial values; sensor (x m, y m, yaw rad, time offset s).
#pragma once

#include "estimation/batch/batch_types.h"
#include "estimation/batch/tick_track.h"

#include <Eigen/Core>
#include <ceres/cost_function.h>
#include <ceres/sized_cost_function.h>

namespace waymark {

// What a step between two keyframes needs beyond its times.
struct StepModel {
  const TickTrack* track = nullptr;  // Outlives the cost.
  WheelParameters initial;
  DriveIntegration integration = DriveIntegration::kArc;
};

// Blocks: pose at t0, pose at t1, wheels. Three residuals: the motion between
// the poses minus that of the ticks, which are integrated anew for each
// evaluation. `covariance` is that of the motion, positive definite.
class StepCost final : public ceres::SizedCostFunction<3, 3, 3, 3> {
 public:
  StepCost(const StepModel& model,
           double t0,
           double t1,
           const Eigen::Matrix3d& covariance);
  // False (a step that Ceres takes back) where the wheel base is not positive.
  bool Evaluate(double const* const* blocks,
                double* residuals,
                double** jacobians) const override;

 private:
  StepModel model_;
  double t0_;
  double t1_;
  Eigen::Matrix3d whiten_;
};

// From a keyframe K to the robot at a measurement's time.
struct TieShift {
  Pose2 X_KR;
  Eigen::Vector3d d_time = Eigen::Vector3d::Zero();  // By that time.
};

// Ties a measurement to a keyframe: the robot at the measurement's time is
// where the ticks lead from the keyframe, at wheel parameters that are held.
struct KeyframeTie {
  const TickTrack* track = nullptr;  // Outlives the cost.
  WheelParameters parameters;
  DriveIntegration integration = DriveIntegration::kArc;
  double keyframe_time = 0.0;  // On the encoders' clock, s of the track.
  double sensor_time = 0.0;    // On the sensor's clock, s of the track.
  // Filled by MakeTie: the shift at the time offset that will be asked most.
  double offset = 0.0;
  TieShift shift;
};
[[nodiscard]] KeyframeTie MakeTie(KeyframeTie tie, double offset);

// Blocks: pose, sensor. One residual per present component of the fix.
class FixCost final : public ceres::CostFunction {
 public:
  FixCost(const KeyframeTie& tie, const AbsoluteFix& fix);
  bool Evaluate(double const* const* blocks,
                double* residuals,
                double** jacobians) const override;

 private:
  KeyframeTie tie_;
  Pose2 X_WF_;
  Eigen::Vector3d value_;
  // The first N rows pick the present components and whiten them.
  Eigen::Matrix3d whiten_ = Eigen::Matrix3d::Zero();
};

// Blocks: pose at S0, pose at S1, sensor. Three residuals.
class MotionCost final : public ceres::SizedCostFunction<3, 3, 3, 4> {
 public:
  MotionCost(const KeyframeTie& from,
             const KeyframeTie& to,
             const RelativeMotion& motion);
  bool Evaluate(double const* const* blocks,
                double* residuals,
                double** jacobians) const override;

 private:
  KeyframeTie from_;
  KeyframeTie to_;
  Pose2 X_S0S1_;
  Eigen::Matrix3d whiten_;
};

// One block of `size` parameters, normal about `mean` with covariance
// `covariance`. Component `wrapped` (if not negative) is an angle.
class PriorCost final : public ceres::CostFunction {
 public:
  PriorCost(const Eigen::VectorXd& mean,
            const Eigen::MatrixXd& covariance,
            int wrapped);
  bool Evaluate(double const* const* blocks,
                double* residuals,
                double** jacobians) const override;

 private:
  Eigen::VectorXd mean_;
  Eigen::MatrixXd whiten_;
  int wrapped_;
};

}  // namespace waymark
