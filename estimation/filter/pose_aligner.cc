#include "estimation/filter/pose_aligner.h"

#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace waymark {
namespace {

constexpr ParameterForm kForm = ParameterForm::kTurn;
// Merged steps turn and travel less than this; an arc in place of the true
// path is then off by less than 5 cm * 0.02^2 / 24, under a micrometre.
constexpr double kMaxStepTurn = 0.02;
constexpr double kMaxStepTravel = 0.05;
// chi-square of three degrees exceeds this once in a thousand.
constexpr double kFaulty = 16.3;

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

}  // namespace

// One Kalman pass of the error state (pose now, parameters, first pose) about
// a nominal path.
struct PoseAligner::Pass {
  Pose2 start;        // Nominal.
  Eigen::Vector3d q;  // Nominal.
  Pose2 X_WR;         // Nominal, now.
  Vector9 error = Vector9::Zero();
  Matrix9 P = Matrix9::Zero();
  double cost = 0.0;          // -2 log likelihood of the used fixes.
  double chi_square = 0.0;    // Of the used fixes.
  int num_components = 0;     // Of the used fixes.
  std::vector<double> fault;  // Per fix: chi-square of its innovation.
  std::vector<char> used;

  void Measure(const AbsoluteFix& fix, bool is_used);
  void Move(const std::vector<WheelTicks>& motion,
            const OdometryEkfOptions& model);
};

void PoseAligner::Pass::Measure(const AbsoluteFix& fix, bool is_used) {
  const FixPrediction prediction = PredictFix(fix, X_WR);
  Eigen::Matrix<double, Eigen::Dynamic, 9, 0, 3, 9> H;
  H.setZero(prediction.residual.size(), 9);
  H.leftCols<3>() = prediction.d_pose;
  const FixMatrix S = H * P * H.transpose() + prediction.covariance;
  const Eigen::LLT<FixMatrix> llt(S);
  const FixVector innovation = prediction.residual - H * error;
  const double normalised = innovation.dot(llt.solve(innovation));
  fault.push_back(normalised);
  if (!is_used) return;
  const Eigen::Matrix<double, 9, Eigen::Dynamic, 0, 9, 3> K =
      llt.solve(H * P).transpose();
  const Matrix9 A = Matrix9::Identity() - K * H;
  error += K * innovation;
  P = (A * P * A.transpose() + K * prediction.covariance * K.transpose())
          .eval();
  chi_square += normalised;
  cost += normalised;
  for (Eigen::Index k = 0; k < S.rows(); ++k) {
    cost += 2.0 * std::log(llt.matrixLLT()(k, k));
  }
  num_components += static_cast<int>(S.rows());
}

// The whole leg as one step: its motion, its derivative by q, its covariance.
void PoseAligner::Pass::Move(const std::vector<WheelTicks>& motion,
                             const OdometryEkfOptions& model) {
  const WheelParameters parameters = ParametersFromForm(q, kForm);
  const Eigen::Matrix3d parameters_by_q = ParametersByForm(q, kForm);
  Pose2 X_R0R1;
  Eigen::Matrix3d by_q = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d Q = Eigen::Matrix3d::Zero();
  for (const WheelTicks& ticks : motion) {
    const DriveStep step =
        IntegrateTicks(ticks, parameters, model.noise, model.integration);
    const ComposeJacobians J = JacobiansOfCompose(X_R0R1, step.X_R0R1);
    by_q =
        (J.d_AB * by_q + J.d_BC * step.d_parameters * parameters_by_q).eval();
    Q = (J.d_AB * Q * J.d_AB.transpose() +
         J.d_BC * step.covariance * J.d_BC.transpose())
            .eval();
    X_R0R1 = X_R0R1 * step.X_R0R1;
  }
  const ComposeJacobians J = JacobiansOfCompose(X_WR, X_R0R1);
  Matrix9 F = Matrix9::Identity();
  F.block<3, 3>(0, 0) = J.d_AB;
  F.block<3, 3>(0, 3) = J.d_BC * by_q;
  error = (F * error).eval();
  P = (F * P * F.transpose()).eval();
  P.block<3, 3>(0, 0) += J.d_BC * Q * J.d_BC.transpose();
  X_WR = X_WR * X_R0R1;
}

PoseAligner::PoseAligner(const PoseAlignerOptions& options,
                         const OdometryEkfOptions& model,
                         const WheelParameters& parameters,
                         const Eigen::Matrix3d& parameter_covariance,
                         const Pose2& guess)
    : options_(options),
      model_(model),
      q_(FormFromParameters(parameters, kForm)),
      guess_(guess) {
  const Eigen::Matrix3d J = FormByParameters(q_, kForm);
  q_covariance_ = J * parameter_covariance * J.transpose();
}

