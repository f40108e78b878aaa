// Textures at eight places at a time; internal to the wide shader.
#pragma once

#include "drivers/simulator/texture_sampler.h"
#include "drivers/simulator/wide_vector.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace waymark {

// In units of the largest field squared.
WAYMARK_WIDE inline Wide3 Unpack(__m256 texels) {
  const __m256i packed = _mm256_castps_si256(texels);
  const __m256i mask = _mm256_set1_epi32(TextureSampler::kFieldMask);
  constexpr int kBits = TextureSampler::kFieldBits;
  const __m256 b = _mm256_cvtepi32_ps(_mm256_and_si256(packed, mask));
  const __m256 g = _mm256_cvtepi32_ps(
      _mm256_and_si256(_mm256_srli_epi32(packed, kBits), mask));
  const __m256 r = _mm256_cvtepi32_ps(_mm256_srli_epi32(packed, 2 * kBits));
  return {b * b, g * g, r * r};
}

// A texel and the one to the right of it.
struct Pair {
  __m256 left;
  __m256 right;
};

WAYMARK_WIDE inline Pair GatherPair(const std::uint32_t* texels,
                                    __m256i index) {
  const auto* base = reinterpret_cast<const long long*>(texels);
  // Lanes 0, 1, 4, 5, then 2, 3, 6, 7: so that the shuffles below, which stay
  // within halves, bring them in order.
  const __m256i ordered = _mm256_permute4x64_epi64(index, 0xD8);
  const __m256 outer = _mm256_castsi256_ps(
      _mm256_i32gather_epi64(base, _mm256_castsi256_si128(ordered), 4));
  const __m256 inner = _mm256_castsi256_ps(
      _mm256_i32gather_epi64(base, _mm256_extracti128_si256(ordered, 1), 4));
  return {_mm256_shuffle_ps(outer, inner, 0x88),
          _mm256_shuffle_ps(outer, inner, 0xDD)};
}

// u and v in [0, 1); each lane has its own mip level. As Unpack, in units of
// the largest field squared.
WAYMARK_WIDE inline Wide3 Bilinear(const TextureSampler::Levels& levels,
                                   const std::uint32_t* texels,
                                   __m256i level,
                                   __m256 u,
                                   __m256 v) {
  __m256i width;
  __m256i height;
  __m256i first;
  const int one_level = _mm_cvtsi128_si32(_mm256_castsi256_si128(level));
  if (_mm256_movemask_epi8(
          _mm256_cmpeq_epi32(level, _mm256_set1_epi32(one_level))) == -1) {
    width = _mm256_set1_epi32(levels.width[one_level]);
    height = _mm256_set1_epi32(levels.height[one_level]);
    first = _mm256_set1_epi32(levels.first[one_level]);
  } else {
    width = _mm256_i32gather_epi32(levels.width, level, 4);
    height = _mm256_i32gather_epi32(levels.height, level, 4);
    first = _mm256_i32gather_epi32(levels.first, level, 4);
  }
  const __m256i one = _mm256_set1_epi32(1);
  const __m256i zero = _mm256_setzero_si256();
  const __m256i last_x = _mm256_sub_epi32(width, one);
  const __m256i last_y = _mm256_sub_epi32(height, one);
  const __m256 x = u * _mm256_cvtepi32_ps(width) - Same(0.5f);
  const __m256 y = v * _mm256_cvtepi32_ps(height) - Same(0.5f);
  const __m256 floor_x = _mm256_floor_ps(x);
  const __m256 floor_y = _mm256_floor_ps(y);
  __m256i x0 = _mm256_cvttps_epi32(floor_x);
  __m256i y0 = _mm256_cvttps_epi32(floor_y);
  // -1 becomes the last one.
  x0 = _mm256_blendv_epi8(x0, last_x, _mm256_cmpgt_epi32(zero, x0));
  y0 = _mm256_blendv_epi8(y0, last_y, _mm256_cmpgt_epi32(zero, y0));
  // Lanes without a sample hold anything: they must still read texels.
  x0 = Clamp(x0, zero, last_x);
  y0 = Clamp(y0, zero, last_y);
  const __m256i stride = _mm256_add_epi32(width, one);
  const __m256i top = _mm256_add_epi32(_mm256_add_epi32(first, x0),
                                       _mm256_mullo_epi32(y0, stride));
  const Pair upper = GatherPair(texels, top);
  const Pair lower = GatherPair(texels, _mm256_add_epi32(top, stride));
  const Wide3 a = Unpack(upper.left);
  const Wide3 b = Unpack(upper.right);
  const Wide3 c = Unpack(lower.left);
  const Wide3 d = Unpack(lower.right);
  const __m256 fx = x - floor_x;
  return Mix3(Mix3(a, b, fx), Mix3(c, d, fx), y - floor_y);
}

struct WideFootprint {
  __m256 du_dx;
  __m256 dv_dx;
  __m256 du_dy;
  __m256 dv_dy;
};

struct Probes {
  __m256i num;
  __m256 per_probe;
  __m256 level;
  __m256 step_u;
  __m256 step_v;
  int most = 1;
};

