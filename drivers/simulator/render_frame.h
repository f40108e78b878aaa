// One call of Renderer::Render.
#pragma once

#include "drivers/simulator/camera_rays.h"
#include "drivers/simulator/mover_tiles.h"
#include "drivers/simulator/ray_caster.h"
#include "drivers/simulator/renderer.h"
#include "drivers/simulator/sample_pattern.h"
#include "drivers/simulator/srgb.h"
#include "drivers/simulator/surface_shader.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

// Threads share it, and call its functions for a row each. What these need for
// each ray is defined beside them, to be inlined.
class RenderFrame {
 public:
  // All arguments outlive this. Fills what of `out` is not empty.
  RenderFrame(const RayCaster& caster,
              const SurfaceShader& shader,
              const SrgbTable& srgb,
              const CameraRays& camera,
              const Eigen::Isometry3d& X_WC,
              std::span<const Eigen::Isometry3d> X_WP,
              const MoverTiles& mover_tiles,
              RenderedView* out);

  // Before TraceCentres: SupersampleEdges will ask for edges.
  void KeepHits();
  // Centres of two rows of pixels: what was asked for of their geometry; their
  // colours too if `has_colour`.
  void TraceCentres(int block_row, bool has_colour);
  // Mean of the samples (kStillPattern) of each pixel of a row that has a ray.
  void SupersampleRow(int y) const;
  // The same of those pixels of a row at an edge (kLivePattern); two at a time.
  // After all of TraceCentres.
  void SupersampleEdges(int y) const;

 private:
  static constexpr int kLanes = RayPacket::kLanes;
  static_assert(kLanes == CameraRays::kLanes);
  // Of pixels outside the camera's domain; where nothing is met.
  static constexpr std::uint32_t kNoRay = 0xFFFFFFFE;
  static constexpr std::uint32_t kNothing = RayPacket::kNothing;

  // Eight rays that are not those of a block of pixels.
  struct Samples {
    RayPacket rays;
    CameraRays::Block rays_C;
  };

  [[nodiscard]] const CameraRays::Block& BlockOf(int x, int y) const {
    return camera_.block(y / CameraRays::kBlockHeight,
                         x / CameraRays::kBlockWidth);
  }
  [[nodiscard]] bool HasMovers(int x, int y) const {
    return has_movers_[camera_.TileOf(x, y)] != 0;
  }
  [[nodiscard]] std::size_t HitIndex(int x, int y) const {
    return static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x);
  }
  // R_WC times eight vectors.
  void Turn(const float (&from)[3][kLanes], float (&to)[3][kLanes]) const;
  void Trace(const CameraRays::Block& block,
             int x,
             int y,
             RayPacket* rays) const;
  [[nodiscard]] std::uint32_t IdOf(const RayPacket& rays, int lane) const;
  // What was asked for of the geometry.
  void Store(int x, int y, RayPacket* rays);
  void StoreHits(int x, int y, const RayPacket& rays);
  void StoreDepth(int x, int y, RayPacket* rays) const;
  void StoreSurface(int x, int y, const RayPacket& rays) const;
  void StoreColours(int x,
                    int y,
                    std::uint32_t lanes,
                    const Colours& colours) const;
  void StoreMean(int x, int y, int num, const Float4& sum) const;
  // Four samples of a pixel become one half of eight.
  template <std::size_t kNum>
  void SetSamples(int x,
                  int y,
                  const SamplePattern<kNum>& pattern,
                  std::size_t group,
                  int half,
                  Samples* samples) const;
  [[nodiscard]] Colours Sample(bool has_movers,
                               std::uint32_t lanes,
                               float footprint_scale,
                               Samples* samples,
                               TrianglesInView* triangles) const;
  // Whether a pixel and one of its four neighbours see different surfaces.
  [[nodiscard]] bool IsEdge(int x, int y) const;
  // Of two pixels with different triangles: whether they go on from each
  // other smoothly.
  [[nodiscard]] bool AreOneSurface(std::size_t a, std::size_t b) const;

  const RayCaster& caster_;
  const SurfaceShader& shader_;
  const SrgbTable& srgb_;
  const CameraRays& camera_;
  int width_;
  int height_;
  Eigen::Matrix3f R_WC_;
  Eigen::Vector3d p_WC_;
  RayCaster::Placement placement_;
  ShaderView view_;
  std::vector<std::uint8_t> has_movers_;  // By tile of the camera.
  RenderedView& out_;
  // What the centres of pixels see, in rows of `stride_`.
  std::size_t stride_ = 0;
  std::vector<std::uint32_t> ids_;  // Of triangles.
  std::vector<float> distances_;
};

}  // namespace waymark
