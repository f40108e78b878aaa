// The light on all surfaces of a scene, computed once.
#pragma once

#include "drivers/simulator/light_charts.h"
#include "drivers/simulator/light_field.h"
#include "drivers/simulator/scene.h"
#include "drivers/simulator/simd.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

struct LightMapOptions {
  // Of the cells at whose corners light is computed, m; eight times finer
  // where something stands between the corners, four times where the light
  // changes fast, twice along shaded borders.
  double cell_size = 0.2;
  // Bound of memory: cells become larger rather than more. A cell costs 128
  // bytes, a finer one up to 2.6 kB.
  std::size_t max_cells = 200'000;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Direct light with soft shadows, ambient light as far as walls let it through,
// and what other surfaces throw back of the direct light, once. Both sides of
// every triangle of the static mesh.
//
// Between the corners of cells light is interpolated linearly, without a seam
// from cell to cell. Where a wall stands on a floor that goes on behind it,
// light leaks through for 1/8 of a cell at most. The same scene gives the same
// light for any number of threads.
class LightMap {
 public:
  // Where the light of a triangle is found.
  struct Patch {
    std::uint32_t first_cell[2] = {0, 0};  // Of the front and of the back.
    std::int32_t width = 0;                // 0: a triangle without a map.
    std::int32_t height = 0;
  };

  // `albedos`: mean linear reflectance of each material (of emissive ones:
  // what they emit).
  LightMap(const Scene& scene,
           const LightField& field,
           std::span<const Float4> albedos,
           const LightMapOptions& options,
           int num_threads);

  // By triangle of the static mesh; nullptr for one without a map.
  [[nodiscard]] const LightChart* chart(std::uint32_t triangle) const {
    const std::int32_t index = chart_of_[triangle];
    return index < 0 ? nullptr : &charts_[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] Patch PatchOf(std::uint32_t triangle) const;

  // At a place of the patch's chart, on the side to which the chart's normal
  // points (0) or on the other (1). Places beyond the chart are moved onto it.
  [[nodiscard]] Float4 At(const Patch& patch, int side, float x, float y) const;

  // At a point of a triangle, on the side that a ray of this direction meets.
  [[nodiscard]] Float4 At(std::uint32_t triangle,
                          const Eigen::Vector3f& p_W,
                          const Eigen::Vector3f& direction) const;

  [[nodiscard]] std::size_t num_bytes() const;
  [[nodiscard]] std::size_t num_nodes() const { return nodes_.size(); }

  // For the form of At that takes eight places at once. A cell is the log2 of
  // its nodes' steps along a side, above the index of the first of its
  // (steps + 1)^2 nodes.
  static constexpr int kIndexBits = 28;
  [[nodiscard]] const std::uint32_t* cells() const { return cells_.data(); }
  [[nodiscard]] const Float4* nodes() const { return nodes_.data(); }

 private:
  friend class LightMapBaker;

  std::vector<LightChart> charts_;
  std::vector<std::int32_t> chart_of_;     // By triangle.
  std::vector<std::uint32_t> first_cell_;  // By chart, front; then the back.
  std::vector<std::uint32_t> cells_;
  std::vector<Float4> nodes_;
  Float4 ambient_{};
};

inline Float4 LightMap::At(const Patch& patch,
                           int side,
                           float x,
                           float y) const {
  if (patch.width == 0) return ambient_;
  // In this order NaN becomes 0.
  x = x > 0.0f ? x : 0.0f;
  y = y > 0.0f ? y : 0.0f;
  const auto width = static_cast<float>(patch.width);
  const auto height = static_cast<float>(patch.height);
  x = x < width ? x : width;
  y = y < height ? y : height;
  int column = static_cast<int>(x);
  int row = static_cast<int>(y);
  column = column < patch.width ? column : patch.width - 1;
  row = row < patch.height ? row : patch.height - 1;
  x -= static_cast<float>(column);
  y -= static_cast<float>(row);
  const std::uint32_t cell =
      cells_[patch.first_cell[side] +
             static_cast<std::uint32_t>(row * patch.width + column)];
  const Float4* nodes = nodes_.data() + (cell & ((1u << kIndexBits) - 1u));
  const int steps = 1 << (cell >> kIndexBits);
  if (steps > 1) {
    x *= static_cast<float>(steps);
    y *= static_cast<float>(steps);
    int i = static_cast<int>(x);
    int j = static_cast<int>(y);
    i = i < steps ? i : steps - 1;
    j = j < steps ? j : steps - 1;
    x -= static_cast<float>(i);
    y -= static_cast<float>(j);
    nodes += j * (steps + 1) + i;
  }
  const Float4 fx = Broadcast(x);
  const Float4 upper = nodes[0] + fx * (nodes[1] - nodes[0]);
  const Float4* next = nodes + steps + 1;
  const Float4 lower = next[0] + fx * (next[1] - next[0]);
  return upper + Broadcast(y) * (lower - upper);
}

}  // namespace waymark
