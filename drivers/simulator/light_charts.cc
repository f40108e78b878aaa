#include "drivers/simulator/light_charts.h"

#include "drivers/simulator/light_field.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

namespace waymark {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Lines of the grid are this part of a cell off the round numbers at which
// walls like to stand.
constexpr double kShift = 0.37;

// Of a cell: points of a triangle fall into a cell that it touches, also after
// roundings of float.
constexpr double kMargin = 1e-3;

// Farther out (m) floats have no place for cells; triangles there get the
// ambient light alone.
constexpr double kFarthest = 1e6;

// Planes that differ less are one: 0.5 mrad, 2 mm.
constexpr double kNormalSteps = 2048.0;
constexpr double kOffsetSteps = 500.0;

std::array<Vector3d, 3> Corners(const SceneMesh& mesh, std::uint32_t triangle) {
  const SceneTriangle& t = mesh.triangles[triangle];
  return {mesh.positions[t.vertices[0]].cast<double>(),
          mesh.positions[t.vertices[1]].cast<double>(),
          mesh.positions[t.vertices[2]].cast<double>()};
}

// The same for both windings.
Vector3d PlaneNormal(const std::array<Vector3d, 3>& p) {
  Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]).stableNormalized();
  // Roundings near zero must not choose the sign.
  constexpr double kZero = 1e-6;
  for (const double value : {normal.x(), normal.y(), normal.z()}) {
    if (std::abs(value) < kZero) continue;
    return value < 0.0 ? Vector3d(-normal) : normal;
  }
  return normal;
}

using PlaneKey = std::array<std::int64_t, 4>;

PlaneKey KeyOf(const Vector3d& normal, double offset) {
  return {std::llround(normal.x() * kNormalSteps),
          std::llround(normal.y() * kNormalSteps),
          std::llround(normal.z() * kNormalSteps),
          std::llround(offset * kOffsetSteps)};
}

struct Plane {
  Vector3d normal;
  Vector3d right;
  Vector3d up;
  double offset = 0.0;
  std::vector<std::uint32_t> triangles;
};

std::vector<Plane> GroupByPlane(const Scene& scene) {
  std::map<PlaneKey, Plane> planes;
  for (std::uint32_t i = 0; i < scene.mesh.triangles.size(); ++i) {
    if (scene.materials[scene.mesh.triangles[i].material].is_emissive) continue;
    const auto corners = Corners(scene.mesh, i);
    const auto is_far = [](const Vector3d& p) {
      return p.cwiseAbs().maxCoeff() > kFarthest;
    };
    if (std::any_of(corners.begin(), corners.end(), is_far)) continue;
    const Vector3d normal = PlaneNormal(corners);
    if (!(normal.squaredNorm() > 0.0)) continue;
    const double offset = normal.dot(corners[0]);
    Plane& plane = planes[KeyOf(normal, offset)];
    if (plane.triangles.empty()) {
      plane.normal = normal;
      plane.offset = offset;
      PlaneAxes(normal, &plane.right, &plane.up);
    }
    plane.triangles.push_back(i);
  }
  std::vector<Plane> list;
  for (auto& [key, plane] : planes) list.push_back(std::move(plane));
  return list;
}

using Triangle2 = std::array<Vector2d, 3>;

Triangle2 Flat(const SceneMesh& mesh, const Plane& plane, std::uint32_t index) {
  Triangle2 flat;
  const auto corners = Corners(mesh, index);
  for (std::size_t i = 0; i < 3; ++i) {
    flat[i] = {plane.right.dot(corners[i]), plane.up.dot(corners[i])};
  }
  return flat;
}

// Whether a triangle and an upright box of half size `half` about the origin
// touch: no edge of either separates them.
bool TouchesBox(const Triangle2& t, double half) {
  for (int axis = 0; axis < 2; ++axis) {
    const auto [low, high] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
    if (low > half || high < -half) return false;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector2d edge = t[(i + 1) % 3] - t[i];
    const Vector2d across(-edge.y(), edge.x());
    const double reach = half * across.cwiseAbs().sum();
    const double a = across.dot(t[i]);
    const double b = across.dot(t[(i + 2) % 3]);
    if (std::min(a, b) > reach || std::max(a, b) < -reach) return false;
  }
  return true;
}

struct CellRange {
  std::int64_t left = 0;
  std::int64_t top = 0;
  std::int64_t right = 0;  // Inclusive.
  std::int64_t bottom = 0;

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>((right - left + 1) * (bottom - top + 1));
  }
  void Include(const CellRange& other) {
    left = std::min(left, other.left);
    top = std::min(top, other.top);
    right = std::max(right, other.right);
    bottom = std::max(bottom, other.bottom);
  }
};

