#include "drivers/simulator/mesh_outline.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace waymark {
namespace {

using Polygon2 = std::vector<Eigen::Vector2d>;
using Polygon3 = std::vector<Eigen::Vector3d>;

// Vertices of a mesh are float: 10 um is above their rounding in any building
// and below anything that a robot can feel.
constexpr double kSameLine = 1e-5;
constexpr double kShortest = 1e-6;

// Keeps the part of a convex polygon where sign * (z - level) >= 0.
Polygon3 ClipAt(const Polygon3& polygon, double level, double sign) {
  Polygon3 kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& p = polygon[i];
    const Eigen::Vector3d& q = polygon[(i + 1) % polygon.size()];
    const double inside_p = sign * (p.z() - level);
    const double inside_q = sign * (q.z() - level);
    if (inside_p >= 0.0) kept.push_back(p);
    if (inside_p * inside_q < 0.0) {
      kept.push_back(p + inside_p / (inside_p - inside_q) * (q - p));
    }
  }
  return kept;
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Lines across a convex polygon, along its longest side or diagonal.
void AppendHatch(const Polygon2& corners,
                 const Eigen::Vector2d& along,
                 std::vector<Segment2>* segments) {
  double low = 0.0;
  double high = 0.0;
  const auto offset = [&](const Eigen::Vector2d& p) {
    return Cross(along, p - corners[0]);
  };
  for (const Eigen::Vector2d& p : corners) {
    low = std::min(low, offset(p));
    high = std::max(high, offset(p));
  }
  const int num_gaps = static_cast<int>(std::ceil((high - low) / kHatch));
  for (int i = 1; i < num_gaps; ++i) {
    const double level = low + (high - low) * i / num_gaps;
    Polygon2 ends;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector2d& p = corners[k];
      const Eigen::Vector2d& q = corners[(k + 1) % corners.size()];
      const double from = offset(p) - level;
      const double to = offset(q) - level;
      if ((from < 0.0) != (to < 0.0)) {
        ends.emplace_back(p + from / (from - to) * (q - p));
      }
    }
    if (ends.size() == 2 && (ends[1] - ends[0]).norm() >= kShortest) {
      segments->push_back({ends[0], ends[1]});
    }
  }
}

// A convex polygon seen from above is convex too: thin ones become the segment
// between the two corners farthest apart.
void AppendEdges(const Polygon3& polygon, std::vector<Segment2>* segments) {
  if (polygon.size() < 2) return;
  Polygon2 corners;
  for (const Eigen::Vector3d& p : polygon) corners.emplace_back(p.head<2>());
  Segment2 longest{corners[0], corners[0]};
  double best = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      const double length = (corners[j] - corners[i]).norm();
      if (length > best) {
        best = length;
        longest = {corners[i], corners[j]};
      }
    }
  }
  if (best < kShortest) return;
  const Eigen::Vector2d along = (longest.b - longest.a) / best;
  double width = 0.0;
  for (const Eigen::Vector2d& p : corners) {
    width = std::max(width, std::abs(Cross(along, p - longest.a)));
  }
  if (width < kSameLine) {
    segments->push_back(longest);
    return;
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& p = corners[i];
    const Eigen::Vector2d& q = corners[(i + 1) % corners.size()];
    if ((q - p).norm() >= kShortest) segments->push_back({p, q});
  }
  AppendHatch(corners, along, segments);
}

// A line and the stretches of it that are taken.
struct Line {
  Eigen::Vector2d origin;
  Eigen::Vector2d along;
  std::vector<std::pair<double, double>> stretches;

  [[nodiscard]] bool Holds(const Eigen::Vector2d& p) const {
    return std::abs(Cross(along, p - origin)) < kSameLine;
  }
  void Add(const Segment2& s) {
    const double ta = along.dot(s.a - origin);
    const double tb = along.dot(s.b - origin);
    stretches.emplace_back(std::min(ta, tb), std::max(ta, tb));
  }
};

// Same line, same key; near lines may have it too.
std::pair<std::int64_t, std::int64_t> KeyOf(const Eigen::Vector2d& along,
                                            const Eigen::Vector2d& p) {
  constexpr double kAngleStep = 1e-3;
  constexpr double kOffsetStep = 1e-3;
  return {std::llround(std::atan2(along.y(), along.x()) / kAngleStep),
          std::llround(Cross(along, p) / kOffsetStep)};
}

std::vector<Segment2> Joined(const std::vector<Segment2>& segments) {
  std::vector<Line> lines;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>>
      lines_by_key;
  for (const Segment2& s : segments) {
    Eigen::Vector2d along = (s.b - s.a).normalized();
    // One direction of the two, told apart away from the axes, along which
    // most walls run and rounding would choose.
    if (along.x() + 0.4 * along.y() < 0.0) along = -along;
    std::vector<std::size_t>& near = lines_by_key[KeyOf(along, s.a)];
    const auto same = std::find_if(near.begin(), near.end(), [&](auto i) {
      return lines[i].Holds(s.a) && lines[i].Holds(s.b);
    });
    if (same != near.end()) {
      lines[*same].Add(s);
      continue;
    }
    near.push_back(lines.size());
    lines.push_back({s.a, along, {}});
    lines.back().Add(s);
  }
  std::vector<Segment2> joined;
  for (Line& line : lines) {
    std::sort(line.stretches.begin(), line.stretches.end());
    std::pair<double, double> stretch = line.stretches.front();
    const auto push = [&] {
      joined.push_back({line.origin + stretch.first * line.along,
                        line.origin + stretch.second * line.along});
    };
    for (const auto& [from, to] : line.stretches) {
      if (from > stretch.second + kSameLine) {
        push();
        stretch = {from, to};
      }
      stretch.second = std::max(stretch.second, to);
    }
    push();
  }
  return joined;
}

}  // namespace

std::vector<Segment2> OutlineOfMesh(const SceneMesh& mesh,
                                    const HeightBand& band) {
  WAYMARK_CHECK(std::isfinite(band.low) && std::isfinite(band.high) &&
                    band.low < band.high,
                band.low,
                band.high);
  std::vector<Segment2> segments;
  for (const SceneTriangle& triangle : mesh.triangles) {
    Polygon3 polygon;
    for (const std::uint32_t vertex : triangle.vertices) {
      WAYMARK_CHECK(vertex < mesh.positions.size(), vertex);
      polygon.emplace_back(mesh.positions[vertex].cast<double>());
      WAYMARK_CHECK(polygon.back().allFinite(), vertex);
    }
    AppendEdges(ClipAt(ClipAt(polygon, band.low, 1.0), band.high, -1.0),
                &segments);
  }
  return Joined(segments);
}

}  // namespace waymark
