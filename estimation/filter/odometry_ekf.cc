#include "estimation/filter/odometry_ekf.h"

#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <utility>

namespace waymark {
namespace {

using Matrix6 = OdometryEkf::Matrix6;

template <int N>
std::string FaultOf(const Eigen::Matrix<double, N, N>& P) {
  if (!P.allFinite()) return "covariance not finite";
  // What rounding leaves where a position known to 100 m is measured to 1 mm:
  // the variances differ by 1e10, a double has 16 digits.
  constexpr double kTolerance = 1e-6;
  Eigen::Matrix<double, N, 1> scale(P.rows());
  for (Eigen::Index i = 0; i < P.rows(); ++i) {
    if (P(i, i) < 0.0) return "negative variance";
    scale(i) = P(i, i) > 0.0 ? 1.0 / std::sqrt(P(i, i)) : 0.0;
    if (P(i, i) == 0.0 && !P.row(i).isZero(0.0)) {
      return "covariance not positive";
    }
  }
  using Matrix = Eigen::Matrix<double, N, N>;
  const Matrix C = scale.asDiagonal() * P * scale.asDiagonal();
  if ((C - C.transpose()).cwiseAbs().maxCoeff() > kTolerance) {
    return "covariance not symmetric";
  }
  // Cholesky of the shifted matrix succeeds just where no eigenvalue is below
  // -kTolerance, at a tenth of the cost of the eigenvalues.
  const Eigen::LLT<Matrix> llt(C + kTolerance *
                                       Matrix::Identity(P.rows(), P.cols()));
  if (llt.info() != Eigen::Success) return "covariance not positive";
  return "";
}

Pose2 Moved(const Pose2& X, const Eigen::Vector3d& d) {
  return {X.x + d(0), X.y + d(1), WrapAngle(X.heading + d(2))};
}

Matrix6 BlockJacobian(const Eigen::Matrix3d& parameters) {
  Matrix6 J = Matrix6::Identity();
  J.bottomRightCorner<3, 3>() = parameters;
  return J;
}

}  // namespace

std::string CovarianceFault(const Matrix6& P) {
  return FaultOf(P);
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
  if (!extras_.empty() && fault_.empty()) cross_ = (F * cross_).eval();
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
  if (!extras_.empty()) {
    JointMatrix H = JointMatrix::Zero(v.H.rows(), 6 + cross_.cols());
    H.leftCols<6>() = v.H;
    UpdateJoint(v, H, JointCovariance());
    return;
  }
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

void OdometryEkf::AddExtra(const Extra& extra,
                           const Eigen::Matrix<double, 6, 3>& with_state,
                           const Eigen::MatrixXd& with_others,
                           const Eigen::Matrix3d& covariance) {
  const Eigen::Index n = with_others.cols();
  cross_.conservativeResize(6, n + 3);
  cross_.rightCols<3>() = with_state;
  among_.conservativeResize(n + 3, n + 3);
  among_.bottomLeftCorner(3, n) = with_others;
  among_.topRightCorner(n, 3) = with_others.transpose();
  among_.bottomRightCorner<3, 3>() = covariance;
  extras_.push_back(extra);
}

void OdometryEkf::KeepExtras(const std::function<bool(const Extra&)>& is_kept) {
  std::vector<Extra> kept;
  std::vector<Eigen::Index> columns;
  for (const Extra& extra : extras_) {
    if (!is_kept(extra)) continue;
    for (Eigen::Index k = 0; k < 3; ++k) {
      columns.push_back(ColumnOf(&extra) + k);
    }
    kept.push_back(extra);
  }
  if (kept.size() == extras_.size()) return;
  extras_ = std::move(kept);
  cross_ = Eigen::MatrixXd(cross_(Eigen::all, columns));
  among_ = Eigen::MatrixXd(among_(columns, columns));
}

void OdometryEkf::AddClone(Time now, Time until) {
  if (!fault_.empty()) return;
  for (Extra& extra : extras_) {
    if (!extra.is_clone || extra.time != now) continue;
    extra.until = std::max(extra.until, until);
    return;
  }
  Extra clone;
  clone.is_clone = true;
  clone.time = now;
  clone.until = until;
  clone.value = X_WR_.vector();
  const Eigen::Index n = cross_.cols();
  AddExtra(clone,
           P_.leftCols<3>(),
           n > 0 ? Eigen::MatrixXd(cross_.topRows<3>()) : Eigen::MatrixXd(3, 0),
           P_.topLeftCorner<3, 3>());
}

void OdometryEkf::DropClones(Time now) {
  KeepExtras([now](const Extra& extra) {
    return !extra.is_clone || extra.until >= now;
  });
}

void OdometryEkf::AddMounting(const std::string& source) {
  if (!fault_.empty() || HasMounting(source)) return;
  Extra mounting;
  mounting.source = source;
  const double position = std::pow(options_.mounting_position_sigma, 2);
  const double yaw = std::pow(options_.mounting_yaw_sigma, 2);
  AddExtra(mounting,
           Eigen::Matrix<double, 6, 3>::Zero(),
           Eigen::MatrixXd::Zero(3, cross_.cols()),
           Eigen::Vector3d(position, position, yaw).asDiagonal());
}

const OdometryEkf::Extra* OdometryEkf::FindClone(Time time) const {
  for (const Extra& extra : extras_) {
    if (extra.is_clone && extra.time == time) return &extra;
  }
  return nullptr;
}

const OdometryEkf::Extra* OdometryEkf::FindMounting(
    const std::string& source) const {
  for (const Extra& extra : extras_) {
    if (!extra.is_clone && extra.source == source) return &extra;
  }
  return nullptr;
}

// In cross_ and among_.
Eigen::Index OdometryEkf::ColumnOf(const Extra* extra) const {
  return 3 * (extra - extras_.data());
}

bool OdometryEkf::HasClone(Time time) const {
  return FindClone(time) != nullptr;
}

bool OdometryEkf::HasMounting(const std::string& source) const {
  return FindMounting(source) != nullptr;
}

int OdometryEkf::num_clones() const {
  return static_cast<int>(
      std::count_if(extras_.begin(), extras_.end(), [](const Extra& extra) {
        return extra.is_clone;
      }));
}

int OdometryEkf::num_mountings() const {
  return static_cast<int>(extras_.size()) - num_clones();
}

Eigen::Vector3d OdometryEkf::mounting_error(const std::string& source) const {
  const Extra* mounting = FindMounting(source);
  WAYMARK_CHECK(mounting != nullptr, source);
  return mounting->value;
}

OdometryEkf::JointMatrix OdometryEkf::JointCovariance() const {
  const Eigen::Index n = cross_.cols();
  JointMatrix P(6 + n, 6 + n);
  P.topLeftCorner<6, 6>() = P_;
  P.topRightCorner(6, n) = cross_;
  P.bottomLeftCorner(n, 6) = cross_.transpose();
  P.bottomRightCorner(n, n) = among_;
  return P;
}

Innovation OdometryEkf::InnovateJoint(const RelativeMotion& motion,
                                      const JointMatrix& P,
                                      JointMatrix* H) const {
  const Extra* clone = FindClone(motion.from);
  WAYMARK_CHECK(clone != nullptr, Microseconds(motion.from), extras_.size());
  const Extra* mounting = FindMounting(motion.source);
  RelativeMotion mounted = motion;
  if (mounting != nullptr) {
    mounted.X_RS = Moved(motion.X_RS, mounting->value);
  }
  const MotionPrediction prediction =
      PredictMotion(mounted, Pose2::FromVector(clone->value), X_WR_);
  H->setZero(3, P.cols());
  H->leftCols<3>() = prediction.d_to;
  H->middleCols<3>(6 + ColumnOf(clone)) = prediction.d_from;
  if (mounting != nullptr) {
    H->middleCols<3>(6 + ColumnOf(mounting)) = prediction.d_mounting;
  }
  Innovation innovation;
  innovation.residual = prediction.residual;
  innovation.R = motion.covariance;
  innovation.HPH = *H * P * H->transpose();
  return innovation;
}

Innovation OdometryEkf::Innovate(const RelativeMotion& motion) const {
  JointMatrix H;
  return InnovateJoint(motion, JointCovariance(), &H);
}

void OdometryEkf::Update(const RelativeMotion& motion) {
  if (!fault_.empty()) return;
  const JointMatrix P = JointCovariance();
  JointMatrix H;
  const Innovation v = InnovateJoint(motion, P, &H);
  UpdateJoint(v, H, P);
}

void OdometryEkf::UpdateJoint(const Innovation& v,
                              const JointMatrix& H,
                              const JointMatrix& P) {
  const FixMatrix S = v.HPH + v.R;
  const Eigen::LLT<FixMatrix> llt(S);
  if (!S.allFinite() || llt.info() != Eigen::Success) {
    fault_ = "filter stopped: update: innovation covariance not positive";
    return;
  }
  const JointMatrix HP = H * P;
  JointMatrix K = llt.solve(HP).transpose();
  if (!options_.estimate_parameters) K.middleRows<3>(3).setZero();
  const Eigen::VectorXd d = K * v.residual;
  // Joseph's A P A' + K R K', A = I - K H, from the left to the right: three
  // columns at a time instead of whole matrices.
  const JointMatrix AP = P - K * HP;
  const JointMatrix updated =
      AP + (K * v.R - AP * H.transpose()) * K.transpose();
  const JointMatrix joint = 0.5 * (updated + updated.transpose());
  if (const std::string why = FaultOf(joint); !why.empty()) {
    fault_ = "filter stopped: update: " + why;
    return;
  }
  Accept(Moved(X_WR_, d.head<3>()),
         q_ + d.segment<3>(3),
         joint.topLeftCorner<6, 6>(),
         "update");
  if (!fault_.empty()) return;
  cross_ = joint.topRightCorner(6, cross_.cols());
  among_ = joint.bottomRightCorner(among_.rows(), among_.cols());
  for (Extra& extra : extras_) {
    const Eigen::Vector3d step = d.segment<3>(6 + ColumnOf(&extra));
    extra.value = Moved(Pose2::FromVector(extra.value), step).vector();
  }
}

void OdometryEkf::WidenParameters(double factor, double max_share) {
  if (!fault_.empty()) return;
  const Eigen::Vector3d variances = parameter_covariance().diagonal();
  const Eigen::Vector3d values = parameters().vector();
  for (int i = 0; i < 3; ++i) {
    if (variances(i) <= 0.0) continue;
    factor = std::min(factor, max_share * values(i) / std::sqrt(variances(i)));
  }
  if (factor <= 1.0) return;
  P_.bottomRows<3>() *= factor;
  P_.rightCols<3>() *= factor;
  if (!extras_.empty()) cross_.bottomRows<3>() *= factor;
}

void OdometryEkf::SetPose(const Pose2& X_WR,
                          const Eigen::Matrix3d& covariance) {
  Matrix6 P = Matrix6::Zero();
  P.topLeftCorner<3, 3>() = covariance;
  P.bottomRightCorner<3, 3>() = P_.bottomRightCorner<3, 3>();
  KeepExtras([](const Extra& extra) { return !extra.is_clone; });
  if (!extras_.empty()) cross_.topRows<3>().setZero();
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
  if (!extras_.empty()) cross_.bottomRows<3>().setZero();
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
