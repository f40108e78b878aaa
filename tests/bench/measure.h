// What benchmarks measure with.
#pragma once

#include <functional>
#include <vector>

namespace waymark {

// Of this process: other programs on the machine do not count.
[[nodiscard]] double CpuSeconds();
[[nodiscard]] double CpuSecondsOf(const std::function<void()>& work);

// The smallest value that a share of them does not exceed; 0 of none.
[[nodiscard]] double Quantile(std::vector<double> values, double share);
[[nodiscard]] double Median(const std::vector<double>& values);

}  // namespace waymark
