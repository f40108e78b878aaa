// Edges of a mesh that can be seen as lines.
#pragma once

#include "drivers/simulator/scene.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace waymark {

enum class EdgeKind : std::uint8_t {
  kCrease,    // Two faces meet at an angle.
  kBoundary,  // A face ends.
  kMaterial,  // Of two materials in one plane.
  kSmooth,    // Of a curved surface: a line only where it is the outline.
};

struct MeshEdge {
  EdgeKind kind = EdgeKind::kCrease;
  Eigen::Vector3d a;
  Eigen::Vector3d b;
  std::vector<std::uint32_t> triangles;  // That end there; one or more.
  // Unit vectors in each of them, at right angles away from the edge.
  std::vector<Eigen::Vector3d> inward;
};

// Triangles meet where their corners lie within 0.1 mm; they need not share
// vertices. Edges within one plane and material are left out. `min_crease_rad`:
// the least angle between the faces of a crease. Order: of the triangles.
[[nodiscard]] std::vector<MeshEdge> FindMeshEdges(const SceneMesh& mesh,
                                                  double min_crease_rad);

}  // namespace waymark