Vector2d InCells(const Vector2d& flat, double cell_size) {
  return flat / cell_size + Vector2d::Constant(kShift);
}

CellRange RangeOf(const Triangle2& flat, double cell_size) {
  CellRange range;
  Vector2d low = InCells(flat[0], cell_size);
  Vector2d high = low;
  for (const Vector2d& corner : flat) {
    low = low.cwiseMin(InCells(corner, cell_size));
    high = high.cwiseMax(InCells(corner, cell_size));
  }
  low.array() -= kMargin;
  high.array() += kMargin;
  range.left = static_cast<std::int64_t>(std::floor(low.x()));
  range.top = static_cast<std::int64_t>(std::floor(low.y()));
  range.right = static_cast<std::int64_t>(std::floor(high.x()));
  range.bottom = static_cast<std::int64_t>(std::floor(high.y()));
  return range;
}

// Calls visit(x, y) for each cell that the triangle touches.
template <typename Visit>
void ForEachCell(const Triangle2& flat, double cell_size, const Visit& visit) {
  const CellRange range = RangeOf(flat, cell_size);
  for (std::int64_t y = range.top; y <= range.bottom; ++y) {
    for (std::int64_t x = range.left; x <= range.right; ++x) {
      const Vector2d middle(static_cast<double>(x) + 0.5,
                            static_cast<double>(y) + 0.5);
      Triangle2 local;
      for (std::size_t i = 0; i < 3; ++i) {
        local[i] = InCells(flat[i], cell_size) - middle;
      }
      if (TouchesBox(local, 0.5 + kMargin)) visit(x, y);
    }
  }
}

