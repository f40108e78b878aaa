#include "estimation/filter/two_hypothesis_gate.h"

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace waymark {
namespace {

// log of the normal density at `residual`, without its factor of 2 pi, which
// cancels. -infinity where S is not positive definite.
double LogDensity(const FixVector& residual, const FixMatrix& S) {
  const Eigen::LLT<FixMatrix> llt(S);
  if (llt.info() != Eigen::Success) {
    return -std::numeric_limits<double>::infinity();
  }
  double log_determinant = 0.0;
  for (Eigen::Index i = 0; i < S.rows(); ++i) {
    log_determinant += 2.0 * std::log(llt.matrixLLT()(i, i));
  }
  return -0.5 * (residual.dot(llt.solve(residual)) + log_determinant);
}

}  // namespace

void GateOptions::Check() const {
  const auto require = [](bool is_good, const char* what) {
    if (!is_good) throw std::invalid_argument(what);
  };
  require(min_regular >= 0.0 && min_regular < 1.0,
          "gate.min_regular: must be in [0, 1)");
  require(prior_regular > min_regular && prior_regular < 1.0,
          "gate.prior_regular: must exceed gate.min_regular, or nothing would "
          "be accepted where little is known, and be below 1");
  require(faulty_position_sigma > 0.0 && faulty_heading_sigma > 0.0,
          "gate.faulty_position_sigma and _heading_sigma: must be positive");
}

double RegularProbability(const std::array<bool, 3>& has,
                          const Innovation& innovation,
                          const GateOptions& options) {
  const FixMatrix S = innovation.HPH + innovation.R;
  if (!S.allFinite() || !innovation.residual.allFinite()) return 0.0;
  FixMatrix S_faulty = S;
  int row = 0;
  for (int i = 0; i < 3; ++i) {
    if (!has[static_cast<std::size_t>(i)]) continue;
    const double sigma =
        i == 2 ? options.faulty_heading_sigma : options.faulty_position_sigma;
    S_faulty(row, row) += sigma * sigma;
    ++row;
  }
  const double regular = LogDensity(innovation.residual, S);
  const double faulty = LogDensity(innovation.residual, S_faulty);
  if (!std::isfinite(regular) || !std::isfinite(faulty)) return 0.0;
  const double odds = std::log(1.0 - options.prior_regular) -
                      std::log(options.prior_regular) + faulty - regular;
  return 1.0 / (1.0 + std::exp(odds));
}

}  // namespace waymark
