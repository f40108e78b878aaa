#include "drivers/simulator/light_map.h"

#include "drivers/simulator/light_map_baker.h"

#include <cmath>
#include <stdexcept>

namespace waymark {

void LightMapOptions::Check() const {
  // A millimetre: the distance by which rays start off the surface.
  if (!(cell_size > 0.001) || !std::isfinite(cell_size)) {
    throw std::invalid_argument("light map: cell_size must be above 0.001 m");
  }
  if (max_cells == 0) {
    throw std::invalid_argument("light map: max_cells must be positive");
  }
}

LightMap::LightMap(const Scene& scene,
                   const LightField& field,
                   std::span<const Float4> albedos,
                   const LightMapOptions& options,
                   int num_threads)
    : ambient_{static_cast<float>(scene.ambient.x()),
               static_cast<float>(scene.ambient.y()),
               static_cast<float>(scene.ambient.z()),
               0.0f} {
  options.Check();
  charts_ = BuildLightCharts(scene, options.cell_size, options.max_cells);
  chart_of_.assign(scene.mesh.triangles.size(), -1);
  for (std::size_t i = 0; i < charts_.size(); ++i) {
    for (const std::uint32_t triangle : charts_[i].triangles) {
      chart_of_[triangle] = static_cast<std::int32_t>(i);
    }
  }
  LightMapBaker(scene, field, albedos, num_threads, this).Bake();
}

LightMap::Patch LightMap::PatchOf(std::uint32_t triangle) const {
  const std::int32_t index = chart_of_[triangle];
  if (index < 0) return {};
  const auto c = static_cast<std::size_t>(index);
  const auto num_cells =
      static_cast<std::uint32_t>(charts_[c].width * charts_[c].height);
  return {{first_cell_[c], first_cell_[c] + num_cells},
          charts_[c].width,
          charts_[c].height};
}

Float4 LightMap::At(std::uint32_t triangle,
                    const Eigen::Vector3f& p_W,
                    const Eigen::Vector3f& direction) const {
  const LightChart* map = chart(triangle);
  if (map == nullptr) return ambient_;
  const Eigen::Vector2d place = map->Place(p_W.cast<double>());
  const int side = map->normal.dot(direction.cast<double>()) > 0.0 ? 1 : 0;
  return At(PatchOf(triangle),
            side,
            static_cast<float>(place.x()),
            static_cast<float>(place.y()));
}

std::size_t LightMap::num_bytes() const {
  std::size_t sum = nodes_.size() * sizeof(nodes_[0]) +
                    cells_.size() * sizeof(cells_[0]) +
                    chart_of_.size() * sizeof(chart_of_[0]);
  for (const LightChart& chart : charts_) {
    sum += sizeof(chart) + (chart.first.size() + chart.touching.size() +
                            chart.triangles.size()) *
                               sizeof(chart.first[0]);
  }
  return sum;
}

}  // namespace waymark
