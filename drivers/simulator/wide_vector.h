// Eight numbers at a time, by AVX2 and FMA: for files that ask the machine
// first (HasWideShader()). Internal to the wide shader, and of one machine.
#pragma once

#include "drivers/simulator/ray_caster.h"

#include <immintrin.h>

#include <cstdint>

// With FMA: a twentieth of the time of a picture, other roundings.
#define WAYMARK_WIDE __attribute__((target("avx2,fma")))

namespace waymark {

// Three numbers of each lane.
struct Wide3 {
  __m256 x;
  __m256 y;
  __m256 z;
};

WAYMARK_WIDE inline __m256 Same(float value) {
  return _mm256_set1_ps(value);
}

WAYMARK_WIDE inline Wide3 Load(const float (&from)[3][RayPacket::kLanes]) {
  return {_mm256_loadu_ps(from[0]),
          _mm256_loadu_ps(from[1]),
          _mm256_loadu_ps(from[2])};
}

WAYMARK_WIDE inline __m256 Dot(const Wide3& a, const Wide3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

WAYMARK_WIDE inline __m256 Mix(__m256 a, __m256 b, __m256 share) {
  return a + share * (b - a);
}

WAYMARK_WIDE inline Wide3 Mix3(const Wide3& a, const Wide3& b, __m256 share) {
  return {Mix(a.x, b.x, share), Mix(a.y, b.y, share), Mix(a.z, b.z, share)};
}

WAYMARK_WIDE inline __m256i Clamp(__m256i value, __m256i low, __m256i high) {
  return _mm256_min_epi32(_mm256_max_epi32(value, low), high);
}

WAYMARK_WIDE inline __m256 Select(__m256 mask, __m256 yes, __m256 no) {
  return _mm256_blendv_ps(no, yes, mask);
}

WAYMARK_WIDE inline int Lane(__m256i values, int lane) {
  return _mm256_cvtsi256_si32(
      _mm256_permutevar8x32_epi32(values, _mm256_set1_epi32(lane)));
}

// Lanes of `mask` (bit i: lane i) as all bits set.
WAYMARK_WIDE inline __m256i LaneMask(std::uint32_t mask) {
  const __m256i bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm256_cmpeq_epi32(
      _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(mask)), bits), bits);
}

}  // namespace waymark
