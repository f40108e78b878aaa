#include "estimation/camera/polynomial_roots.h"

#include <cstddef>

namespace waymark {
namespace {

double ValueAt(std::span<const double> coefficients, double x) {
  double value = 0.0;
  for (std::size_t i = coefficients.size(); i-- > 0;) {
    value = value * x + coefficients[i];
  }
  return value;
}

}  // namespace

std::vector<double> RootsBetween(std::span<const double> coefficients,
                                 double low,
                                 double high) {
  if (coefficients.size() < 2) return {};
  std::vector<double> derivative;
  for (std::size_t i = 1; i < coefficients.size(); ++i) {
    derivative.push_back(static_cast<double>(i) * coefficients[i]);
  }
  // Between two of these the polynomial only rises or only falls.
  std::vector<double> ends = RootsBetween(derivative, low, high);
  ends.push_back(high);
  std::vector<double> roots;
  double left = low;
  for (const double right : ends) {
    double a = left;
    double b = right;
    left = right;
    const bool is_positive = ValueAt(coefficients, a) > 0.0;
    if ((ValueAt(coefficients, b) > 0.0) == is_positive) continue;
    while (true) {
      const double middle = a + 0.5 * (b - a);
      if (!(middle > a && middle < b)) break;
      ((ValueAt(coefficients, middle) > 0.0) == is_positive ? a : b) = middle;
    }
    roots.push_back(b);
  }
  return roots;
}

}  // namespace waymark
