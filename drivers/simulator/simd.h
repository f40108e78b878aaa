// Four floats at once (a colour with a spare lane), by the vector extensions
// of GCC and clang: the same on every machine that has 16-byte vectors.
#pragma once

#include <algorithm>
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

// a where `share` is 0, b where it is 1.
inline Float4 Mix(const Float4& a, const Float4& b, float share) {
  return a + Broadcast(share) * (b - a);
}

// Of the three colours.
inline float Largest(const Float4& a) {
  return std::max({a[0], a[1], a[2]});
}

// Of eight values: bit i is set where value i is `value`.
inline std::uint32_t LanesEqual(const void* values, std::int32_t value) {
  Int4 low;
  Int4 high;
  std::memcpy(&low, values, sizeof low);
  std::memcpy(
      &high, static_cast<const char*>(values) + sizeof low, sizeof high);
  const Int4 wanted{value, value, value, value};
  const Int4 bits = ((low == wanted) & Int4{1, 2, 4, 8}) |
                    ((high == wanted) & Int4{16, 32, 64, 128});
  return static_cast<std::uint32_t>(bits[0] | bits[1] | bits[2] | bits[3]);
}

// To [0, 1]; NaN becomes 0.
inline Float4 ClampToOne(const Float4& value) {
  const Float4 positive = value > 0.0f ? value : Float4{};
  return positive < 1.0f ? positive : Broadcast(1.0f);
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
