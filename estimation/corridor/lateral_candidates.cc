#include "estimation/corridor/lateral_candidates.h"

#include "estimation/base/check.h"
#include "estimation/lines/furthest_removal.h"

#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace waymark {
namespace {

bool IsLeft(CorridorEdge edge) {
  return edge == CorridorEdge::kFloorLeft ||
         edge == CorridorEdge::kCeilingLeft ||
         edge == CorridorEdge::kSkirtingLeft;
}

}  // namespace

std::optional<double> LateralOfRay(const Eigen::Vector2d& ray,
                                   const Eigen::Vector2d& place,
                                   double camera_z,
                                   double width) {
  const double rise = place.y() - camera_z;
  if (!(rise * ray.y() > 0.0)) return std::nullopt;
  const double y_C = place.x() - rise * ray.x() / ray.y();
  if (!(std::abs(y_C) < 0.5 * width)) return std::nullopt;
  return y_C;
}

std::optional<double> LateralCandidate(const CorridorView& view,
                                       const SeenLine& line,
                                       CorridorEdge edge,
                                       const CorridorGeometry& corridor,
                                       double heading) {
  const auto place = PlaceOf(edge, corridor);
  if (!place) return std::nullopt;
  // The plane through the camera and the line contains the middle's ray, and
  // p lies on that ray: in the cross-section (left, up) seen along the axis
  // it is as many times the ray as its height asks for.
  const Eigen::Vector2d lever = CameraIn(view, 0.0, heading);
  const auto y_C = LateralOfRay(RayAcross(view, line.middle, heading),
                                *place,
                                lever.y(),
                                corridor.width.value());
  if (!y_C) return std::nullopt;
  return *y_C - lever.x();
}

void LateralConsensusOptions::Check() const {
  if (num_kept < 1) throw std::invalid_argument("num_kept: at least 1");
}

LateralConsensus AgreeOnLateral(const CorridorView& view,
                                std::span<const SeenLine> lines,
                                std::span<const CorridorEdge> edges,
                                const CorridorGeometry& corridor,
                                double heading,
                                const LateralConsensusOptions& options) {
  options.Check();
  WAYMARK_CHECK(lines.size() == edges.size(), lines.size(), edges.size());
  LateralConsensus result;
  result.inlier_mask.assign(lines.size(), 0);
  std::vector<double> candidates;
  std::vector<std::size_t> line_of;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto y =
        LateralCandidate(view, lines[i], edges[i], corridor, heading);
    if (!y) continue;
    candidates.push_back(*y);
    line_of.push_back(i);
  }
  if (candidates.empty()) {
    result.reason = "no line can be an edge of the corridor";
    return result;
  }
  const FurthestRemoval removal = RemoveFurthest(candidates, options.num_kept);
  bool is_left_seen = false;
  bool is_right_seen = false;
  for (const int k : removal.kept) {
    const std::size_t line = line_of[static_cast<std::size_t>(k)];
    result.inlier_mask[line] = 1;
    (IsLeft(edges[line]) ? is_left_seen : is_right_seen) = true;
  }
  if (options.needs_both_walls && !(is_left_seen && is_right_seen)) {
    result.reason = std::string("of the lines that agree none is on the ") +
                    (is_left_seen ? "right" : "left") + " wall";
    return result;
  }
  result.y = removal.centre.x();
  return result;
}

}  // namespace waymark
