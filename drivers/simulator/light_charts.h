// Flat pieces of a scene's surface with a grid of cells on each.
#pragma once

#include "drivers/simulator/scene.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

// Triangles of one plane that hang together, and a grid over them. Grids of a
// plane have their lines at the same places wherever the triangles begin, so
// that the light across the border of two charts is the same.
struct LightChart {
  Eigen::Vector3d normal;  // Unit; its larger horizontal part is positive.
  Eigen::Vector3d right;   // Unit axes of the plane.
  Eigen::Vector3d up;
  double offset = 0.0;        // normal . p of the plane.
  Eigen::Vector2d origin;     // Of the grid, along right and up, m.
  Eigen::Vector2d cell_size;  // m.
  int width = 0;              // Cells.
  int height = 0;
  std::vector<std::uint32_t> triangles;  // Of the mesh.
  // Entries of `touching` from first[i] to first[i + 1]: the triangles that
  // cell i = x + width y touches. None: the cell is not part of the surface.
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> touching;

  [[nodiscard]] std::span<const std::uint32_t> CellTriangles(int x,
                                                             int y) const;
  // A point of the plane, by its place in the grid (in cells).
  [[nodiscard]] Eigen::Vector3d Point(const Eigen::Vector2d& place) const;
  // The place in the grid of a point.
  [[nodiscard]] Eigen::Vector2d Place(const Eigen::Vector3d& p_W) const;
};

// Charts for all triangles with an area and a material that is not emissive,
// with cells of `cell_size` m, or larger so that there are no more than
// `max_cells` in all. A piece smaller than a cell has one cell of its own
// size.
[[nodiscard]] std::vector<LightChart> BuildLightCharts(const Scene& scene,
                                                       double cell_size,
                                                       std::size_t max_cells);

// The point of the triangles nearest to `p_W` (of their plane): `p_W` itself
// inside them; otherwise on their border, and then a little inward.
[[nodiscard]] Eigen::Vector3d NearestInside(
    const SceneMesh& mesh,
    std::span<const std::uint32_t> triangles,
    const Eigen::Vector3d& p_W);

}  // namespace waymark
