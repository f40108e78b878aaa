// Colour and distance of what a ray meets.
#pragma once

#include "drivers/simulator/camera_rays.h"
#include "drivers/simulator/light_field.h"
#include "drivers/simulator/light_map.h"
#include "drivers/simulator/ray_caster.h"
#include "drivers/simulator/scene.h"
#include "drivers/simulator/simd.h"
#include "drivers/simulator/texture_sampler.h"
#include "drivers/simulator/wide_shader.h"

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

// Linear BGR of eight rays.
struct Colours {
  alignas(32) float bgr[3][RayPacket::kLanes];
};

// A triangle as the shader wants it. Affine in the point are: u, v in
// repetitions of the texture, x, y in cells of the light map.
struct alignas(64) ShadedTriangle {
  Float4 by_x{};
  Float4 by_y{};
  Float4 by_z{};
  Float4 constant{};
  double normal[3]{};
  double offset = 0.0;  // normal . point of the plane.
  std::uint32_t material = 0;
  std::uint32_t surface = 0;
  LightMap::Patch light;
  std::int32_t mover = RayPacket::kStatic;  // Whose mesh it belongs to.
  bool is_light_map_turned = false;         // Its front is our back.
};

// What the shader needs of the place of a mover.
struct PlacedMover {
  Eigen::Isometry3d X_PC = Eigen::Isometry3d::Identity();
  Eigen::Matrix3f R_WP = Eigen::Matrix3f::Identity();
  Eigen::Vector3f p_WP = Eigen::Vector3f::Zero();
  float radius = 0.0f;
  float height = 0.0f;
  // That arrives there on surfaces facing +x, -x, +y, -y, +z, -z of W.
  std::array<Float4, 6> light{};
};

// One camera at one place, and where the movers are.
struct ShaderView {
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  std::vector<PlacedMover> movers;
};

// A triangle for rays that start at the camera, in the camera's frame. The ray
// along d meets it at height / (normal . d) lengths of d; there a map's value
// is constant + that distance * (by_x, by_y, by_z) . d. Rays from one point
// meet a plane from one side.
struct alignas(64) TriangleInView {
  Float4 by_x{};
  Float4 by_y{};
  Float4 by_z{};
  Float4 constant{};
  float normal[3]{};
  float height = 0.0f;
  const ShadedTriangle* triangle = nullptr;
  int light_side = 0;    // Of the light map.
  float facing_W[3]{};   // The normal on the side that is seen.
  Float4 mover_light{};  // That arrives there, of a mover's triangle.
  bool is_mover = false;
};

// The triangles that a thread met last in one view.
class TrianglesInView {
 public:
  explicit TrianglesInView(const ShaderView& view) : view_(view) {}
  [[nodiscard]] const ShaderView& view() const { return view_; }
  [[nodiscard]] const TriangleInView& Get(const ShadedTriangle& triangle);

 private:
  // A picture's rows meet some triangles again and again.
  static constexpr std::size_t kSize = 32;
  const ShaderView& view_;
  std::array<TriangleInView, kSize> entries_;
};

struct SurfaceShaderOptions {
  LightFieldOptions light;
  LightMapOptions light_map;
  // Eight pixels at once where the machine has AVX2 and FMA. Without: twice as
  // slow, the same but for roundings.
  bool is_wide = true;
};

// Textures and light of a scene. Static surfaces are lit by the light map.
// Movers are lit by what arrives about the middle of them, and darken the
// static surfaces within kShadowReach, as upright capsules would under light
// from all sides: the shadow at their feet.
class SurfaceShader {
 public:
  static constexpr float kShadowReach = 1.2f;  // m from their outside.
  // A capsule is spheres along its axis, this high.
  static constexpr int kShadowSpheres = 4;
  static float SphereHeight(const PlacedMover& mover, int i) {
    const float free = mover.height - 2.0f * mover.radius;
    return mover.radius + (free > 0.0f ? free : 0.0f) * static_cast<float>(i) /
                              (kShadowSpheres - 1);
  }

  // Computes the light map, which takes most of the time.
  SurfaceShader(const Scene& scene,
                const SurfaceShaderOptions& options,
                int num_threads);

  // Where the movers are and how they are lit, for rays that start at the
  // camera.
  [[nodiscard]] ShaderView Place(std::span<const Eigen::Isometry3d> X_WP,
                                 const Eigen::Isometry3d& X_WC) const;

  // Distances of traced rays once more, from the triangles' planes in double
  // precision: Embree's float arithmetic loses digits on large triangles seen
  // at flat angles. Rays start at p_WC.
  void RefineDistances(const Eigen::Vector3d& p_WC, RayPacket* rays) const;

  // Of each active lane; black where nothing was met.
  //   rays_C   the same rays, from the camera's origin, and their neighbours'.
  // `footprint_scale`: 1 for one sample a pixel, 1/4 for samples at a quarter
  // of a pixel from each other.
  void Shade(const RayPacket& rays,
             const CameraRays::Block& rays_C,
             float footprint_scale,
             TrianglesInView* triangles,
             Colours* colours) const;

  // One number for each triangle of the static mesh and the movers.
  [[nodiscard]] std::uint32_t TriangleId(std::int32_t mover,
                                         std::uint32_t index) const {
    return first_triangle_[static_cast<std::size_t>(mover + 1)] + index;
  }
  [[nodiscard]] const ShadedTriangle& triangle(std::uint32_t id) const {
    return triangles_[id];
  }
  [[nodiscard]] const std::vector<SceneSurface>& surfaces() const {
    return surfaces_;
  }
  [[nodiscard]] std::size_t num_bytes() const;

 private:
  struct MoverSize {
    float radius = 0.0f;
    float height = 0.0f;
  };
  [[nodiscard]] Float4 LightAt(const Eigen::Vector3d& p_W,
                               const Eigen::Vector3d& n_W) const;
  // Lanes of one triangle.
  void ShadeTogether(const RayPacket& rays,
                     const CameraRays::Block& rays_C,
                     const TriangleInView& triangle,
                     std::uint32_t lanes,
                     const ShaderView& view,
                     float footprint_scale,
                     Colours* colours) const;
  [[nodiscard]] Float4 ShadeLane(const RayPacket& rays,
                                 const CameraRays::Block& rays_C,
                                 int lane,
                                 const TriangleInView& triangle,
                                 const ShaderView& view,
                                 float footprint_scale) const;

  bool is_wide_;
  std::vector<SceneSurface> surfaces_;
  std::vector<MoverSize> mover_sizes_;
  std::vector<TextureSampler> textures_;
  std::vector<char> is_emissive_;
  std::vector<Float4> albedos_;  // Mean of each texture.
  LightField field_;
  LightMap light_map_;
  // Those of the static mesh, then those of each mover.
  std::vector<ShadedTriangle> triangles_;
  std::vector<std::uint32_t> first_triangle_;  // Static, then by mover.
};

}  // namespace waymark
