#include "estimation/lines/manhattan_likelihood.h"

#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace waymark {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The turn that the pull asks for; nothing where one is left open, or leaves
// the maximum it began at.
std::optional<Vector3d> Solve(const Matrix3d& slope, const Vector3d& pull) {
  constexpr double kMaxStep = 0.2;
  const Eigen::FullPivLU<Matrix3d> lu(slope);
  if (!lu.isInvertible()) return std::nullopt;
  const Vector3d turn = lu.solve(pull);
  if (!(turn.norm() <= kMaxStep)) return std::nullopt;
  return turn;
}

void Turn(const Vector3d& turn, Matrix3d* R_CM) {
  const double angle = turn.norm();
  if (angle > 0.0) *R_CM = Eigen::AngleAxisd(angle, turn / angle) * *R_CM;
}

}  // namespace

ManhattanLikelihood::ManhattanLikelihood(
    std::vector<LineDirection> lines,
    std::vector<double> weights,
    const std::optional<DirectionPrior>& gravity,
    double model_sigma_rad,
    double inlier_share)
    : lines_(std::move(lines)),
      weights_(std::move(weights)),
      gravity_(gravity),
      model_variance_(model_sigma_rad * model_sigma_rad),
      odds_(OddsOf(inlier_share)) {}

double ManhattanLikelihood::OddsOf(double inlier_share) {
  return inlier_share / (3.0 * (1.0 - inlier_share)) * std::sqrt(0.5 * kPi);
}

AxisFit ManhattanLikelihood::FitOf(const LineDirection& line,
                                   const Vector3d& n_C) const {
  // Beyond, a line is as good as not along the axis: exp(-25).
  constexpr double kFar = 50.0;
  const double across = line.across_C.dot(n_C);
  const double along = line.along_C.dot(n_C);
  const double offset = line.sigma_px * n_C.z();
  const double variance =
      offset * offset +
      (line.sigma_rad * line.sigma_rad + model_variance_) * along * along;
  // Also where both are 0.
  if (!(across * across < kFar * variance)) return {};
  const double sigma = std::sqrt(variance);
  const double z = across / sigma;
  const double length = std::max(std::abs(along), sigma);
  return {odds_ * length / sigma * std::exp(-0.5 * z * z), z, sigma};
}

int ManhattanLikelihood::ClosestAxis(const LineDirection& line,
                                     const Matrix3d& R_CM) const {
  int axis = -1;
  double least = 0.0;
  for (int k = 0; k < 3; ++k) {
    const AxisFit fit = FitOf(line, R_CM.col(k));
    if (!(fit.belief > 0.0)) continue;
    if (axis >= 0 && std::abs(fit.z) >= least) continue;
    least = std::abs(fit.z);
    axis = k;
  }
  return axis;
}

double ManhattanLikelihood::Support(const Matrix3d& R_CM) const {
  double support = 0.0;
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    double sum = 1.0;
    for (int k = 0; k < 3; ++k) sum += FitOf(lines_[l], R_CM.col(k)).belief;
    support += weights_[l] * std::log(sum);
  }
  return support + GravitySupport(R_CM);
}

bool ManhattanLikelihood::Climb(Matrix3d* R_CM,
                                int max_steps,
                                double converged) const {
  for (int i = 0; i < max_steps; ++i) {
    Normal normal;
    for (std::size_t l = 0; l < lines_.size(); ++l) {
      const LineDirection& line = lines_[l];
      std::array<AxisFit, 3> fits{};
      double sum = 1.0;
      for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        fits[at] = FitOf(line, R_CM->col(k));
        sum += fits[at].belief;
      }
      for (int k = 0; k < 3; ++k) {
        const AxisFit& fit = fits[static_cast<std::size_t>(k)];
        // It moves nothing: a millionth of a line.
        if (!(fit.belief > 1e-6 * sum)) continue;
        normal.Add(line, R_CM->col(k), fit, weights_[l] * fit.belief / sum);
      }
    }
    AddGravity(*R_CM, &normal);
    const std::optional<Vector3d> turn = Solve(normal.information, normal.pull);
    if (!turn) return false;
    Turn(*turn, R_CM);
    if (turn->norm() < converged) break;
  }
  return true;
}

