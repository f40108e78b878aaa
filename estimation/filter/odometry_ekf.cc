#include "estimation/filter/odometry_ekf.h"

#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

using Matrix6 = OdometryEkf::Matrix6;

Matrix6 BlockJacobian(const Eigen::Matrix3d& parameters) {
  Matrix6 J = Matrix6::Identity();
  J.bottomRightCorner<3, 3>() = parameters;
  return J;
}

}  // namespace

std::string CovarianceFault(const Matrix6& P) {
  if (!P.allFinite()) return "covariance not finite";
  // What rounding leaves where a position known to 100 m is measured to 1 mm:
  // the variances differ by 1e10, a double has 16 digits.
  constexpr double kTolerance = 1e-6;
  OdometryEkf::Vector6 scale;
  for (int i = 0; i < 6; ++i) {
    if (P(i, i) < 0.0) return "negative variance";
    scale(i) = P(i, i) > 0.0 ? 1.0 / std::sqrt(P(i, i)) : 0.0;
    if (P(i, i) == 0.0 && !P.row(i).isZero(0.0)) {
      return "covariance not positive";
    }
  }
  const Matrix6 C = scale.asDiagonal() * P * scale.asDiagonal();
  if ((C - C.transpose()).cwiseAbs().maxCoeff() > kTolerance) {
    return "covariance not symmetric";
  }
  // Cholesky of the shifted matrix succeeds just where no eigenvalue is below
  // -kTolerance, at a tenth of the cost of the eigenvalues.
  const Eigen::LLT<Matrix6> llt(C + kTolerance * Matrix6::Identity());
  if (llt.info() != Eigen::Success) return "covariance not positive";
  return "";
}

OdometryEkf::OdometryEkf(const OdometryEkfOptions& options,
                         const Pose2& X_WR,
                         const Eigen::Matrix3d& pose_covariance,
                         const WheelParameters& parameters,
                         const Eigen::Matrix3d& parameter_covariance)
    : options_(options), X_WR_(X_WR) {
  P_.topLeftCorner<3, 3>() = pose_covariance;
  SetParameters(parameters, parameter_covariance);
}

OdometryEkf::OdometryEkf(const OdometryEkfOptions& options,
                         const Pose2& X_WR,
                         const WheelParameters& parameters,
                         const Matrix6& covariance)
    : options_(options),
      X_WR_(X_WR),
      q_(FormFromParameters(parameters, options.form)),
      prior_variances_(covariance.diagonal().tail<3>()) {
  const Matrix6 J = BlockJacobian(FormByParameters(q_, options_.form));
  const Matrix6 P = J * covariance * J.transpose();
  Accept(X_WR, q_, 0.5 * (P + P.transpose()), "start");
}

void OdometryEkf::Accept(const Pose2& X_WR,
                         const Eigen::Vector3d& q,
                         const Matrix6& P,
                         const char* step) {
  std::string why;
  if (!X_WR.vector().allFinite() || !q.allFinite()) {
    why = "state not finite";
  } else if (!(q.minCoeff() > 0.0)) {
    why = "wheel parameters not positive";
  } else {
    why = CovarianceFault(P);
  }
  if (!why.empty()) {
    fault_ = std::string("filter stopped: ") + step + ": " + why;
    return;
  }
  X_WR_ = X_WR;
  q_ = q;
  P_ = P;
}

void OdometryEkf::Predict(const WheelTicks& ticks, double seconds) {
  if (!fault_.empty()) return;
  if (!std::isfinite(ticks.right) || !std::isfinite(ticks.left) ||
      !(seconds >= 0.0)) {
    fault_ = "filter stopped: prediction: ticks or time not finite";
    return;
  }
  const WheelParameters p = parameters();
  const DriveStep step =
      IntegrateTicks(ticks, p, options_.noise, options_.integration);
  const ComposeJacobians J = JacobiansOfCompose(X_WR_, step.X_R0R1);
  Matrix6 F = Matrix6::Identity();
  F.topLeftCorner<3, 3>() = J.d_AB;
  F.topRightCorner<3, 3>() =
      J.d_BC * step.d_parameters * ParametersByForm(q_, options_.form);
  Matrix6 P = F * P_ * F.transpose();
  P.topLeftCorner<3, 3>() += J.d_BC * step.covariance * J.d_BC.transpose();
  const double metres = 0.5 * (std::abs(p.k_right * ticks.right) +
                               std::abs(p.k_left * ticks.left));
  const Eigen::Vector3d walk =
      (options_.walk.per_sqrt_metre.cwiseAbs2() * metres +
       options_.walk.per_sqrt_second.cwiseAbs2() * seconds)
          .cwiseProduct(p.vector().cwiseAbs2());
  if (!walk.isZero(0.0)) {
    const Eigen::Matrix3d D = FormByParameters(q_, options_.form);
    P.bottomRightCorner<3, 3>() += D * walk.asDiagonal() * D.transpose();
    prior_variances_ += walk;
  }
  Accept(X_WR_ * step.X_R0R1, q_, 0.5 * (P + P.transpose()), "prediction");
}