// As TextureSampler::Sample chooses them.
WAYMARK_WIDE inline Probes ChooseProbes(const TextureSampler::Levels& levels,
                                        const WideFootprint& f,
                                        int max_probes) {
  const __m256 width = Same(static_cast<float>(levels.width[0]));
  const __m256 height = Same(static_cast<float>(levels.height[0]));
  const __m256 ux = f.du_dx * width;
  const __m256 vx = f.dv_dx * height;
  const __m256 uy = f.du_dy * width;
  const __m256 vy = f.dv_dy * height;
  const __m256 square_x = ux * ux + vx * vx;
  const __m256 square_y = uy * uy + vy * vy;
  const __m256 is_x = _mm256_cmp_ps(square_x, square_y, _CMP_GT_OQ);
  // In this order NaN becomes the small number, without which 0 / 0 follows.
  const __m256 longer =
      _mm256_max_ps(Select(is_x, square_x, square_y), Same(1e-20f));
  const __m256 area = ux * vy - uy * vx;
  const __m256 narrower = _mm256_max_ps(area * area / longer, Same(1.0f));
  constexpr float kSquare =
      TextureSampler::kProbeSpacing * TextureSampler::kProbeSpacing;
  Probes probes;
  probes.num = _mm256_set1_epi32(1);
  for (int n = 1; n < max_probes; ++n) {
    const __m256 is_more =
        _mm256_cmp_ps(longer,
                      Same(static_cast<float>(n * n) * kSquare) * narrower,
                      _CMP_GT_OQ);
    if (_mm256_movemask_ps(is_more) == 0) break;
    probes.num = _mm256_sub_epi32(probes.num, _mm256_castps_si256(is_more));
    probes.most = n + 1;
  }
  probes.per_probe = Same(1.0f) / _mm256_cvtepi32_ps(probes.num);
  const __m256 spaced =
      longer * probes.per_probe * probes.per_probe * Same(1.0f / kSquare);
  // RoughLog2.
  const __m256 bits =
      _mm256_cvtepi32_ps(_mm256_castps_si256(_mm256_max_ps(narrower, spaced)));
  probes.level = Same(0.5f) * (bits * Same(1.0f / (1 << 23)) - Same(127.0f));
  probes.step_u = probes.per_probe * Select(is_x, f.du_dx, f.du_dy);
  probes.step_v = probes.per_probe * Select(is_x, f.dv_dx, f.dv_dy);
  return probes;
}

// Of a texture of more than one texel.
WAYMARK_WIDE inline Wide3 SampleTexture(const TextureSampler& texture,
                                        __m256 u,
                                        __m256 v,
                                        const WideFootprint& footprint,
                                        int max_probes) {
  const TextureSampler::Levels& levels = texture.levels();
  const Float4 mean = texture.mean();
  const Wide3 means = {Same(mean[0]), Same(mean[1]), Same(mean[2])};
  const Probes probes = ChooseProbes(levels, footprint, max_probes);
  // One level, or two in the middle between them.
  const __m256i last = _mm256_set1_epi32(levels.num - 1);
  __m256i finer =
      Clamp(_mm256_cvttps_epi32(probes.level), _mm256_setzero_si256(), last);
  const __m256 is_far =
      _mm256_or_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(finer, last)),
                   _mm256_cmp_ps(probes.level, Same(30.0f), _CMP_GT_OQ));
  constexpr float kPure = TextureSampler::kPureLevel;
  __m256 share = (probes.level - _mm256_cvtepi32_ps(finer) - Same(kPure)) *
                 Same(1.0f / (1.0f - 2.0f * kPure));
  const __m256 is_coarse = _mm256_cmp_ps(share, Same(1.0f), _CMP_GE_OQ);
  finer = _mm256_min_epi32(
      _mm256_sub_epi32(finer, _mm256_castps_si256(is_coarse)), last);
  share = _mm256_andnot_ps(is_coarse, _mm256_max_ps(share, Same(0.0f)));
  const __m256i coarser =
      _mm256_min_epi32(_mm256_add_epi32(finer, _mm256_set1_epi32(1)), last);
  const bool is_mixed =
      _mm256_movemask_ps(_mm256_cmp_ps(share, Same(0.0f), _CMP_GT_OQ)) != 0;
  const __m256 first = Same(0.5f) * _mm256_cvtepi32_ps(_mm256_sub_epi32(
                                        _mm256_set1_epi32(1), probes.num));
  constexpr float kFarthest = 1e6f;  // Where repetitions have no fractions.
  u = _mm256_min_ps(_mm256_max_ps(u, Same(-kFarthest)), Same(kFarthest));
  v = _mm256_min_ps(_mm256_max_ps(v, Same(-kFarthest)), Same(kFarthest));
  u = u + first * probes.step_u;
  v = v + first * probes.step_v;
  Wide3 sum = {Same(0.0f), Same(0.0f), Same(0.0f)};
  for (int i = 0; i < probes.most; ++i) {
    const __m256 at_u = u + Same(static_cast<float>(i)) * probes.step_u;
    const __m256 at_v = v + Same(static_cast<float>(i)) * probes.step_v;
    const __m256 in_u = at_u - _mm256_floor_ps(at_u);
    const __m256 in_v = at_v - _mm256_floor_ps(at_v);
    Wide3 probe = Bilinear(levels, texture.texels(), finer, in_u, in_v);
    if (is_mixed) {
      const Wide3 other =
          Bilinear(levels, texture.texels(), coarser, in_u, in_v);
      probe = Mix3(probe, other, share);
    }
    const __m256 is_wanted = _mm256_castsi256_ps(
        _mm256_cmpgt_epi32(probes.num, _mm256_set1_epi32(i)));
    sum.x = sum.x + _mm256_and_ps(is_wanted, probe.x);
    sum.y = sum.y + _mm256_and_ps(is_wanted, probe.y);
    sum.z = sum.z + _mm256_and_ps(is_wanted, probe.z);
  }
  constexpr float kUnit =
      1.0f / (TextureSampler::kFieldMask * TextureSampler::kFieldMask);
  const __m256 unit = probes.per_probe * Same(kUnit);
  return {Select(is_far, means.x, sum.x * unit),
          Select(is_far, means.y, sum.y * unit),
          Select(is_far, means.z, sum.z * unit)};
}

}  // namespace waymark
