#include "drivers/simulator/light_map_baker.h"

#include "drivers/simulator/parallel_rows.h"
#include "estimation/base/check.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::uint8_t kNoCell = 255;

// Rays start this far off the surface, m: more than roundings, less than
// anything that shows.
constexpr double kLift = 0.001;

// Ambient light that arrives inside hollow walls, at most. Corners of rooms
// have a quarter.
constexpr float kBuriedOpenness = 0.15f;

// Where light changes by this part from corner to corner of a cell, its edges
// would show.
constexpr float kFastChange = 0.25f;
// Also this part, where a cell reaches beyond the border of its surface: there
// its corners hold the light of the border, and the walls' shade begins.
constexpr float kBorderChange = 0.06f;
constexpr double kBeyond = 0.1;  // Of a cell.
constexpr float kLeastChange = 0.01f;

constexpr std::uint8_t kLogBorder = 1;
constexpr std::uint8_t kLogFine = 2;
constexpr std::uint8_t kLogFinest = 3;

Vector3d Facing(const LightChart& chart, int side) {
  return side == 0 ? chart.normal : Vector3d(-chart.normal);
}

}  // namespace

LightMapBaker::LightMapBaker(const Scene& scene,
                             const LightField& field,
                             std::span<const Float4> albedos,
                             int num_threads,
                             LightMap* map)
    : scene_(scene),
      field_(field),
      albedos_(albedos),
      num_threads_(num_threads),
      map_(map) {}

void LightMapBaker::Bake() {
  const auto for_each = [&](const std::vector<Row>& rows, auto method) {
    ForEachRow(static_cast<int>(rows.size()), num_threads_, [&](int i) {
      (this->*method)(rows[static_cast<std::size_t>(i)]);
    });
  };
  Layout();
  for_each(node_rows_, &LightMapBaker::DirectRow);
  for_each(node_rows_, &LightMapBaker::GatherRow);
  for_each(cell_rows_, &LightMapBaker::ChooseStepsRow);
  AssignNodes();
  for_each(cell_rows_, &LightMapBaker::FillRow);
  for_each(cell_rows_, &LightMapBaker::MendEdgesRow);
}

void LightMapBaker::Layout() {
  std::size_t num_nodes = 0;
  std::size_t num_cells = 0;
  for (std::size_t c = 0; c < map_->charts_.size(); ++c) {
    const LightChart& chart = map_->charts_[c];
    first_node_.push_back(num_nodes);
    map_->first_cell_.push_back(static_cast<std::uint32_t>(num_cells));
    num_nodes += 2 * static_cast<std::size_t>(chart.width + 1) *
                 static_cast<std::size_t>(chart.height + 1);
    num_cells += 2 * static_cast<std::size_t>(chart.width) *
                 static_cast<std::size_t>(chart.height);
    for (int y = 0; y <= chart.height; ++y) node_rows_.push_back({c, y});
    for (int y = 0; y < chart.height; ++y) cell_rows_.push_back({c, y});
  }
  nodes_.resize(num_nodes);
  map_->cells_.resize(num_cells);
  log_steps_.assign(num_cells, kNoCell);
}

std::size_t LightMapBaker::NodeIndex(std::size_t chart,
                                     int side,
                                     int x,
                                     int y) const {
  const LightChart& c = map_->charts_[chart];
  return first_node_[chart] +
         static_cast<std::size_t>((side * (c.height + 1) + y) * (c.width + 1) +
                                  x);
}

std::size_t LightMapBaker::CellIndex(std::size_t chart,
                                     int side,
                                     int x,
                                     int y) const {
  const LightChart& c = map_->charts_[chart];
  return map_->first_cell_[chart] +
         static_cast<std::size_t>((side * c.height + y) * c.width + x);
}

std::vector<std::uint32_t> LightMapBaker::TrianglesAt(const LightChart& chart,
                                                      int x,
                                                      int y) const {
  std::vector<std::uint32_t> all;
  for (const int j : {y - 1, y}) {
    for (const int i : {x - 1, x}) {
      const auto touching = chart.CellTriangles(i, j);
      all.insert(all.end(), touching.begin(), touching.end());
    }
  }
  return all;
}

