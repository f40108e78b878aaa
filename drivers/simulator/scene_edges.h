// The lines of a scene that a camera sees, exactly where it sees them.
#pragma once

#include "drivers/simulator/mesh_edges.h"
#include "drivers/simulator/ray_caster.h"
#include "drivers/simulator/scene.h"
#include "estimation/camera/image_remap.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

struct SceneEdgesOptions {
  double min_crease_rad = 0.35;  // 20 degrees.
  // Edges are looked at every step_px; what hides an edge for less than that
  // may be missed. Ends of the visible stretches are found to offset_px, which
  // is also how far beside the edge the rays go that see what lies there.
  double step_px = 2.0;
  double offset_px = 0.02;
  double min_length_px = 1.0;  // Shorter stretches are left out.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// A stretch of an edge that is seen.
struct VisibleEdge {
  EdgeKind kind = EdgeKind::kCrease;
  std::int32_t mover = RayPacket::kStatic;
  Eigen::Vector3d a_W = Eigen::Vector3d::Zero();  // Its ends.
  Eigen::Vector3d b_W = Eigen::Vector3d::Zero();
  // Projections of points from a_W to b_W, no farther than step_px from each
  // other: of a camera without distortion they lie on a line.
  std::vector<Eigen::Vector2d> pixels;
};

// Seen is an edge where a ray close beside it meets one of its own faces, and
// one on the other side something else: another plane, another material, or
// nothing. Faces that meet without common corners (a wall on a floor that goes
// on) count as well; each then has an edge of its own there.
class SceneEdges {
 public:
  // Copies what it needs.
  explicit SceneEdges(const Scene& scene,
                      const SceneEdgesOptions& options = {});

  // `caster`: of the same scene. X_WP: of each mover. Pixels are within the
  // image. Some microseconds for each step.
  [[nodiscard]] std::vector<VisibleEdge> Find(
      const RayCaster& caster,
      const CameraView& view,
      const Eigen::Isometry3d& X_WC,
      std::span<const Eigen::Isometry3d> X_WP) const;

 private:
  friend class EdgeFinder;

  struct Face {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double offset = 0.0;
    std::uint32_t material = 0;
  };
  struct Mesh {
    std::vector<Face> faces;
    std::vector<MeshEdge> edges;
  };

  SceneEdgesOptions options_;
  std::vector<Mesh> meshes_;  // The static one, then the movers'.
};

}  // namespace waymark