void PoseAligner::AddMotion(const WheelTicks& ticks) {
  if (legs_.empty()) return;
  travel_ += 0.5 * q_(2) * (std::abs(ticks.right) + std::abs(ticks.left));
  std::vector<WheelTicks>& motion = legs_.back().motion;
  if (!motion.empty()) {
    const WheelTicks sum{motion.back().right + ticks.right,
                         motion.back().left + ticks.left};
    const double turn = q_(0) * sum.right - q_(1) * sum.left;
    const double travel =
        q_(2) * std::max(std::abs(sum.right), std::abs(sum.left));
    if (std::abs(turn) < kMaxStepTurn && travel < kMaxStepTravel) {
      motion.back() = sum;
      return;
    }
  }
  motion.push_back(ticks);
}

bool PoseAligner::AddFix(const AbsoluteFix& fix) {
  constexpr double kMinTravel = 0.02;
  if (!legs_.empty() && !fix.has[2] && travel_ < kMinTravel) return false;
  travel_ = 0.0;
  if (num_fixes() >= options_.max_fixes) {
    DropFirst();
    std::vector<Leg> kept;
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      if (i % 2 == 0) {
        kept.push_back(std::move(legs_[i]));
      } else {
        kept.back().motion.insert(kept.back().motion.end(),
                                  legs_[i].motion.begin(),
                                  legs_[i].motion.end());
      }
    }
    legs_ = std::move(kept);
  }
  legs_.push_back({fix, {}});
  return true;
}

void PoseAligner::DropFirst() {
  if (!legs_.empty()) legs_.erase(legs_.begin());
}

Pose2 PoseAligner::StartPosition(double heading) const {
  const AbsoluteFix& fix = legs_.front().fix;
  // Where the sensor is in F, as far as measured, the guess for the rest.
  Pose2 X_FS = Between(fix.X_WF, Pose2{guess_.x, guess_.y, heading} * fix.X_RS);
  if (fix.has[0]) X_FS.x = fix.value(0);
  if (fix.has[1]) X_FS.y = fix.value(1);
  const Pose2 X_WS = fix.X_WF * X_FS;
  // The robot, when its heading is `heading`.
  const Pose2 X_WR_turned{0.0, 0.0, heading};
  const Eigen::Vector2d arm = X_WR_turned * fix.X_RS.position();
  return {X_WS.x - arm.x(), X_WS.y - arm.y(), WrapAngle(heading)};
}

std::vector<double> PoseAligner::StartHeadings() const {
  for (const Leg& leg : legs_) {
    // A measured heading at the first fix leaves no choice.
    if (leg.fix.has[2] && &leg == &legs_.front()) {
      return {WrapAngle(leg.fix.value(2) + leg.fix.X_WF.heading -
                        leg.fix.X_RS.heading)};
    }
  }
  constexpr int kHeadings = 12;
  std::vector<double> headings;
  for (int i = 0; i < kHeadings; ++i) {
    headings.push_back(WrapAngle(guess_.heading + 2.0 * kPi * i / kHeadings));
  }
  return headings;
}

PoseAligner::Pass PoseAligner::RunPass(const Pose2& start,
                                       const Eigen::Vector3d& q,
                                       const std::vector<char>& used) const {
  Pass pass;
  pass.start = pass.X_WR = start;
  pass.q = q;
  pass.used = used;
  // The prior's mean is the first position as measured; the heading is free.
  const double position_variance =
      options_.position_sigma * options_.position_sigma;
  const Eigen::Vector3d prior(
      position_variance, position_variance, 4.0 * kPi * kPi);
  for (const int i : {0, 6}) {
    for (const int j : {0, 6}) pass.P.block<3, 3>(i, j) = prior.asDiagonal();
  }
  pass.P.block<3, 3>(3, 3) = q_covariance_;
  const Pose2 mean = StartPosition(start.heading);
  pass.error << mean.x - start.x, mean.y - start.y, 0.0, q_ - q,
      mean.x - start.x, mean.y - start.y, 0.0;

  for (std::size_t i = 0; i < legs_.size(); ++i) {
    pass.Measure(legs_[i].fix, used[i] != 0);
    pass.Move(legs_[i].motion, model_);
  }
  return pass;
}

