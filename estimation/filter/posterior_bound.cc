#include "estimation/filter/posterior_bound.h"

#include "estimation/filter/fix_model.h"

#include <Eigen/LU>

namespace waymark {

PosteriorBound::PosteriorBound(const WheelParameters& parameters,
                               const DriveNoise& noise,
                               DriveIntegration integration,
                               const Matrix6& prior)
    : parameters_(parameters),
      noise_(noise),
      integration_(integration),
      P_(prior) {}

void PosteriorBound::Predict(const Pose2& X_WR, const WheelTicks& ticks) {
  const DriveStep step =
      IntegrateTicks(ticks, parameters_, noise_, integration_);
  const ComposeJacobians J = JacobiansOfCompose(X_WR, step.X_R0R1);
  Matrix6 F = Matrix6::Identity();
  F.topLeftCorner<3, 3>() = J.d_AB;
  F.topRightCorner<3, 3>() = J.d_BC * step.d_parameters;
  P_ = (F * P_ * F.transpose()).eval();
  P_.topLeftCorner<3, 3>() += J.d_BC * step.covariance * J.d_BC.transpose();
}

void PosteriorBound::Update(const Pose2& X_WR, const AbsoluteFix& fix) {
  const FixPrediction at = PredictFix(fix, X_WR);
  if (at.residual.size() == 0) return;
  Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 3, 6> H(at.d_pose.rows(), 6);
  H.leftCols<3>() = at.d_pose;
  H.rightCols<3>().setZero();
  const FixMatrix S = H * P_ * H.transpose() + at.covariance;
  const Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 3> K =
      P_ * H.transpose() * S.inverse();
  P_ = ((Matrix6::Identity() - K * H) * P_).eval();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
}

double RatioVariance(const WheelParameters& parameters,
                     const Eigen::Matrix3d& covariance) {
  const double r = parameters.k_right;
  const double l = parameters.k_left;
  const Eigen::RowVector3d J(1.0 / l, -r / (l * l), 0.0);
  return J * covariance * J.transpose();
}

}  // namespace waymark
