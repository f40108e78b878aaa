// Y8: the three directions of photographed buildings (York Urban).
#pragma once

#include "tests/bench/bench_report.h"

#include <vector>

namespace waymark {

[[nodiscard]] std::vector<BenchRow> BenchYork(bool full);

}  // namespace waymark
