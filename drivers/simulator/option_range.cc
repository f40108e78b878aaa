#include "drivers/simulator/option_range.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace waymark {
namespace {

void Require(bool holds,
             const std::string& field,
             double value,
             const std::string& range) {
  if (holds && std::isfinite(value)) return;
  std::ostringstream out;
  out << field << " = " << value << " is not " << range;
  throw std::invalid_argument(out.str());
}

}  // namespace

void RequireAbove0(const std::string& field, double value) {
  Require(value > 0.0, field, value, "above 0");
}

void RequireNotNegative(const std::string& field, double value) {
  Require(value >= 0.0, field, value, "0 or above");
}

void RequireWithin(const std::string& field,
                   double value,
                   double low,
                   double high) {
  std::ostringstream range;
  range << "in [" << low << ", " << high << "]";
  Require(value >= low && value <= high, field, value, range.str());
}

}  // namespace waymark
