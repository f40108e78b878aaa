#include "drivers/simulator/srgb.h"

#include <cmath>

namespace waymark {
namespace {

// IEC 61966-2-1.
constexpr double kLinearPart = 0.0031308;
constexpr double kSlope = 12.92;
constexpr double kOffset = 0.055;
constexpr double kExponent = 2.4;

double ToSrgb(double light) {
  if (light <= kLinearPart) return kSlope * light;
  return (1.0 + kOffset) * std::pow(light, 1.0 / kExponent) - kOffset;
}

double ToLinear(double value) {
  if (value <= kSlope * kLinearPart) return value / kSlope;
  return std::pow((value + kOffset) / (1.0 + kOffset), kExponent);
}

}  // namespace

float LinearFromSrgb(std::uint8_t value) {
  static const std::array<float, 256> kTable = [] {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      table[i] = static_cast<float>(ToLinear(static_cast<double>(i) / 255.0));
    }
    return table;
  }();
  return kTable[value];
}

SrgbTable::SrgbTable() {
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const double light = static_cast<double>(i) / kSize;
    table_[i] = static_cast<std::uint8_t>(std::lround(255.0 * ToSrgb(light)));
  }
}

}  // namespace waymark