Vector3d LightMapBaker::CornerPoint(const LightChart& chart,
                                    int x,
                                    int y) const {
  return NearestInside(
      scene_.mesh, TrianglesAt(chart, x, y), chart.Point(Vector2d(x, y)));
}

void LightMapBaker::DirectRow(const Row& row) {
  const LightChart& chart = map_->charts_[row.chart];
  for (int x = 0; x <= chart.width; ++x) {
    const auto triangles = TrianglesAt(chart, x, row.y);
    if (triangles.empty()) continue;
    const Vector3d p_W =
        NearestInside(scene_.mesh, triangles, chart.Point(Vector2d(x, row.y)));
    for (const int side : {0, 1}) {
      LightNode& node = nodes_[NodeIndex(row.chart, side, x, row.y)];
      const Vector3d n_W = Facing(chart, side);
      node.is_used = true;
      node.direct = field_.Direct(
          p_W + kLift * n_W, n_W, LightField::kAllLamps, &node.lamps);
    }
  }
}

Float4 LightMapBaker::ThrownBack(std::uint32_t triangle,
                                 const Vector3f& p_W,
                                 const Vector3f& direction) const {
  const std::uint32_t material = scene_.mesh.triangles[triangle].material;
  if (scene_.materials[material].is_emissive) return albedos_[material];
  const std::int32_t index = map_->chart_of_[triangle];
  if (index < 0) return Float4{};
  const auto c = static_cast<std::size_t>(index);
  const LightChart& chart = map_->charts_[c];
  const int side = chart.normal.dot(direction.cast<double>()) > 0.0 ? 1 : 0;
  const Vector2d place = chart.Place(p_W.cast<double>())
                             .cwiseMax(0.0)
                             .cwiseMin(Vector2d(chart.width, chart.height));
  const int x = std::min(static_cast<int>(place.x()), chart.width - 1);
  const int y = std::min(static_cast<int>(place.y()), chart.height - 1);
  const auto at = [&](int i, int j) {
    return nodes_[NodeIndex(c, side, x + i, y + j)].direct;
  };
  const auto fx = static_cast<float>(place.x() - x);
  const auto fy = static_cast<float>(place.y() - y);
  return albedos_[material] *
         Mix(Mix(at(0, 0), at(1, 0), fx), Mix(at(0, 1), at(1, 1), fx), fy);
}

void LightMapBaker::Light(const Vector3d& p_W,
                          const Vector3d& n_W,
                          LightNode* node) const {
  const LightField::Gathered gathered =
      field_.Gather(p_W + kLift * n_W,
                    n_W,
                    Largest(node->direct) <= 0.0f,
                    [this](std::uint32_t triangle,
                           const Vector3f& q_W,
                           const Vector3f& direction) {
                      return ThrownBack(triangle, q_W, direction);
                    });
  node->light = node->direct + gathered.light;
  node->is_buried =
      Largest(node->direct) <= 0.0f && gathered.openness < kBuriedOpenness;
}

void LightMapBaker::GatherRow(const Row& row) {
  const LightChart& chart = map_->charts_[row.chart];
  for (int x = 0; x <= chart.width; ++x) {
    if (!nodes_[NodeIndex(row.chart, 0, x, row.y)].is_used) continue;
    const Vector3d p_W = CornerPoint(chart, x, row.y);
    for (const int side : {0, 1}) {
      Light(p_W,
            Facing(chart, side),
            &nodes_[NodeIndex(row.chart, side, x, row.y)]);
    }
  }
}

