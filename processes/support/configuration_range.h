// How loading and printing of configurations speak of values.
#pragma once

#include "processes/support/describer.h"

#include <cstdint>
#include <numbers>
#include <string>

namespace waymark {

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

// " in [0, 30]", " > 0"; empty where every number is allowed.
[[nodiscard]] std::string NumberRange(Range range);
[[nodiscard]] std::string IntegerRange(std::int64_t min, std::int64_t max);

}  // namespace waymark
