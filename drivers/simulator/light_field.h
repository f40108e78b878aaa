// The light that arrives at points of a scene, shadows included.
#pragma once

#include "drivers/simulator/ray_caster.h"
#include "drivers/simulator/scene.h"
#include "drivers/simulator/simd.h"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace waymark {

struct LightFieldOptions {
  // Shadow rays to each lamp: their number along x and along y, 1 to 16. Half
  // of them where those see all of it, or nothing.
  int lamp_samples = 4;
  // Rays over the hemisphere: rings of eight, 1 to 64.
  int num_rings = 8;
  // Walls nearer than this keep ambient light away, in proportion, m.
  double ambient_radius = 1.5;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// All light is in the unit of radiosity in which images show it: linear BGR,
// 1 is what a white surface under the ambient light 1 shows.
class LightField {
 public:
  explicit LightField(const Scene& scene, const LightFieldOptions& options);

  // A set of lamps: bit i stands for the lamps i, i + 64, ...
  using LampSet = std::uint64_t;
  static constexpr LampSet kAllLamps = ~LampSet{0};

  // By the lamps, at p_W with unit normal n_W: exact where a lamp is seen
  // wholly; of lamps seen in part the share that shadow rays find. Lamps that
  // are not `among` the given ones are left out; those that give light are
  // added to `seen` where it is not null.
  [[nodiscard]] Float4 Direct(const Eigen::Vector3d& p_W,
                              const Eigen::Vector3d& n_W,
                              LampSet among = kAllLamps,
                              LampSet* seen = nullptr) const;

  // Light that a surface of the static mesh throws back at one of its points,
  // toward where the direction comes from.
  using Radiosity = std::function<Float4(std::uint32_t triangle,
                                         const Eigen::Vector3f& p_W,
                                         const Eigen::Vector3f& direction)>;
  struct Gathered {
    Float4 light{};
    // Share of the ambient light that arrives: 1 in the open, 1/2 in the
    // corner of two walls.
    float openness = 1.0f;
  };
  // By everything but the lamps, over the hemisphere about n_W. Where the
  // first eight rays meet nothing within the ambient radius, or `is_dark` and
  // little space (inside walls, which nobody sees), they are all.
  [[nodiscard]] Gathered Gather(const Eigen::Vector3d& p_W,
                                const Eigen::Vector3d& n_W,
                                bool is_dark,
                                const Radiosity& radiosity) const;

  // Whether something is between any two of up to four points.
  [[nodiscard]] bool AreApart(std::span<const Eigen::Vector3d> points_W) const;

  [[nodiscard]] std::size_t num_bytes() const { return caster_.num_bytes(); }

 private:
  [[nodiscard]] double VisibleShare(const SceneLamp& lamp,
                                    const Eigen::Vector3d& p_W,
                                    const Eigen::Vector3d& n_W) const;

  LightFieldOptions options_;
  RayCaster caster_;  // Without lamps.
  std::vector<SceneLamp> lamps_;
  Float4 ambient_{};
  // Cosine-weighted directions about z; each eight go all ways.
  std::vector<Eigen::Vector3f> directions_;
  std::vector<Eigen::Vector2d> lamp_places_;  // In sizes of the lamp.
};

// Two unit vectors that make a right-handed frame with a unit normal: level,
// and upward on walls; x and y on floors and ceilings.
void PlaneAxes(const Eigen::Vector3d& normal,
               Eigen::Vector3d* right,
               Eigen::Vector3d* up);

}  // namespace waymark
