// Figures of many runs.
#pragma once

#include <cstdint>
#include <span>

namespace waymark {

// Of N magnitudes. The median of an even number is the mean of the middle two;
// p95 is the smallest value that at least 95 % do not exceed. All 0 for N = 0.
struct Summary {
  int num = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double p95 = 0.0;
  double max = 0.0;
};
[[nodiscard]] Summary Summarise(std::span<const double> magnitudes);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

// Where the probability of success lies, as the score interval [1] has it:
// holds for few runs, and for none or all successful, too. [0, 1] without any.
// `z` is the normal quantile: 1.96 for 95 %. Throws std::logic_error unless
// 0 <= num_successes <= num_runs and z is finite and positive.
//
// [1] E. B. Wilson. Probable inference, the law of succession, and statistical
//     inference. JASA 22(158), 209-212, 1927.
[[nodiscard]] Interval WilsonInterval(std::int64_t num_successes,
                                      std::int64_t num_runs,
                                      double z = 1.959963984540054);

// One drive to a goal.
struct PathOutcome {
  bool is_success = false;
  double way = 0.0;       // Driven, m.
  double shortest = 0.0;  // Of the shortest way there, m.
};

// Success weighted by path length [1]: the mean of shortest / max(way,
// shortest), 0 for failures. 0 without any. A goal at the start counts as 1
// where nothing was driven.
//
// [1] P. Anderson et al. On evaluation of embodied navigation agents.
//     arXiv:1807.06757, 2018.
[[nodiscard]] double SuccessWeightedByPathLength(
    std::span<const PathOutcome> outcomes);

}  // namespace waymark
