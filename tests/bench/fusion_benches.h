// The filter's rows beside Y23.
#pragma once

#include "tests/bench/bench_report.h"

#include <vector>

namespace waymark {

[[nodiscard]] std::vector<BenchRow> BenchGate(bool full);
[[nodiscard]] std::vector<BenchRow> BenchReadingRate(bool full);
[[nodiscard]] std::vector<BenchRow> BenchLatency(bool full);

}  // namespace waymark