std::optional<PoseAligner::Pass> PoseAligner::Iterate(double heading) const {
  Pose2 start = StartPosition(heading);
  Eigen::Vector3d q = q_;
  std::vector<char> used(legs_.size(), 1);
  const auto most_faulty = static_cast<std::ptrdiff_t>(legs_.size() / 4);
  // Gauss-Newton converges in 4 to 6; from the wrong side it may wander.
  constexpr int kIterations = 15;
  for (int i = 0; i < kIterations; ++i) {
    Pass pass = RunPass(start, q, used);
    if (!pass.error.allFinite() || !pass.P.allFinite()) return std::nullopt;
    Eigen::Vector3d d_start = pass.error.tail<3>();
    // The wheel parameters are scaled by at most a third, the heading turned
    // by at most a radian per iteration: farther the linear model says little.
    d_start(2) = std::clamp(d_start(2), -1.0, 1.0);
    Eigen::Vector3d d_q = pass.error.segment<3>(3);
    for (int k = 0; k < 3; ++k) {
      d_q(k) = std::clamp(d_q(k), -q(k) / 3.0, q(k) / 3.0);
    }
    // Millionths: far below any measurement's standard deviation.
    const bool converged = d_start.cwiseAbs().maxCoeff() < 1e-5 &&
                           d_q.cwiseQuotient(q).cwiseAbs().maxCoeff() < 1e-5;
    if (converged) {
      std::vector<char> regular(legs_.size(), 1);
      for (std::size_t k = 0; k < legs_.size(); ++k) {
        regular[k] = pass.fault[k] <= kFaulty ? 1 : 0;
      }
      if (regular == used) return pass;
      if (std::count(regular.begin(), regular.end(), 0) > most_faulty) {
        return std::nullopt;
      }
      used = regular;
    }
    start = {start.x + d_start(0),
             start.y + d_start(1),
             WrapAngle(start.heading + d_start(2))};
    q += d_q;
  }
  return std::nullopt;
}

// Which part of the pose is not known well enough yet; "" where all is.
std::string PoseAligner::Unmeasured(const Pass& pass) const {
  const Eigen::Vector2d variances =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(
          pass.P.topLeftCorner<2, 2>(), Eigen::EigenvaluesOnly)
          .eigenvalues();
  const double heading_sigma = std::sqrt(pass.P(2, 2));
  const double position_sigma =
      std::sqrt(variances(options_.allow_partial ? 0 : 1));
  if (heading_sigma < options_.max_heading_sigma &&
      position_sigma < options_.max_position_sigma) {
    return "";
  }
  char text[128];
  std::snprintf(text,
                sizeof text,
                "first pose unknown: sigma of heading %.2g rad, of position "
                "%.2g m so far",
                heading_sigma,
                position_sigma);
  return text;
}

Alignment PoseAligner::Solve() const {
  Alignment result;
  if (num_fixes() < options_.min_fixes) {
    result.reason = "first pose unknown: too few measurements yet";
    return result;
  }
  std::vector<Pass> passes;
  for (const double heading : StartHeadings()) {
    if (std::optional<Pass> pass = Iterate(heading)) {
      // A fix left out costs what it would at the limit.
      for (const char used : pass->used) {
        if (!used) pass->cost += kFaulty;
      }
      passes.push_back(std::move(*pass));
    }
  }
  result.reason =
      "first pose unknown: measurements do not agree with the wheels";
  result.disagrees = true;
  if (passes.empty()) return result;
  const Pass& best = *std::min_element(
      passes.begin(), passes.end(), [](const Pass& a, const Pass& b) {
        return a.cost < b.cost;
      });
  // Three components fix the pose; 4 sigma of chi-square's normal limit.
  const double free = std::max(best.num_components - 3, 1);
  if (best.chi_square > free + 4.0 * std::sqrt(2.0 * free) + 1.0) {
    return result;
  }
  result.disagrees = false;
  result.reason = Unmeasured(best);
  if (!result.reason.empty()) return result;
  for (const Pass& other : passes) {
    const double turn =
        std::abs(WrapAngle(other.start.heading - best.start.heading));
    if (turn > options_.max_heading_sigma &&
        other.cost - best.cost < options_.min_separation) {
      result.reason = "first pose unknown: another heading fits as well";
      return result;
    }
  }
  result.is_known = true;
  result.X_WR = {best.X_WR.x + best.error(0),
                 best.X_WR.y + best.error(1),
                 WrapAngle(best.X_WR.heading + best.error(2))};
  const Eigen::Vector3d q = best.q + best.error.segment<3>(3);
  result.parameters = ParametersFromForm(q, kForm);
  OdometryEkf::Matrix6 J = OdometryEkf::Matrix6::Identity();
  J.bottomRightCorner<3, 3>() = ParametersByForm(q, kForm);
  const OdometryEkf::Matrix6 P =
      J * best.P.topLeftCorner<6, 6>() * J.transpose();
  result.covariance = 0.5 * (P + P.transpose());
  result.num_fixes =
      static_cast<int>(std::count(best.used.begin(), best.used.end(), char{1}));
  return result;
}

}  // namespace waymark
