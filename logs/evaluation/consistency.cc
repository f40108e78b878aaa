#include "logs/evaluation/consistency.h"

#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>

#include <cmath>

namespace waymark {
namespace {

// Regularised lower incomplete gamma function P(a, x): series for small x,
// continued fraction (Lentz) otherwise.
double IncompleteGamma(double a, double x) {
  if (x <= 0.0) return 0.0;
  constexpr double kPrecision = 1e-15;
  // The series needs about sqrt(a) terms near its worst place, x = a.
  constexpr int kMaxTerms = 100000;
  const double scale = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a;
    double sum = term;
    for (int n = 1; n < kMaxTerms && term > sum * kPrecision; ++n) {
      term *= x / (a + n);
      sum += term;
    }
    return sum * scale;
  }
  constexpr double kTiny = 1e-300;
  double b = x + 1.0 - a;
  double c = 1.0 / kTiny;
  double d = 1.0 / b;
  double h = d;
  for (int n = 1; n < kMaxTerms; ++n) {
    const double an = -n * (n - a);
    b += 2.0;
    d = an * d + b;
    if (std::abs(d) < kTiny) d = kTiny;
    c = b + an / c;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1.0 / d;
    h *= d * c;
    if (std::abs(d * c - 1.0) < kPrecision) break;
  }
  return 1.0 - scale * h;
}

struct ErrorWithCovariance {
  Eigen::Vector3d error;
  Eigen::Matrix3d covariance;
};

// Of (p_WS, heading).
ErrorWithCovariance AtPoint(const AssociatedPair& pair) {
  const Pose2& X_WR = pair.estimate.X_WR;
  const Eigen::Vector2d gap = pair.EstimatedPoint() - pair.truth.p_WS;
  const double turn =
      pair.truth.heading ? WrapAngle(X_WR.heading - *pair.truth.heading) : 0.0;
  // d p_WS / d heading is p_RS turned by heading + 90 degrees.
  const double c = std::cos(X_WR.heading);
  const double s = std::sin(X_WR.heading);
  const Eigen::Vector2d& p_RS = pair.truth.p_RS;
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J(0, 2) = -s * p_RS.x() - c * p_RS.y();
  J(1, 2) = c * p_RS.x() - s * p_RS.y();
  return {{gap.x(), gap.y(), turn},
          J * *pair.estimate.covariance * J.transpose()};
}

}  // namespace

double ChiSquareQuantile(double probability, double dof) {
  WAYMARK_CHECK(probability > 0.0 && probability < 1.0, probability);
  WAYMARK_CHECK(dof > 0.0, dof);
  double low = 0.0;
  double high = dof + 10.0;
  while (IncompleteGamma(0.5 * dof, 0.5 * high) < probability) high *= 2.0;
  // Bisection halves the interval; 80 steps reach double precision.
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (IncompleteGamma(0.5 * dof, 0.5 * middle) < probability ? low : high) =
        middle;
  }
  return 0.5 * (low + high);
}

Band NeesBand(int dof, int num_runs, double probability) {
  WAYMARK_CHECK(dof > 0 && num_runs > 0, dof, num_runs);
  const double tail = 0.5 * (1.0 - probability);
  const double total = static_cast<double>(dof) * num_runs;
  return {ChiSquareQuantile(tail, total) / num_runs,
          ChiSquareQuantile(1.0 - tail, total) / num_runs};
}

std::optional<Nees> EvaluateNees(std::span<const AssociatedPair> pairs,
                                 int dof) {
  WAYMARK_CHECK(dof == 2 || dof == 3, dof);
  Nees nees;
  nees.dof = dof;
  nees.band = NeesBand(dof, 1);
  int num_below = 0;
  int num_above = 0;
  double sum = 0.0;
  for (const AssociatedPair& pair : pairs) {
    if (!pair.estimate.covariance) continue;
    if (dof == 3 && !pair.truth.heading) continue;
    const ErrorWithCovariance e = AtPoint(pair);
    const Eigen::LLT<Eigen::MatrixXd> llt(e.covariance.topLeftCorner(dof, dof));
    const Eigen::VectorXd error = e.error.head(dof);
    const double value = error.dot(llt.solve(error));
    if (llt.info() != Eigen::Success || !std::isfinite(value)) {
      ++nees.num_unusable;
      continue;
    }
    nees.times.push_back(pair.truth.time);
    nees.values.push_back(value);
    sum += value;
    if (value < nees.band.low) ++num_below;
    if (value > nees.band.high) ++num_above;
  }
  if (nees.values.empty()) return std::nullopt;
  const auto num = static_cast<double>(nees.values.size());
  nees.mean = sum / num;
  nees.share_below = num_below / num;
  nees.share_above = num_above / num;
  nees.share_inside = 1.0 - nees.share_below - nees.share_above;
  return nees;
}

}  // namespace waymark
