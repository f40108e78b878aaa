// Colour and distance of what a ray meets.
#pragma once

#include "drivers/simulator/ray_caster.h"
#include "drivers/simulator/scene.h"
#include "drivers/simulator/simd.h"
#include "drivers/simulator/texture_sampler.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

// Eight rays from one point with their changes to the next pixels.
struct RayFan {
  RayPacket rays;
  alignas(32) float d_x[3][RayPacket::kLanes];
  alignas(32) float d_y[3][RayPacket::kLanes];
};

// A triangle as the shader wants it. Rows of `maps` are affine in the point:
// u, v in repetitions of the texture.
struct alignas(64) ShadedTriangle {
  Float4 by_x{};
  Float4 by_y{};
  Float4 by_z{};
  Float4 constant{};
  double normal[3]{};
  double offset = 0.0;  // normal . point of the plane.
  std::uint32_t material = 0;
  std::uint32_t surface = 0;
};

// What the shader needs of the place of a mover.
struct PlacedMover {
  Eigen::Matrix3f R_PW = Eigen::Matrix3f::Identity();
  Eigen::Vector3f p_PC = Eigen::Vector3f::Zero();
  Eigen::Isometry3d X_WP = Eigen::Isometry3d::Identity();
};

class SurfaceShader {
 public:
  explicit SurfaceShader(const Scene& scene);

  // Where the movers are, for rays that start at p_WC.
  [[nodiscard]] std::vector<PlacedMover> Place(
      std::span<const Eigen::Isometry3d> X_WP,
      const Eigen::Vector3d& p_WC) const;

  // Distances of traced rays once more, from the triangles' planes in double
  // precision: Embree's float arithmetic loses digits on large triangles seen
  // at flat angles. Rays start at p_WC.
  void RefineDistances(const Eigen::Vector3d& p_WC, RayPacket* rays) const;

  // Linear BGR of each active lane; black where nothing was met.
  // `footprint_scale`: 1 for one sample a pixel, 1/4 for samples at a quarter
  // of a pixel from each other.
  void Shade(const RayFan& fan,
             std::span<const PlacedMover> movers,
             float footprint_scale,
             Float4* colours) const;

  [[nodiscard]] const ShadedTriangle& triangle(std::int32_t mover,
                                               std::uint32_t index) const {
    return triangles_[static_cast<std::size_t>(mover + 1)][index];
  }
  [[nodiscard]] const std::vector<SceneSurface>& surfaces() const {
    return surfaces_;
  }
  [[nodiscard]] std::size_t num_bytes() const;

 private:
  // Entry 0: the static mesh, then the movers.
  std::vector<std::vector<ShadedTriangle>> triangles_;
  std::vector<TextureSampler> textures_;
  std::vector<char> is_emissive_;
  std::vector<SceneSurface> surfaces_;
  std::vector<SceneLamp> lamps_;
  Eigen::Vector3d ambient_;
};

}  // namespace waymark
