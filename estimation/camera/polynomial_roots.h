// Real roots of polynomials in an interval.
#pragma once

#include <span>
#include <vector>

namespace waymark {

// Where a0 + a1 x + a2 x^2 + ... changes its sign in (low, high], ascending.
// Roots that only touch zero may be left out. By bisection between the roots of
// the derivative, to the last bit. Degrees up to some ten; finite bounds.
[[nodiscard]] std::vector<double> RootsBetween(
    std::span<const double> coefficients, double low, double high);

}  // namespace waymark
