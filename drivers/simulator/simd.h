// Four floats at once (a colour with a spare lane), by the vector extensions
// of GCC and clang: the same on every machine that has 16-byte vectors.
#pragma once

#include <cstdint>
#include <cstring>

namespace waymark {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

inline Float4 Broadcast(float value) {
  return Float4{value, value, value, value};
}

inline Float4 LoadFour(const float* from) {
  Float4 four;
  std::memcpy(&four, from, sizeof four);
  return four;
}

inline void StoreFour(const Float4& four, float* to) {
  std::memcpy(to, &four, sizeof four);
}

// Unlike std::floor no call of a library function, which SSE2 alone needs.
// |value| < 2^31.
inline int FloorToInt(float value) {
  const int truncated = static_cast<int>(value);
  return truncated - (value < static_cast<float>(truncated) ? 1 : 0);
}

// log2 of a positive, normal number by its exponent and a straight line
// through its mantissa: up to 0.09 too small, continuous and growing.
inline float RoughLog2(float value) {
  std::int32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  constexpr float kPerUnit = 1.0f / static_cast<float>(1 << 23);
  constexpr float kBias = 127.0f;
  return static_cast<float>(bits) * kPerUnit - kBias;
}

}  // namespace waymark
