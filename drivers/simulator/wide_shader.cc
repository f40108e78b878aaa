#include "drivers/simulator/wide_shader.h"

#include "drivers/simulator/surface_shader.h"
#include "estimation/base/check.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#if defined(__x86_64__)
#include "drivers/simulator/wide_texture.h"
#include "drivers/simulator/wide_vector.h"

namespace waymark {
namespace {

constexpr int kLanes = RayPacket::kLanes;

// Row `row` of the triangle's maps along a direction.
WAYMARK_WIDE inline __m256 Map(const TriangleInView& t,
                               int row,
                               const Wide3& d) {
  return Same(t.by_x[row]) * d.x + Same(t.by_y[row]) * d.y +
         Same(t.by_z[row]) * d.z;
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