std::optional<Matrix3d> ManhattanLikelihood::Settle(Matrix3d* R_CM) const {
  constexpr int kMaxSteps = 60;
  constexpr int kNumFree = 6;  // Then lines keep to their axes.
  constexpr double kConverged = 1e-10;
  // The likelihood's own rounding hides its rise over steps as small.
  constexpr double kSmall = 1e-6;
  constexpr double kLeastDamping = 1e-3;
  constexpr double kMostDamping = 1e12;  // Then no step is small enough.
  std::vector<Held> held(lines_.size());
  double damping = 0.0;
  for (int i = 0; i < kMaxSteps; ++i) {
    const bool is_last = i + 1 == kMaxSteps;
    const Tails tails = TailsOf(*R_CM, i < kNumFree, &held);
    if (!Eigen::FullPivLU<Matrix3d>(tails.information).isInvertible()) {
      return std::nullopt;
    }
    for (;;) {
      const Eigen::LLT<Matrix3d> llt(tails.slope + damping * tails.information);
      Vector3d turn = Vector3d::Zero();
      Matrix3d next = *R_CM;
      if (llt.info() == Eigen::Success) {
        turn = llt.solve(tails.pull);
        Turn(turn, &next);
        const bool is_small = turn.norm() < kSmall;
        if (is_small || Support(held, next) >= tails.support) {
          *R_CM = next;
          if (turn.norm() < (is_last ? kSmall : kConverged)) {
            return tails.Covariance();
          }
          damping = damping < kLeastDamping ? 0.0 : 0.25 * damping;
          break;
        }
      }
      damping = std::max(4.0 * damping, 4.0 * kLeastDamping);
      if (damping > kMostDamping) return std::nullopt;
    }
  }
  return std::nullopt;
}

void ManhattanLikelihood::Normal::Add(const LineDirection& line,
                                      const Vector3d& n_C,
                                      const AxisFit& fit,
                                      double weight) {
  // across' (turn x n) = turn' (n x across).
  const Vector3d g = n_C.cross(line.across_C) / fit.sigma;
  information += weight * g * g.transpose();
  pull -= weight * fit.z * g;
}

Matrix3d ManhattanLikelihood::Tails::Covariance() const {
  const Matrix3d inverse = slope.inverse();
  return inverse * scatter * inverse.transpose();
}

ManhattanLikelihood::Tails ManhattanLikelihood::TailsOf(
    const Matrix3d& R_CM, bool is_free, std::vector<Held>* held) const {
  Tails tails;
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    Held& own = (*held)[l];
    if (is_free) own.axis = ClosestAxis(lines_[l], R_CM);
    own.odds = 0.0;
    if (own.axis < 0) continue;
    const Vector3d n_C = R_CM.col(own.axis);
    const AxisFit fit = FitOf(lines_[l], n_C);
    if (!(fit.belief > 0.0)) continue;
    own.sigma = fit.sigma;
    own.odds = fit.belief * std::exp(0.5 * fit.z * fit.z);
    // It falls with z by z w (1 - w).
    const double weight = fit.belief / (1.0 + fit.belief);
    tails.support += weights_[l] * std::log1p(fit.belief);
    tails.Add(lines_[l], n_C, fit, weights_[l] * weight);
    const Vector3d g = n_C.cross(lines_[l].across_C) / fit.sigma;
    const Matrix3d square = weights_[l] * weight * g * g.transpose();
    tails.slope += (1.0 - fit.z * fit.z * (1.0 - weight)) * square;
    // Pieces of one line err together.
    tails.scatter += weight * square;
  }
  const Matrix3d gravity = AddGravity(R_CM, &tails);
  tails.support += GravitySupport(R_CM);
  tails.slope += gravity;
  tails.scatter += gravity;
  return tails;
}

double ManhattanLikelihood::GravitySupport(const Matrix3d& R_CM) const {
  if (!gravity_) return 0.0;
  const double off =
      R_CM.col(2).cross(gravity_->n_C).norm() / gravity_->sigma_rad;
  return -0.5 * off * off;
}

double ManhattanLikelihood::Support(const std::vector<Held>& held,
                                    const Matrix3d& R_CM) const {
  double support = 0.0;
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    const Held& own = held[l];
    if (!(own.odds > 0.0)) continue;
    const double z = lines_[l].across_C.dot(R_CM.col(own.axis)) / own.sigma;
    support += weights_[l] * std::log1p(own.odds * std::exp(-0.5 * z * z));
  }
  return support + GravitySupport(R_CM);
}

Matrix3d ManhattanLikelihood::AddGravity(const Matrix3d& R_CM,
                                         Normal* normal) const {
  if (!gravity_) return Matrix3d::Zero();
  const Vector3d n_C = R_CM.col(2);
  const double certainty = 1.0 / (gravity_->sigma_rad * gravity_->sigma_rad);
  Matrix3d across = certainty * (Matrix3d::Identity() - n_C * n_C.transpose());
  normal->information += across;
  normal->pull -= certainty * n_C.cross(gravity_->n_C);
  return across;
}

}  // namespace waymark
