#include "drivers/simulator/mesh_edges.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace waymark {
namespace {

using Eigen::Vector3d;

using Cell = std::array<std::int64_t, 3>;

// Numbers of places: corners within one cell of 0.1 mm are one place.
std::vector<std::uint32_t> WeldedPlaces(const SceneMesh& mesh) {
  constexpr double kCellsPerMetre = 1e4;
  // Farther than 1e9 m there are no tenths of a millimetre.
  constexpr double kFarthest = 1e9;
  std::map<Cell, std::uint32_t> numbers;
  std::vector<std::uint32_t> places;
  for (const Eigen::Vector3f& p : mesh.positions) {
    Cell cell{};
    for (int i = 0; i < 3; ++i) {
      cell[static_cast<std::size_t>(i)] = std::llround(
          std::clamp(double(p[i]), -kFarthest, kFarthest) * kCellsPerMetre);
    }
    const auto next = static_cast<std::uint32_t>(numbers.size());
    places.push_back(numbers.emplace(cell, next).first->second);
  }
  return places;
}

std::optional<Vector3d> NormalOf(const SceneMesh& mesh,
                                 const SceneTriangle& triangle) {
  const Vector3d a = mesh.positions[triangle.vertices[0]].cast<double>();
  const Vector3d b = mesh.positions[triangle.vertices[1]].cast<double>();
  const Vector3d c = mesh.positions[triangle.vertices[2]].cast<double>();
  const Vector3d normal = (b - a).cross(c - a).stableNormalized();
  if (!(normal.squaredNorm() > 0.0)) return std::nullopt;
  return normal;
}

// The corner of a triangle that is not on its edge number `i`.
Vector3d Apex(const SceneMesh& mesh, std::uint32_t triangle, std::size_t i) {
  return mesh.positions[mesh.triangles[triangle].vertices[(i + 2) % 3]]
      .cast<double>();
}

struct Wing {
  std::uint32_t triangle = 0;
  std::size_t edge = 0;
};

// In the triangle, at right angles away from its edge from a to b.
Vector3d Inward(const SceneMesh& mesh,
                const Wing& wing,
                const Vector3d& a,
                const Vector3d& b) {
  const Vector3d along = (b - a).normalized();
  const Vector3d to_apex = Apex(mesh, wing.triangle, wing.edge) - a;
  return (to_apex - along.dot(to_apex) * along).normalized();
}

std::optional<EdgeKind> KindOf(const SceneMesh& mesh,
                               const MeshEdge& edge,
                               double min_crease_rad) {
  if (edge.triangles.size() == 1) return EdgeKind::kBoundary;
  if (edge.triangles.size() > 2) return EdgeKind::kCrease;
  // 0 where the one triangle goes on flat into the other, pi where it folds
  // back.
  const double turn =
      std::acos(std::clamp(-edge.inward[0].dot(edge.inward[1]), -1.0, 1.0));
  if (turn >= min_crease_rad) return EdgeKind::kCrease;
  if (mesh.triangles[edge.triangles[0]].material !=
      mesh.triangles[edge.triangles[1]].material) {
    return EdgeKind::kMaterial;
  }
  // Below it floats cannot tell a curved surface from a flat one.
  constexpr double kFlat = 1e-3;
  if (turn < kFlat) return std::nullopt;
  return EdgeKind::kSmooth;
}

}  // namespace

std::vector<MeshEdge> FindMeshEdges(const SceneMesh& mesh,
                                    double min_crease_rad) {
  const std::vector<std::uint32_t> places = WeldedPlaces(mesh);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> numbers;
  std::vector<std::vector<Wing>> wings;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const SceneTriangle& triangle = mesh.triangles[t];
    if (!NormalOf(mesh, triangle)) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = places[triangle.vertices[i]];
      const std::uint32_t b = places[triangle.vertices[(i + 1) % 3]];
      if (a == b) continue;
      const auto [entry, is_new] =
          numbers.emplace(std::minmax(a, b), wings.size());
      if (is_new) wings.emplace_back();
      wings[entry->second].push_back({t, i});
    }
  }
  std::vector<MeshEdge> edges;
  for (const std::vector<Wing>& around : wings) {
    const auto& vertices = mesh.triangles[around[0].triangle].vertices;
    const Vector3d a = mesh.positions[vertices[around[0].edge]].cast<double>();
    const Vector3d b =
        mesh.positions[vertices[(around[0].edge + 1) % 3]].cast<double>();
    MeshEdge edge{EdgeKind::kCrease, a, b, {}, {}};
    for (const Wing& wing : around) {
      edge.triangles.push_back(wing.triangle);
      edge.inward.push_back(Inward(mesh, wing, a, b));
    }
    const auto kind = KindOf(mesh, edge, min_crease_rad);
    if (!kind) continue;
    edge.kind = *kind;
    edges.push_back(std::move(edge));
  }
  return edges;
}

}  // namespace waymark
