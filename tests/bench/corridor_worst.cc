#include "tests/bench/corridor_worst.h"

#include "estimation/corridor/corridor_view.h"
#include "estimation/corridor/edge_evidence.h"
#include "estimation/geometry/angle.h"
#include "logs/report/corridor_picture.h"
#include "logs/report/html_parts.h"
#include "logs/report/report_style.h"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

const char* NameOf(CorridorEdge edge) {
  switch (edge) {
    case CorridorEdge::kFloorLeft:
      return "floor left";
    case CorridorEdge::kFloorRight:
      return "floor right";
    case CorridorEdge::kCeilingLeft:
      return "ceiling left";
    case CorridorEdge::kCeilingRight:
      return "ceiling right";
    case CorridorEdge::kSkirtingLeft:
      return "skirting board left";
    case CorridorEdge::kSkirtingRight:
      return "skirting board right";
    case CorridorEdge::kNone:
    case CorridorEdge::kAlong:
      break;
  }
  return "none";
}

// How far beside the true edge a pixel is, rad: the angle of its ray to the
// plane of camera and edge. Signed.
double AngleBeside(const Eigen::Vector2d& pixel,
                   const Eigen::Vector2d& place,
                   const Pose2& X_LR,
                   const CameraDescription& camera) {
  const auto ray = RayFromPixel(camera.model, pixel);
  if (!ray) return 0.0;
  const Eigen::Vector3d axis = AxisIn(X_LR.heading);
  const Eigen::Vector3d to_edge =
      (place.x() - X_LR.y) * AcrossIn(X_LR.heading) +
      place.y() * Eigen::Vector3d::UnitZ() - camera.X_RC.translation();
  const Eigen::Vector3d normal = axis.cross(to_edge).normalized();
  const Eigen::Vector3d ray_R = camera.X_RC.linear() * ray->ray.normalized();
  return std::asin(normal.dot(ray_R));
}

// What each edge was seen in, and how far beside it that lies in truth; and
// what of that explains the error.
std::string SupportOf(const CorridorPoseFrame& frame,
                      const CorridorEstimate& found,
                      const CorridorGeometry& corridor,
                      const CameraDescription& camera) {
  constexpr double kPixelsOfRadian = 457.0;  // Of the frames' lens.
  // A line farther beside its edge is another thing's: a gap, a shadow, a thing
  // that stands along the wall.
  constexpr double kOtherPx = 1.0;
  std::string text;
  std::string why;
  double most_beside = kOtherPx;
  double seen_px = 0.0;
  for (const CorridorEdge edge : kCorridorEdges) {
    const auto place = PlaceOf(edge, corridor);
    if (!place) continue;
    double length = 0.0;
    double farthest = 0.0;
    int num = 0;
    for (const CorridorLine& line : found.lines) {
      if (!line.is_used || line.edge != edge) continue;
      ++num;
      length += (line.line.b - line.line.a).norm();
      const double beside =
          kPixelsOfRadian *
          AngleBeside(
              0.5 * (line.line.a + line.line.b), *place, frame.X_LR, camera);
      if (std::abs(beside) > std::abs(farthest)) farthest = beside;
    }
    if (num == 0) continue;
    seen_px += length;
    if (std::abs(farthest) > most_beside) {
      most_beside = std::abs(farthest);
      why = fmt::format(
          "Why: what was taken for {} lies {:.1f} px beside it, and is another "
          "line",
          NameOf(edge),
          most_beside);
    }
    text += fmt::format("{}{}: {} lines, {:.0f} px, up to {:.1f} px beside it",
                        text.empty() ? "" : "; ",
                        NameOf(edge),
                        num,
                        length,
                        std::abs(farthest));
  }
  if (why.empty()) {
    why = fmt::format(
        "Why: all lines are those of the edges, but {:.0f} px of them say "
        "little "
        "about where, and their small errors much",
        seen_px);
  }
  return why + ". Seen: " + text;
}

}  // namespace

void WorstFrames::Add(const std::string& name,
                      const CorridorPoseFrame& frame,
                      const CorridorEstimate& found,
                      const CorridorGeometry& corridor,
                      const CameraDescription& camera) {
  if (found.status != CorridorStatus::kAccepted) return;
  const double y = found.y.value() - frame.X_LR.y;
  const double heading = WrapAngle(found.heading.value() - frame.X_LR.heading);
  const double badness =
      std::max(std::abs(y) / 0.03, std::abs(heading) / RadiansFromDegrees(0.5));
  if (kept_.size() == num_kept_ && badness <= kept_.back().badness) return;
  Kept kept;
  kept.badness = badness;
  kept.picture =
      DrawCorridor(frame.image, found, {camera.model, camera.X_RC, corridor});
  kept.caption = fmt::format(
      "{}, at x {:.2f} m, y {:.3f} m, {:.1f} deg: off by {:.1f} mm ({:.1f} "
      "sigma) and {:.3f} deg ({:.1f} sigma). Believed before: off by {:.0f} mm "
      "and {:.1f} deg. {}.",
      name,
      frame.X_LR.x,
      frame.X_LR.y,
      DegreesFromRadians(frame.X_LR.heading),
      1e3 * y,
      std::abs(y) / std::sqrt(found.covariance(0, 0)),
      DegreesFromRadians(heading),
      std::abs(heading) / std::sqrt(found.covariance(1, 1)),
      1e3 * (frame.prior.X_LR.y - frame.X_LR.y),
      DegreesFromRadians(
          WrapAngle(frame.prior.X_LR.heading - frame.X_LR.heading)),
      SupportOf(frame, found, corridor, camera));
  kept_.push_back(std::move(kept));
  std::stable_sort(
      kept_.begin(), kept_.end(), [](const Kept& a, const Kept& b) {
        return a.badness > b.badness;
      });
  if (kept_.size() > num_kept_) kept_.pop_back();
}

void WorstFrames::Write(const std::string& path) const {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
      "<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\"/>\n"
      "<title>The worst answers</title>\n<style>\n" +
      std::string(kReportStyle) +
      "</style>\n</head>\n<body>\n<header>\n<h1>The worst answers</h1>\n"
      "<p>Corridor poses from rendered frames: of those accepted, the farthest "
      "from the truth. Broad pale strokes: where the corridor's edges are by "
      "the answer. Thick lines: what it rests on.</p>\n</header>\n<main>\n"
      "<section>\n<div class=\"plots wide\">\n";
  for (const Kept& kept : kept_) {
    ImageFile file;
    file.extension = ".png";
    cv::imencode(".png", kept.picture, file.bytes);
    page += HtmlFigure(kept.caption, file);
  }
  page += "</div>\n</section>\n</main>\n</body>\n</html>\n";
  std::filesystem::create_directories(
      std::filesystem::path(path).parent_path());
  std::ofstream out(path, std::ios::binary);
  out << page;
  out.flush();
  if (!out) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace waymark
