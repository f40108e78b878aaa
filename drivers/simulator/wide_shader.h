// Eight rays that meet one triangle, shaded at once (AVX2, FMA).
#pragma once

#include "drivers/simulator/camera_rays.h"
#include "drivers/simulator/light_map.h"
#include "drivers/simulator/ray_caster.h"
#include "drivers/simulator/simd.h"
#include "drivers/simulator/texture_sampler.h"

#include <cstdint>
#include <span>

namespace waymark {

struct Colours;
struct PlacedMover;
struct TriangleInView;

// Whether this machine can. If not, ShadeWide must not be called.
[[nodiscard]] bool HasWideShader();

// What of one triangle all its lanes share.
struct WideSurface {
  const TriangleInView* triangle = nullptr;
  const TextureSampler* texture = nullptr;
  // Null: `even_light` everywhere.
  const LightMap* light = nullptr;
  Float4 even_light{};
  std::span<const PlacedMover> movers;  // That shadow it.
  int max_probes = 1;
  float footprint_scale = 1.0f;
};

// Colours of the lanes in `lanes` (bit i: lane i), as the shader's scalar form
// has them but for roundings. Other colours stay as they are.
void ShadeWide(const RayPacket& rays,
               const CameraRays::Block& rays_C,
               const WideSurface& surface,
               std::uint32_t lanes,
               Colours* colours);

}  // namespace waymark
