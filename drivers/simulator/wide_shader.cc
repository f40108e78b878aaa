#include "drivers/simulator/wide_shader.h"

#include "drivers/simulator/surface_shader.h"
#include "estimation/base/check.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#if defined(__x86_64__)
#include <immintrin.h>

// With FMA: a twentieth of the time of a picture, other roundings.
#define WAYMARK_WIDE __attribute__((target("avx2,fma")))

namespace waymark {
namespace {

constexpr int kLanes = RayPacket::kLanes;

// Three numbers of each lane.
struct Wide3 {
  __m256 x;
  __m256 y;
  __m256 z;
};

WAYMARK_WIDE inline __m256 Same(float value) {
  return _mm256_set1_ps(value);
}

WAYMARK_WIDE inline Wide3 Load(const float (&from)[3][kLanes]) {
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

// Row `row` of the triangle's maps along a direction.
WAYMARK_WIDE inline __m256 Map(const TriangleInView& t,
                               int row,
                               const Wide3& d) {
  return Same(t.by_x[row]) * d.x + Same(t.by_y[row]) * d.y +
         Same(t.by_z[row]) * d.z;
}

// Lanes of `mask` (bit i: lane i) as all bits set.
WAYMARK_WIDE inline __m256i LaneMask(std::uint32_t mask) {
  const __m256i bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm256_cmpeq_epi32(
      _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(mask)), bits), bits);
}

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
WAYMARK_WIDE Wide3 Bilinear(const TextureSampler::Levels& levels,
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
WAYMARK_WIDE Probes ChooseProbes(const TextureSampler::Levels& levels,
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
WAYMARK_WIDE Wide3 SampleTexture(const TextureSampler& texture,
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

// The channels of four nodes in lanes.
struct Corners {
  Wide3 a;
  Wide3 b;
  Wide3 c;
  Wide3 d;
};

WAYMARK_WIDE inline Wide3 SameNode(const Float4& node) {
  const float* values = reinterpret_cast<const float*>(&node);
  return {_mm256_broadcast_ss(values),
          _mm256_broadcast_ss(values + 1),
          _mm256_broadcast_ss(values + 2)};
}

WAYMARK_WIDE inline Wide3 Select3(__m256 mask,
                                  const Wide3& yes,
                                  const Wide3& no) {
  return {Select(mask, yes.x, no.x),
          Select(mask, yes.y, no.y),
          Select(mask, yes.z, no.z)};
}

// Neighbouring pixels lie between the same nodes mostly: one place after the
// other is faster than a gather of 96 numbers.
WAYMARK_WIDE inline Corners LoadNodes(const Float4* nodes,
                                      __m256i node,
                                      __m256i stride,
                                      std::uint32_t lanes) {
  Corners corners;
  std::uint32_t left = lanes;
  do {
    const int first = std::countr_zero(left);
    const int index = Lane(node, first);
    const Float4* upper = nodes + index;
    const Float4* lower = upper + Lane(stride, first);
    const __m256 is_here =
        _mm256_castsi256_ps(_mm256_cmpeq_epi32(node, _mm256_set1_epi32(index)));
    const Corners here = {SameNode(upper[0]),
                          SameNode(upper[1]),
                          SameNode(lower[0]),
                          SameNode(lower[1])};
    if (left == lanes) {
      corners = here;
    } else {
      corners.a = Select3(is_here, here.a, corners.a);
      corners.b = Select3(is_here, here.b, corners.b);
      corners.c = Select3(is_here, here.c, corners.c);
      corners.d = Select3(is_here, here.d, corners.d);
    }
    left &= ~static_cast<std::uint32_t>(_mm256_movemask_ps(is_here));
  } while (left != 0);
  return corners;
}

// As LightMap::At; `side` is one for all lanes.
WAYMARK_WIDE Wide3 SampleLight(const LightMap& light,
                               const LightMap::Patch& patch,
                               int side,
                               __m256 x,
                               __m256 y,
                               std::uint32_t lanes) {
  const __m256i one = _mm256_set1_epi32(1);
  // In this order NaN becomes 0.
  x = _mm256_min_ps(_mm256_max_ps(x, Same(0.0f)),
                    Same(static_cast<float>(patch.width)));
  y = _mm256_min_ps(_mm256_max_ps(y, Same(0.0f)),
                    Same(static_cast<float>(patch.height)));
  const __m256i column = _mm256_min_epi32(_mm256_cvttps_epi32(x),
                                          _mm256_set1_epi32(patch.width - 1));
  const __m256i row = _mm256_min_epi32(_mm256_cvttps_epi32(y),
                                       _mm256_set1_epi32(patch.height - 1));
  x = x - _mm256_cvtepi32_ps(column);
  y = y - _mm256_cvtepi32_ps(row);
  const __m256i index = _mm256_add_epi32(
      _mm256_mullo_epi32(row, _mm256_set1_epi32(patch.width)), column);
  const std::uint32_t* cells = light.cells() + patch.first_cell[side];
  const int first = Lane(index, std::countr_zero(lanes));
  const int is_same = _mm256_movemask_ps(
      _mm256_castsi256_ps(_mm256_cmpeq_epi32(index, _mm256_set1_epi32(first))));
  const __m256i cell = (lanes & ~static_cast<std::uint32_t>(is_same)) == 0
                           ? _mm256_set1_epi32(static_cast<int>(cells[first]))
                           : _mm256_i32gather_epi32(
                                 reinterpret_cast<const int*>(cells), index, 4);
  __m256i node = _mm256_and_si256(
      cell, _mm256_set1_epi32((1 << LightMap::kIndexBits) - 1));
  const __m256i steps =
      _mm256_sllv_epi32(one, _mm256_srli_epi32(cell, LightMap::kIndexBits));
  x = x * _mm256_cvtepi32_ps(steps);
  y = y * _mm256_cvtepi32_ps(steps);
  const __m256i most = _mm256_sub_epi32(steps, one);
  const __m256i i = _mm256_min_epi32(_mm256_cvttps_epi32(x), most);
  const __m256i j = _mm256_min_epi32(_mm256_cvttps_epi32(y), most);
  const __m256i stride = _mm256_add_epi32(steps, one);
  node = _mm256_add_epi32(node,
                          _mm256_add_epi32(_mm256_mullo_epi32(j, stride), i));
  const __m256 fx = x - _mm256_cvtepi32_ps(i);
  const __m256 fy = y - _mm256_cvtepi32_ps(j);
  const Corners at = LoadNodes(light.nodes(), node, stride, lanes);
  return Mix3(Mix3(at.a, at.b, fx), Mix3(at.c, at.d, fx), fy);
}

// As the shader's ShadowOf.
WAYMARK_WIDE __m256 LightLeft(const PlacedMover& mover,
                              const Wide3& p,
                              const Wide3& facing) {
  const float reach = mover.radius + SurfaceShader::kShadowReach;
  const __m256 x = Same(mover.p_WP.x()) - p.x;
  const __m256 y = Same(mover.p_WP.y()) - p.y;
  const __m256 z = Same(mover.p_WP.z()) - p.z;
  const __m256 flat = x * x + y * y;
  const __m256 nearness = Same(1.0f) - flat * Same(1.0f / (reach * reach));
  const __m256 is_near = _mm256_cmp_ps(nearness, Same(0.0f), _CMP_GT_OQ);
  __m256 left = Same(1.0f);
  if (_mm256_movemask_ps(is_near) == 0) return left;
  const __m256 square_radius = Same(mover.radius * mover.radius);
  const __m256 level = facing.x * x + facing.y * y;
  for (int i = 0; i < SurfaceShader::kShadowSpheres; ++i) {
    const __m256 up = z + Same(SurfaceShader::SphereHeight(mover, i));
    const __m256 square = flat + up * up;
    const __m256 along = _mm256_max_ps(level + facing.z * up, Same(0.0f));
    const __m256 per_distance = Same(1.0f) / _mm256_sqrt_ps(square);
    const __m256 share =
        _mm256_min_ps(square_radius * per_distance * per_distance, Same(1.0f));
    left = left * (Same(1.0f) - along * per_distance * share);
  }
  const __m256 weight = _mm256_and_ps(is_near, nearness * nearness);
  return Same(1.0f) - (Same(1.0f) - left) * weight;
}

}  // namespace

bool HasWideShader() {
  return __builtin_cpu_supports("avx2") != 0 &&
         __builtin_cpu_supports("fma") != 0;
}

WAYMARK_WIDE void ShadeWide(const RayPacket& rays,
                            const CameraRays::Block& rays_C,
                            const WideSurface& surface,
                            std::uint32_t lanes,
                            Colours* colours) {
  const TriangleInView& t = *surface.triangle;
  const Wide3 direction = Load(rays_C.direction);
  const Wide3 normal = {
      Same(t.normal[0]), Same(t.normal[1]), Same(t.normal[2])};
  const __m256 per_slope = Same(1.0f) / Dot(normal, direction);
  const __m256 distance = Same(t.height) * per_slope;
  const __m256 scale = distance * Same(surface.footprint_scale);
  const __m256 u = Map(t, 0, direction);
  const __m256 v = Map(t, 1, direction);
  Wide3 colour;
  if (surface.texture->levels().num == 1) {
    const Float4 mean = surface.texture->mean();
    colour = {Same(mean[0]), Same(mean[1]), Same(mean[2])};
  } else {
    // The neighbour's ray meets the same plane.
    const Wide3 d_x = Load(rays_C.d_x);
    const Wide3 d_y = Load(rays_C.d_y);
    const __m256 slope_x = Dot(normal, d_x) * per_slope;
    const __m256 slope_y = Dot(normal, d_y) * per_slope;
    colour = SampleTexture(*surface.texture,
                           Same(t.constant[0]) + distance * u,
                           Same(t.constant[1]) + distance * v,
                           {scale * (Map(t, 0, d_x) - u * slope_x),
                            scale * (Map(t, 1, d_x) - v * slope_x),
                            scale * (Map(t, 0, d_y) - u * slope_y),
                            scale * (Map(t, 1, d_y) - v * slope_y)},
                           surface.max_probes);
  }
  Wide3 light = {Same(surface.even_light[0]),
                 Same(surface.even_light[1]),
                 Same(surface.even_light[2])};
  if (surface.light != nullptr) {
    light = SampleLight(*surface.light,
                        t.triangle->light,
                        t.light_side,
                        Same(t.constant[2]) + distance * Map(t, 2, direction),
                        Same(t.constant[3]) + distance * Map(t, 3, direction),
                        lanes);
  }
  if (!surface.movers.empty()) {
    const Wide3 origin = Load(rays.origin);
    const Wide3 direction_W = Load(rays.direction);
    const Wide3 p_W = {origin.x + distance * direction_W.x,
                       origin.y + distance * direction_W.y,
                       origin.z + distance * direction_W.z};
    const Wide3 facing_W = {
        Same(t.facing_W[0]), Same(t.facing_W[1]), Same(t.facing_W[2])};
    for (const PlacedMover& mover : surface.movers) {
      const __m256 left = LightLeft(mover, p_W, facing_W);
      light = {light.x * left, light.y * left, light.z * left};
    }
  }
  const __m256i mask = LaneMask(lanes);
  _mm256_maskstore_ps(colours->bgr[0], mask, colour.x * light.x);
  _mm256_maskstore_ps(colours->bgr[1], mask, colour.y * light.y);
  _mm256_maskstore_ps(colours->bgr[2], mask, colour.z * light.z);
}

}  // namespace waymark

#else

namespace waymark {

bool HasWideShader() {
  return false;
}

void ShadeWide(const RayPacket& /*rays*/,
               const CameraRays::Block& /*rays_C*/,
               const WideSurface& /*surface*/,
               std::uint32_t /*lanes*/,
               Colours* /*colours*/) {
  WAYMARK_CHECK(false, "ShadeWide without AVX2");
}

}  // namespace waymark

#endif
