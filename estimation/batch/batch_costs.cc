#include "estimation/batch/batch_costs.h"

#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace waymark {
namespace {

using RowMajorX =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Ceres stores Jacobians row by row.
template <int Rows, int Cols>
Eigen::Map<Eigen::Matrix<double, Rows, Cols, Eigen::RowMajor>> MapOf(
    double* jacobian) {
  return Eigen::Map<Eigen::Matrix<double, Rows, Cols, Eigen::RowMajor>>(
      jacobian);
}

// L^-1 of covariance = L L'.
Eigen::MatrixXd WhitenerOf(const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
  WAYMARK_CHECK(llt.info() == Eigen::Success, covariance);
  return llt.matrixL().solve(
      Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
}

// Headings of blocks are not wrapped, those of Pose2 are.
Pose2 PoseOf(const double* block) {
  return {block[0], block[1], WrapAngle(block[2])};
}

TieShift ShiftOf(const KeyframeTie& tie, double offset) {
  const double time = tie.sensor_time - offset;
  TieShift shift;
  shift.X_KR = tie.track
                   ->Integrate(tie.keyframe_time,
                               time,
                               tie.parameters,
                               DriveNoise{0.0, 0.0},
                               tie.integration)
                   .X_R0R1;
  const TrackVelocity velocity = tie.track->VelocityAt(time, tie.parameters);
  // The robot's heading is its direction of travel.
  shift.d_time << velocity.forward * std::cos(shift.X_KR.heading),
      velocity.forward * std::sin(shift.X_KR.heading), velocity.turn_rate;
  return shift;
}

// Where the sensor is when it measures.
struct SensorPose {
  Pose2 X_WS;
  Eigen::Matrix3d d_pose;
  Eigen::Matrix<double, 3, 4> d_sensor;
};

SensorPose SensorPoseOf(const double* pose,
                        const double* sensor,
                        const KeyframeTie& tie) {
  const Pose2 X_WR = PoseOf(pose);
  const Pose2 X_RS = PoseOf(sensor);
  const TieShift shift =
      tie.offset == sensor[3] ? tie.shift : ShiftOf(tie, sensor[3]);
  const Pose2 X_WT = X_WR * shift.X_KR;  // The robot when S measures.
  const ComposeJacobians to_robot = JacobiansOfCompose(X_WR, shift.X_KR);
  const ComposeJacobians to_sensor = JacobiansOfCompose(X_WT, X_RS);
  SensorPose result;
  result.X_WS = X_WT * X_RS;
  result.d_pose = to_sensor.d_AB * to_robot.d_AB;
  result.d_sensor.leftCols<3>() = to_sensor.d_BC;
  result.d_sensor.col(3) = -(to_sensor.d_AB * to_robot.d_BC * shift.d_time);
  return result;
}

// (x, y, heading) of a minus b, heading wrapped.
Eigen::Vector3d Difference(const Pose2& a, const Eigen::Vector3d& b) {
  return {a.x - b.x(), a.y - b.y(), WrapAngle(a.heading - b.z())};
}

}  // namespace

KeyframeTie MakeTie(KeyframeTie tie, double offset) {
  tie.offset = offset;
  tie.shift = ShiftOf(tie, offset);
  return tie;
}

StepCost::StepCost(const StepModel& model,
                   double t0,
                   double t1,
                   const Eigen::Matrix3d& covariance)
    : model_(model), t0_(t0), t1_(t1), whiten_(WhitenerOf(covariance)) {}

bool StepCost::Evaluate(double const* const* blocks,
                        double* residuals,
                        double** jacobians) const {
  const Eigen::Map<const Eigen::Vector3d> scale(blocks[2]);
  const Eigen::Vector3d wheels = scale.cwiseProduct(model_.initial.vector());
  if (!(wheels(2) > 0.0) || !wheels.allFinite()) return false;
  const TrackMotion ticks =
      model_.track->Integrate(t0_,
                              t1_,
                              WheelParameters::FromVector(wheels),
                              DriveNoise{0.0, 0.0},
                              model_.integration);
  const Pose2 X_WR0 = PoseOf(blocks[0]);
  const Pose2 X_WR1 = PoseOf(blocks[1]);
  Eigen::Map<Eigen::Vector3d> r(residuals);
  r = whiten_ * Difference(Between(X_WR0, X_WR1), ticks.X_R0R1.vector());
  if (jacobians == nullptr) return true;
  const BetweenJacobians between = JacobiansOfBetween(X_WR0, X_WR1);
  if (jacobians[0] != nullptr) {
    MapOf<3, 3>(jacobians[0]) = whiten_ * between.d_AB;
  }
  if (jacobians[1] != nullptr) {
    MapOf<3, 3>(jacobians[1]) = whiten_ * between.d_AC;
  }
  if (jacobians[2] != nullptr) {
    MapOf<3, 3>(jacobians[2]) =
        -whiten_ * ticks.d_parameters * model_.initial.vector().asDiagonal();
  }
  return true;
}

FixCost::FixCost(const KeyframeTie& tie, const AbsoluteFix& fix)
    : tie_(tie), X_WF_(fix.X_WF), value_(fix.value) {
  std::vector<int> present;
  for (int i = 0; i < 3; ++i) {
    if (fix.has[static_cast<std::size_t>(i)]) {
      present.push_back(i);
    } else {
      value_(i) = 0.0;  // May be anything, NaN too.
    }
  }
  WAYMARK_CHECK(!present.empty());
  const Eigen::MatrixXd whiten = WhitenerOf(fix.covariance(present, present));
  for (std::size_t i = 0; i < present.size(); ++i) {
    whiten_.col(present[i]).head(whiten.rows()) =
        whiten.col(static_cast<Eigen::Index>(i));
  }
  set_num_residuals(static_cast<int>(present.size()));
  *mutable_parameter_block_sizes() = {3, 4};
}

bool FixCost::Evaluate(double const* const* blocks,
                       double* residuals,
                       double** jacobians) const {
  const SensorPose sensor = SensorPoseOf(blocks[0], blocks[1], tie_);
  const int rows = num_residuals();
  const Eigen::Vector3d r =
      whiten_ * Difference(Between(X_WF_, sensor.X_WS), value_);
  std::copy_n(r.data(), rows, residuals);
  if (jacobians == nullptr) return true;
  const Eigen::Matrix3d d_S =
      whiten_ * JacobiansOfBetween(X_WF_, sensor.X_WS).d_AC;
  if (jacobians[0] != nullptr) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> d_pose =
        d_S * sensor.d_pose;
    std::copy_n(d_pose.data(), 3 * rows, jacobians[0]);
  }
  if (jacobians[1] != nullptr) {
    const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> d_sensor =
        d_S * sensor.d_sensor;
    std::copy_n(d_sensor.data(), 4 * rows, jacobians[1]);
  }
  return true;
}

