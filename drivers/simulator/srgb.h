// The sRGB curve: linear light to and from 8-bit values of images.
#pragma once

#include "drivers/simulator/simd.h"

#include <array>
#include <cstdint>

namespace waymark {

// [0, 255] to [0, 1].
[[nodiscard]] float LinearFromSrgb(std::uint8_t value);

// Rounded to the nearest; below 0 and NaN give 0, above 1 gives 255. By table:
// within 0.1 of a step of the curve.
class SrgbTable {
 public:
  SrgbTable();

  [[nodiscard]] std::uint8_t FromLinear(float light) const {
    // In this order NaN becomes 0.
    const float clamped = light > 0.0f ? (light < 1.0f ? light : 1.0f) : 0.0f;
    return table_[static_cast<std::size_t>(clamped * kScale + kHalf)];
  }

  // The same of four values in two steps: Value(PlacesOf(light)[i]).
  [[nodiscard]] static Int4 PlacesOf(const Float4& light) {
    return __builtin_convertvector(
        ClampToOne(light) * Broadcast(kScale) + Broadcast(kHalf), Int4);
  }
  [[nodiscard]] std::uint8_t Value(std::int32_t place) const {
    return table_[static_cast<std::size_t>(place)];
  }

 private:
  // Five entries for the darkest, steepest step.
  static constexpr int kSize = 16384;
  static constexpr float kHalf = 0.5f;  // Truncation rounds with it.
  static constexpr float kScale = static_cast<float>(kSize);
  std::array<std::uint8_t, kSize + 1> table_;
};

}  // namespace waymark
