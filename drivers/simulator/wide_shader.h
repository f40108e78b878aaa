// Eight rays that meet one triangle, shaded at once (AVX2).
#pragma once

#include "drivers/simulator/light_map.h"
#include "drivers/simulator/simd.h"
#include "drivers/simulator/texture_sampler.h"

#include <cstdint>
#include <span>

namespace waymark {

struct RayFan;
struct ShadedTriangle;
struct PlacedMover;

// Whether this machine can. If not, ShadeWide must not be called.
[[nodiscard]] bool HasWideShader();

// What of one triangle all its lanes share.
struct WideSurface {
  const ShadedTriangle* triangle = nullptr;
  const TextureSampler* texture = nullptr;
  const LightMap* light = nullptr;  // Null: the texture has its own light.
  // That shadow it; none where `light` is null.
  std::span<const PlacedMover> movers;
  int max_probes = 1;
  float footprint_scale = 1.0f;
};

// Colours of the lanes in `lanes` (bit i: lane i), as the shader's scalar form
// has them but for roundings. Other colours stay as they are.
void ShadeWide(const RayFan& fan,
               const WideSurface& surface,
               std::uint32_t lanes,
               Float4* colours);

}  // namespace waymark