MotionCost::MotionCost(const KeyframeTie& from,
                       const KeyframeTie& to,
                       const RelativeMotion& motion)
    : from_(from),
      to_(to),
      X_S0S1_(motion.X_S0S1),
      whiten_(WhitenerOf(motion.covariance)) {}

bool MotionCost::Evaluate(double const* const* blocks,
                          double* residuals,
                          double** jacobians) const {
  const SensorPose from = SensorPoseOf(blocks[0], blocks[2], from_);
  const SensorPose to = SensorPoseOf(blocks[1], blocks[2], to_);
  Eigen::Map<Eigen::Vector3d> r(residuals);
  r = whiten_ * Difference(Between(from.X_WS, to.X_WS), X_S0S1_.vector());
  if (jacobians == nullptr) return true;
  const BetweenJacobians between = JacobiansOfBetween(from.X_WS, to.X_WS);
  const Eigen::Matrix3d d_from = whiten_ * between.d_AB;
  const Eigen::Matrix3d d_to = whiten_ * between.d_AC;
  if (jacobians[0] != nullptr) {
    MapOf<3, 3>(jacobians[0]) = d_from * from.d_pose;
  }
  if (jacobians[1] != nullptr) {
    MapOf<3, 3>(jacobians[1]) = d_to * to.d_pose;
  }
  if (jacobians[2] != nullptr) {
    MapOf<3, 4>(jacobians[2]) = d_from * from.d_sensor + d_to * to.d_sensor;
  }
  return true;
}

PriorCost::PriorCost(const Eigen::VectorXd& mean,
                     const Eigen::MatrixXd& covariance,
                     int wrapped)
    : mean_(mean), whiten_(WhitenerOf(covariance)), wrapped_(wrapped) {
  set_num_residuals(static_cast<int>(mean.size()));
  *mutable_parameter_block_sizes() = {static_cast<int>(mean.size())};
}

bool PriorCost::Evaluate(double const* const* blocks,
                         double* residuals,
                         double** jacobians) const {
  const Eigen::Index size = mean_.size();
  Eigen::VectorXd error =
      Eigen::Map<const Eigen::VectorXd>(blocks[0], size) - mean_;
  if (wrapped_ >= 0) error(wrapped_) = WrapAngle(error(wrapped_));
  Eigen::Map<Eigen::VectorXd>(residuals, size) = whiten_ * error;
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    Eigen::Map<RowMajorX>(jacobians[0], size, size) = whiten_;
  }
  return true;
}

}  // namespace waymark