int LightMapBaker::StepsOf(std::size_t chart, int side, int x, int y) const {
  const LightChart& c = map_->charts_[chart];
  // A small piece has a grid of its own, fine enough as it is.
  if (c.width == 1 && c.height == 1) return 0;
  std::array<Vector3d, 4> points;
  float low_value = 1e30f;
  float high_value = 0.0f;
  int num_buried = 0;
  bool is_border = false;
  for (int i = 0; i < 4; ++i) {
    const int corner_x = x + i % 2;
    const int corner_y = y + i / 2;
    const LightNode& node = nodes_[NodeIndex(chart, side, corner_x, corner_y)];
    const Vector3d p_W = CornerPoint(c, corner_x, corner_y);
    points[static_cast<std::size_t>(i)] = p_W + kLift * Facing(c, side);
    is_border |= (p_W - c.Point(Vector2d(corner_x, corner_y))).norm() >
                 kBeyond * c.cell_size.x();
    low_value = std::min(low_value, Largest(node.light));
    high_value = std::max(high_value, Largest(node.light));
    num_buried += node.is_buried ? 1 : 0;
  }
  // Wholly inside a wall nobody sees it.
  if (num_buried == 4) return 0;
  if (field_.AreApart(points)) return kLogFinest;
  const float change = high_value - low_value - kLeastChange;
  if (change > kFastChange * high_value) return kLogFine;
  return is_border && change > kBorderChange * high_value ? kLogBorder : 0;
}

void LightMapBaker::ChooseStepsRow(const Row& row) {
  const LightChart& chart = map_->charts_[row.chart];
  for (const int side : {0, 1}) {
    for (int x = 0; x < chart.width; ++x) {
      if (chart.CellTriangles(x, row.y).empty()) continue;
      log_steps_[CellIndex(row.chart, side, x, row.y)] =
          static_cast<std::uint8_t>(StepsOf(row.chart, side, x, row.y));
    }
  }
}

void LightMapBaker::AssignNodes() {
  // One dark cell for all places outside the surface.
  std::size_t num_nodes = 4;
  for (std::size_t i = 0; i < log_steps_.size(); ++i) {
    if (log_steps_[i] == kNoCell) continue;
    const std::size_t num = (std::size_t{1} << log_steps_[i]) + 1;
    map_->cells_[i] = static_cast<std::uint32_t>(log_steps_[i])
                          << LightMap::kIndexBits |
                      static_cast<std::uint32_t>(num_nodes);
    num_nodes += num * num;
    WAYMARK_CHECK(num_nodes < std::size_t{1} << LightMap::kIndexBits,
                  "too many nodes of light");
  }
  map_->nodes_.resize(num_nodes);
}

// Most lamps are behind walls, and are not looked for again inside a cell:
// those count that light one of the sixteen nodes about it.
LightField::LampSet LightMapBaker::LampsAbout(std::size_t chart,
                                              int side,
                                              int x,
                                              int y) const {
  const LightChart& c = map_->charts_[chart];
  LightField::LampSet lamps = 0;
  for (int j = std::max(0, y - 1); j <= std::min(c.height, y + 2); ++j) {
    for (int i = std::max(0, x - 1); i <= std::min(c.width, x + 2); ++i) {
      lamps |= nodes_[NodeIndex(chart, side, i, j)].lamps;
    }
  }
  return lamps;
}