void OdometryEkf::AddPoseNoise(const Eigen::Matrix3d& covariance) {
  if (!fault_.empty()) return;
  Matrix6 P = P_;
  P.topLeftCorner<3, 3>() += covariance;
  Accept(X_WR_, q_, P, "unmeasured motion");
}

Innovation OdometryEkf::Innovate(const AbsoluteFix& fix) const {
  const FixPrediction prediction = PredictFix(fix, X_WR_);
  Innovation innovation;
  innovation.residual = prediction.residual;
  innovation.H.setZero(prediction.residual.size(), 6);
  innovation.H.leftCols<3>() = prediction.d_pose;
  innovation.R = prediction.covariance;
  innovation.HPH = innovation.H * P_ * innovation.H.transpose();
  return innovation;
}

void OdometryEkf::Update(const AbsoluteFix& fix) {
  if (!fault_.empty()) return;
  const Innovation v = Innovate(fix);
  const FixMatrix S = v.HPH + v.R;
  const Eigen::LLT<FixMatrix> llt(S);
  if (!S.allFinite() || llt.info() != Eigen::Success) {
    fault_ = "filter stopped: update: innovation covariance not positive";
    return;
  }
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 3> K =
      llt.solve(v.H * P_).transpose();
  if (!options_.estimate_parameters) K.bottomRows<3>().setZero();
  const Vector6 d = K * v.residual;
  const Matrix6 A = Matrix6::Identity() - K * v.H;
  const Matrix6 P = A * P_ * A.transpose() + K * v.R * K.transpose();
  const Pose2 X_WR{
      X_WR_.x + d(0), X_WR_.y + d(1), WrapAngle(X_WR_.heading + d(2))};
  Accept(X_WR, q_ + d.tail<3>(), 0.5 * (P + P.transpose()), "update");
}

void OdometryEkf::SetPose(const Pose2& X_WR,
                          const Eigen::Matrix3d& covariance) {
  Matrix6 P = Matrix6::Zero();
  P.topLeftCorner<3, 3>() = covariance;
  P.bottomRightCorner<3, 3>() = P_.bottomRightCorner<3, 3>();
  fault_.clear();
  Accept(X_WR, q_, P, "start");
}

void OdometryEkf::SetParameters(const WheelParameters& parameters,
                                const Eigen::Matrix3d& covariance) {
  if (!fault_.empty()) return;
  const Eigen::Vector3d q = FormFromParameters(parameters, options_.form);
  const Eigen::Matrix3d D = FormByParameters(q, options_.form);
  Matrix6 P = Matrix6::Zero();
  P.topLeftCorner<3, 3>() = P_.topLeftCorner<3, 3>();
  const Eigen::Matrix3d C = D * covariance * D.transpose();
  P.bottomRightCorner<3, 3>() = 0.5 * (C + C.transpose());
  prior_variances_ = covariance.diagonal();
  q_ = q;
  Accept(X_WR_, q, P, "parameters");
}

Eigen::Matrix3d OdometryEkf::parameter_covariance() const {
  return covariance().bottomRightCorner<3, 3>();
}

OdometryEkf::Matrix6 OdometryEkf::covariance() const {
  const Matrix6 J = BlockJacobian(ParametersByForm(q_, options_.form));
  const Matrix6 P = J * P_ * J.transpose();
  return 0.5 * (P + P.transpose());
}

Eigen::Vector3d OdometryEkf::observability() const {
  const Eigen::Vector3d variances = parameter_covariance().diagonal();
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (prior_variances_(i) <= 0.0) continue;
    result(i) = std::clamp(1.0 - variances(i) / prior_variances_(i), 0.0, 1.0);
  }
  return result;
}

}  // namespace waymark
