// What a ray meets first: the one door to Embree.
#pragma once

#include "drivers/simulator/scene.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

namespace waymark {

// Eight rays, and what they meet: as Embree lays them out, so that nothing is
// copied. Made once, used for many packets.
struct alignas(32) RayPacket {
  static constexpr int kLanes = 8;
  static constexpr std::uint32_t kAllLanes = 0xFF;
  static constexpr std::uint32_t kNothing = 0xFFFFFFFF;
  static constexpr std::int32_t kStatic = -1;

  // In: the ray from `nearest` on (in lengths of the direction).
  float origin[3][kLanes];
  float nearest[kLanes];
  float direction[3][kLanes];
  float unused_time[kLanes]{};
  // Out, where something was met: where (in lengths of the direction).
  float distance[kLanes];
  std::uint32_t unused_mask[kLanes] = {~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u};
  std::uint32_t unused_flags[2][kLanes]{};
  float unused_out[5][kLanes];
  // Out: index in the mesh's triangles; kNothing where nothing was met and in
  // lanes that are not active.
  std::uint32_t triangle[kLanes];
  std::uint32_t unused_geometry[kLanes];
  // Out, where something was met: whose: kStatic or the index of a mover.
  std::int32_t mover[kLanes];

  // In.
  float farthest[kLanes];            // The end (in lengths of the direction).
  std::uint32_t active = kAllLanes;  // Bit i: lane i is traced.
  bool is_coherent = true;           // The rays start and go about alike.
};

// Triangles of a scene in Embree's hierarchy, built with high quality and
// watertight at common edges (its robust mode). A ray meets triangles from
// both sides. Lanes do not influence each other; many threads may trace.
class RayCaster {
 public:
  enum class Content {
    kAll,
    kOccluders,  // Without triangles of lamps, and without movers.
  };

  // The scene is copied. Throws std::runtime_error where Embree cannot be set
  // up.
  explicit RayCaster(const Scene& scene, Content content = Content::kAll);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  // Movers at given places. Cheap to make (some microseconds each).
  class Placement {
   public:
    ~Placement();
    Placement(Placement&&) noexcept;
    Placement& operator=(Placement&&) noexcept;

   private:
    friend class RayCaster;
    struct State;
    explicit Placement(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
  };

  // X_WP of each mover in the scene's order; their number must be that of the
  // movers (WAYMARK_CHECK).
  [[nodiscard]] Placement Place(std::span<const Eigen::Isometry3d> X_WP) const;

  // The nearest triangle of the static mesh and, if given, of the movers.
  void Trace(RayPacket* packet, const Placement* placement = nullptr) const;

  // The static mesh only: lanes that meet anything.
  [[nodiscard]] std::uint32_t Occluded(const RayPacket& packet) const;

  // That Embree holds, hierarchies included.
  [[nodiscard]] std::size_t num_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// All eight rays start at `origin`, from 0 on without an end.
void SetOrigin(const Eigen::Vector3f& origin, RayPacket* packet);

}  // namespace waymark