void LightMapBaker::FillCell(std::size_t chart, int side, int x, int y) {
  const LightChart& c = map_->charts_[chart];
  const std::size_t index = CellIndex(chart, side, x, y);
  const int steps = 1 << log_steps_[index];
  const Vector3d n_W = Facing(c, side);
  const auto point = [&](const LightNodePlace& at) {
    const Vector2d place(x + static_cast<double>(at.x) / steps,
                         y + static_cast<double>(at.y) / steps);
    return NearestInside(scene_.mesh, c.CellTriangles(x, y), c.Point(place));
  };
  const LightField::LampSet lamps = LampsAbout(chart, side, x, y);
  LightCellSource source;
  source.compute = [&](const LightNodePlace& at) {
    const Vector3d p_W = point(at);
    LightNode node;
    node.direct = field_.Direct(p_W + kLift * n_W, n_W, lamps);
    Light(p_W, n_W, &node);
    return node;
  };
  source.are_apart = [&](std::span<const LightNodePlace> places) {
    // Of other cells it is known that nothing stands between their corners.
    if (log_steps_[index] != kLogFinest) return false;
    std::array<Vector3d, 4> points;
    for (std::size_t i = 0; i < places.size(); ++i) {
      points[i] = point(places[i]) + kLift * n_W;
    }
    return field_.AreApart(std::span(points).first(places.size()));
  };
  std::array<LightNode, kMostNodes> nodes;
  for (const int corner : {0, 1, 2, 3}) {
    const int i = corner % 2;
    const int j = corner / 2;
    nodes[static_cast<std::size_t>(steps * (j * (steps + 1) + i))] =
        nodes_[NodeIndex(chart, side, x + i, y + j)];
  }
  const auto side_nodes = static_cast<std::size_t>(steps + 1);
  const std::size_t num = side_nodes * side_nodes;
  FillLightCell(steps, source, std::span(nodes).first(num));
  Float4* to = map_->nodes_.data() +
               (map_->cells_[index] & ((1u << LightMap::kIndexBits) - 1u));
  for (std::size_t i = 0; i < num; ++i) to[i] = nodes[i].light;
}

void LightMapBaker::FillRow(const Row& row) {
  const LightChart& chart = map_->charts_[row.chart];
  for (const int side : {0, 1}) {
    for (int x = 0; x < chart.width; ++x) {
      const std::size_t index = CellIndex(row.chart, side, x, row.y);
      if (log_steps_[index] != kNoCell) FillCell(row.chart, side, x, row.y);
    }
  }
}

// Nodes on the border to a coarser cell lie on the straight line between that
// one's nodes, or a seam would show.
void LightMapBaker::MendEdges(std::size_t chart, int side, int x, int y) {
  const LightChart& c = map_->charts_[chart];
  const auto nodes_of = [&](std::size_t index) {
    return map_->nodes_.data() +
           (map_->cells_[index] & ((1u << LightMap::kIndexBits) - 1u));
  };
  const std::size_t index = CellIndex(chart, side, x, y);
  const int steps = 1 << log_steps_[index];
  Float4* nodes = nodes_of(index);
  constexpr int kNeighbours[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  for (const auto& step : kNeighbours) {
    const int dx = step[0];
    const int dy = step[1];
    const int other_x = x + dx;
    const int other_y = y + dy;
    if (c.CellTriangles(other_x, other_y).empty()) continue;
    const std::size_t other = CellIndex(chart, side, other_x, other_y);
    if (log_steps_[other] >= log_steps_[index]) continue;
    const int other_steps = 1 << log_steps_[other];
    const Float4* others = nodes_of(other);
    const int ratio = steps / other_steps;
    // Node `i` along the border, of a cell with `num` steps, on the border's
    // side of it.
    const auto at = [&](int num, int i, bool is_ours) {
      const int far = (dx + dy > 0) == is_ours ? num : 0;
      return dx != 0 ? i * (num + 1) + far : far * (num + 1) + i;
    };
    for (int i = 1; i < steps; ++i) {
      const int from = i / ratio;
      const float share =
          static_cast<float>(i % ratio) / static_cast<float>(ratio);
      const Float4& a = others[at(other_steps, from, false)];
      if (i % ratio == 0) {
        nodes[at(steps, i, true)] = a;
      } else {
        nodes[at(steps, i, true)] =
            Mix(a, others[at(other_steps, from + 1, false)], share);
      }
    }
  }
}

void LightMapBaker::MendEdgesRow(const Row& row) {
  const LightChart& chart = map_->charts_[row.chart];
  for (const int side : {0, 1}) {
    for (int x = 0; x < chart.width; ++x) {
      const std::uint8_t log = log_steps_[CellIndex(row.chart, side, x, row.y)];
      if (log != kNoCell && log > 0) MendEdges(row.chart, side, x, row.y);
    }
  }
}

}  // namespace waymark
