#include "estimation/base/statistics.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace waymark {

Summary Summarise(std::span<const double> magnitudes) {
  Summary summary;
  summary.num = static_cast<int>(magnitudes.size());
  if (magnitudes.empty()) return summary;
  std::vector<double> sorted(magnitudes.begin(), magnitudes.end());
  std::sort(sorted.begin(), sorted.end());
  double sum = 0.0;
  double squares = 0.0;
  for (const double value : sorted) {
    sum += value;
    squares += value * value;
  }
  const auto n = sorted.size();
  summary.rmse = std::sqrt(squares / static_cast<double>(n));
  summary.mean = sum / static_cast<double>(n);
  summary.median = 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
  summary.p95 = sorted[(95 * n + 99) / 100 - 1];  // ceil(0.95 n)-th smallest.
  summary.max = sorted.back();
  return summary;
}

Interval WilsonInterval(std::int64_t num_successes,
                        std::int64_t num_runs,
                        double z) {
  WAYMARK_CHECK(0 <= num_successes && num_successes <= num_runs &&
                    std::isfinite(z) && z > 0.0,
                num_successes,
                num_runs,
                z);
  if (num_runs == 0) return {0.0, 1.0};
  const auto n = static_cast<double>(num_runs);
  const double p = static_cast<double>(num_successes) / n;
  const double z2 = z * z;
  const double middle = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half =
      z / (1.0 + z2 / n) * std::sqrt(p * (1.0 - p) / n + z2 / (4.0 * n * n));
  // At 0 and 1 the ends are exact, but for rounding.
  return {num_successes == 0 ? 0.0 : std::max(0.0, middle - half),
          num_successes == num_runs ? 1.0 : std::min(1.0, middle + half)};
}

double SuccessWeightedByPathLength(std::span<const PathOutcome> outcomes) {
  if (outcomes.empty()) return 0.0;
  double sum = 0.0;
  for (const PathOutcome& outcome : outcomes) {
    if (!outcome.is_success) continue;
    const double longer = std::max(outcome.way, outcome.shortest);
    sum += longer > 0.0 ? outcome.shortest / longer : 1.0;
  }
  return sum / static_cast<double>(outcomes.size());
}

}  // namespace waymark