// Sets of triangles that touch common cells.
class Pieces {
 public:
  explicit Pieces(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::size_t Find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Join(std::size_t a, std::size_t b) {
    a = Find(a);
    b = Find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

std::uint64_t CellKey(std::int64_t x, std::int64_t y) {
  return static_cast<std::uint64_t>(x) << 32 ^
         (static_cast<std::uint64_t>(y) & 0xFFFFFFFFu);
}

std::vector<LightChart> SplitPlane(const SceneMesh& mesh,
                                   const Plane& plane,
                                   double cell_size) {
  Pieces pieces(plane.triangles.size());
  std::unordered_map<std::uint64_t, std::size_t> owner;
  for (std::size_t i = 0; i < plane.triangles.size(); ++i) {
    ForEachCell(Flat(mesh, plane, plane.triangles[i]),
                cell_size,
                [&](std::int64_t x, std::int64_t y) {
                  const auto [entry, is_new] = owner.emplace(CellKey(x, y), i);
                  if (!is_new) pieces.Join(entry->second, i);
                });
  }
  std::map<std::size_t, LightChart> charts;
  for (std::size_t i = 0; i < plane.triangles.size(); ++i) {
    LightChart& chart = charts[pieces.Find(i)];
    chart.triangles.push_back(plane.triangles[i]);
  }
  std::vector<LightChart> list;
  for (auto& [root, chart] : charts) {
    chart.normal = plane.normal;
    chart.right = plane.right;
    chart.up = plane.up;
    chart.offset = plane.offset;
    list.push_back(std::move(chart));
  }
  return list;
}

void SetGrid(const SceneMesh& mesh,
             const Plane& plane,
             double cell_size,
             LightChart* chart) {
  const double infinity = std::numeric_limits<double>::infinity();
  Vector2d low(infinity, infinity);
  Vector2d high = -low;
  std::vector<Triangle2> flats;
  for (const std::uint32_t triangle : chart->triangles) {
    flats.push_back(Flat(mesh, plane, triangle));
    for (const Vector2d& corner : flats.back()) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  const Vector2d extent = high - low;
  if (extent.maxCoeff() < cell_size) {
    // A millimetre at least, against division by nothing.
    chart->cell_size = extent.cwiseMax(1e-3);
    chart->origin = low;
    chart->width = 1;
    chart->height = 1;
    chart->first = {0, static_cast<std::uint32_t>(chart->triangles.size())};
    chart->touching = chart->triangles;
    return;
  }
  CellRange range = RangeOf(flats[0], cell_size);
  for (const Triangle2& flat : flats) range.Include(RangeOf(flat, cell_size));
  chart->cell_size = Vector2d::Constant(cell_size);
  chart->origin = cell_size * (Vector2d(static_cast<double>(range.left),
                                        static_cast<double>(range.top)) -
                               Vector2d::Constant(kShift));
  chart->width = static_cast<int>(range.right - range.left + 1);
  chart->height = static_cast<int>(range.bottom - range.top + 1);
  chart->first.assign(range.size() + 1, 0);
  const auto index = [&](std::int64_t x, std::int64_t y) {
    return static_cast<std::size_t>((y - range.top) * chart->width + x -
                                    range.left);
  };
  for (const Triangle2& flat : flats) {
    ForEachCell(flat, cell_size, [&](std::int64_t x, std::int64_t y) {
      ++chart->first[index(x, y) + 1];
    });
  }
  std::partial_sum(
      chart->first.begin(), chart->first.end(), chart->first.begin());
  chart->touching.resize(chart->first.back());
  std::vector<std::uint32_t> next(chart->first.begin(), chart->first.end() - 1);
  for (std::size_t i = 0; i < flats.size(); ++i) {
    ForEachCell(flats[i], cell_size, [&](std::int64_t x, std::int64_t y) {
      chart->touching[next[index(x, y)]++] = chart->triangles[i];
    });
  }
}

// Cells of all triangles and of the rectangles about each plane's, at most.
double CellsAtMost(const SceneMesh& mesh,
                   const std::vector<Plane>& planes,
                   double cell_size) {
  double sum = 0.0;
  for (const Plane& plane : planes) {
    for (const std::uint32_t triangle : plane.triangles) {
      const Triangle2 flat = Flat(mesh, plane, triangle);
      Vector2d low = flat[0].cwiseMin(flat[1]).cwiseMin(flat[2]);
      Vector2d high = flat[0].cwiseMax(flat[1]).cwiseMax(flat[2]);
      const Vector2d cells = (high - low) / cell_size;
      sum += (cells.x() + 1.0) * (cells.y() + 1.0);
    }
  }
  return sum;
}

Vector3d NearestOnSegment(const Vector3d& p,
                          const Vector3d& a,
                          const Vector3d& b) {
  const Vector3d edge = b - a;
  const double length = edge.squaredNorm();
  const double share =
      length > 0.0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0.0;
  return a + share * edge;
}

bool IsInside(const std::array<Vector3d, 3>& corners, const Vector3d& p) {
  const Vector3d normal =
      (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d& a = corners[i];
    const Vector3d& b = corners[(i + 1) % 3];
    if (normal.dot((b - a).cross(p - a)) < 0.0) return false;
  }
  return true;
}

}  // namespace

std::span<const std::uint32_t> LightChart::CellTriangles(int x, int y) const {
  if (x < 0 || y < 0 || x >= width || y >= height) return {};
  const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(x);
  return std::span(touching).subspan(first[i], first[i + 1] - first[i]);
}

Vector3d LightChart::Point(const Vector2d& place) const {
  const Vector2d flat = origin + place.cwiseProduct(cell_size);
  return offset * normal + flat.x() * right + flat.y() * up;
}

Vector2d LightChart::Place(const Vector3d& p_W) const {
  return (Vector2d(right.dot(p_W), up.dot(p_W)) - origin)
      .cwiseQuotient(cell_size);
}

std::vector<LightChart> BuildLightCharts(const Scene& scene,
                                         double cell_size,
                                         std::size_t max_cells) {
  const std::vector<Plane> planes = GroupByPlane(scene);
  // Triangles alone cost a cell each: a coarser grid cannot help below that.
  const double allowed =
      std::max(static_cast<double>(max_cells),
               2.0 * static_cast<double>(scene.mesh.triangles.size()));
  constexpr double kCoarser = 1.25;
  while (CellsAtMost(scene.mesh, planes, cell_size) > allowed) {
    cell_size *= kCoarser;
  }
  std::vector<LightChart> charts;
  for (const Plane& plane : planes) {
    for (LightChart& chart : SplitPlane(scene.mesh, plane, cell_size)) {
      SetGrid(scene.mesh, plane, cell_size, &chart);
      charts.push_back(std::move(chart));
    }
  }
  return charts;
}

Vector3d NearestInside(const SceneMesh& mesh,
                       std::span<const std::uint32_t> triangles,
                       const Vector3d& p_W) {
  Vector3d nearest = p_W;
  Vector3d inward = Vector3d::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t triangle : triangles) {
    const auto corners = Corners(mesh, triangle);
    if (IsInside(corners, p_W)) return p_W;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d q =
          NearestOnSegment(p_W, corners[i], corners[(i + 1) % 3]);
      const double square = (q - p_W).squaredNorm();
      if (square >= least) continue;
      least = square;
      nearest = q;
      inward = (corners[0] + corners[1] + corners[2]) / 3.0 - q;
    }
  }
  // Off the walls that stand on the border.
  constexpr double kInset = 0.002;
  const double length = inward.norm();
  if (length > 0.0) nearest += std::min(0.5, kInset / length) * inward;
  return nearest;
}

}  // namespace waymark
