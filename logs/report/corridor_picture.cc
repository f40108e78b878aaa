#include "logs/report/corridor_picture.h"

#include "estimation/base/check.h"
#include "estimation/corridor/corridor_view.h"
#include "estimation/geometry/angle.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace waymark {
namespace {

constexpr int kShift = 4;  // Sixteenths of a pixel.
const double kMaxMiss = RadiansFromDegrees(1.0);

cv::Scalar Bgr(const PictureColor& color) {
  return {static_cast<double>(color[2]),
          static_cast<double>(color[1]),
          static_cast<double>(color[0])};
}

cv::Point PointOf(const Eigen::Vector2d& pixel) {
  constexpr double kScale = 1 << kShift;
  return {static_cast<int>(std::lround(pixel.x() * kScale)),
          static_cast<int>(std::lround(pixel.y() * kScale))};
}

// Within the image or a width around it: what is farther is not drawn.
bool IsNear(const Eigen::Vector2d& pixel, const cv::Size& size) {
  return pixel.x() > -size.width && pixel.x() < 2 * size.width &&
         pixel.y() > -size.height && pixel.y() < 2 * size.height;
}

std::optional<Eigen::Vector2d> PixelOf(const CorridorScene& scene,
                                       const Eigen::Vector3d& point_R) {
  const auto projection =
      PixelFromRay(scene.camera, scene.X_RC.inverse() * point_R);
  if (!projection) return std::nullopt;
  return projection->pixel;
}

std::optional<Eigen::Vector2d> PixelOfDirection(
    const CorridorScene& scene, const Eigen::Vector3d& direction_R) {
  const auto projection =
      PixelFromRay(scene.camera, scene.X_RC.linear().transpose() * direction_R);
  if (!projection) return std::nullopt;
  return projection->pixel;
}

using Path = std::vector<std::optional<Eigen::Vector2d>>;

// Each `step`-th piece: 2 is dashed.
void DrawPath(const Path& path,
              const cv::Scalar& color,
              int thickness,
              std::size_t step,
              cv::Mat3b* canvas) {
  for (std::size_t i = 1; i < path.size(); i += step) {
    const auto& a = path[i - 1];
    const auto& b = path[i];
    if (!a || !b || !IsNear(*a, canvas->size()) ||
        !IsNear(*b, canvas->size())) {
      continue;
    }
    cv::line(*canvas,
             PointOf(*a),
             PointOf(*b),
             color,
             thickness,
             cv::LINE_AA,
             kShift);
  }
}

// Between the ends as the lens bends it: the plane of sight is the same.
Path PathOf(const LineSegment& line, const CorridorScene& scene) {
  const auto from = RayFromPixel(scene.camera, line.a);
  const auto to = RayFromPixel(scene.camera, line.b);
  if (!from || !to) return {line.a, line.b};
  constexpr double kPiecePx = 12.0;
  const int num =
      1 + static_cast<int>(std::min((line.b - line.a).norm(), 1e4) / kPiecePx);
  Path path;
  for (int i = 0; i <= num; ++i) {
    const double s = static_cast<double>(i) / num;
    const auto projection =
        PixelFromRay(scene.camera, (1.0 - s) * from->ray + s * to->ray);
    path.push_back(projection ? std::optional(projection->pixel)
                              : std::nullopt);
  }
  return path;
}

void DrawLines(const CorridorEstimate& estimate,
               const CorridorScene& scene,
               cv::Mat3b* canvas) {
  // The least telling ones first: others are drawn over them.
  for (const LineUse use : {LineUse::kOther,
                            LineUse::kVertical,
                            LineUse::kAcross,
                            LineUse::kAlong}) {
    for (const CorridorLine& line : estimate.lines) {
      if (UseOf(line, scene, estimate.heading) != use) continue;
      const int thickness = line.is_used ? 3 : 1;
      DrawPath(
          PathOf(line.line, scene), Bgr(ColorOf(use)), thickness, 1, canvas);
    }
  }
}

// How far ahead and behind an edge is drawn, m: all that one can see.
constexpr double kReach = 60.0;

void DrawPredicted(const CorridorEstimate& estimate,
                   const CorridorScene& scene,
                   cv::Mat3b* canvas) {
  if (!estimate.y || !estimate.heading || !scene.corridor) return;
  const Eigen::Isometry3d X_RL =
      (Eigen::Translation3d(0.0, *estimate.y, 0.0) *
       Eigen::AngleAxisd(*estimate.heading, Eigen::Vector3d::UnitZ()))
          .inverse();
  cv::Mat3b overlay = canvas->clone();
  for (const CorridorEdge edge : {CorridorEdge::kFloorLeft,
                                  CorridorEdge::kFloorRight,
                                  CorridorEdge::kCeilingLeft,
                                  CorridorEdge::kCeilingRight,
                                  CorridorEdge::kSkirtingLeft,
                                  CorridorEdge::kSkirtingRight}) {
    const auto place = PlaceOf(edge, *scene.corridor);
    if (!place) continue;
    Path path;
    // Evenly in the image, about: steps grow with the distance.
    for (double s = -1.0; s <= 1.0; s += 1.0 / 128.0) {
      const double x = kReach * s * s * s;
      path.push_back(
          PixelOf(scene, X_RL * Eigen::Vector3d(x, place->x(), place->y())));
    }
    DrawPath(path, Bgr(kPredictedColor), 5, 1, &overlay);
  }
  constexpr double kShare = 0.4;
  cv::addWeighted(overlay, kShare, *canvas, 1.0 - kShare, 0.0, *canvas);
}

void DrawHorizon(const CorridorScene& scene, cv::Mat3b* canvas) {
  Path path;
  const Eigen::Vector3d forward = scene.X_RC.linear().col(2);
  const double middle = std::atan2(forward.y(), forward.x());
  for (double angle = -90.0; angle <= 90.0; angle += 0.5) {
    path.push_back(
        PixelOfDirection(scene, AxisIn(-(middle + RadiansFromDegrees(angle)))));
  }
  DrawPath(path, cv::Scalar(255, 255, 255), 1, 2, canvas);
}

// A ring with a point, or a wedge at the border that points there.
void DrawVanishingPoint(const Eigen::Vector2d& point, cv::Mat3b* canvas) {
  const cv::Scalar white(255, 255, 255);
  const cv::Scalar color = Bgr(kVanishingColor);
  const Eigen::Vector2d last(canvas->cols - 1, canvas->rows - 1);
  const Eigen::Vector2d inside =
      point.cwiseMax(Eigen::Vector2d::Zero()).cwiseMin(last);
  constexpr int kScale = 1 << kShift;
  if (inside == point) {
    for (const auto& [ink, thickness] :
         {std::pair(white, 4), std::pair(color, 2)}) {
      cv::circle(*canvas,
                 PointOf(point),
                 9 * kScale,
                 ink,
                 thickness,
                 cv::LINE_AA,
                 kShift);
    }
    cv::circle(*canvas,
               PointOf(point),
               2 * kScale,
               color,
               cv::FILLED,
               cv::LINE_AA,
               kShift);
    return;
  }
  const Eigen::Vector2d way = (point - inside).normalized();
  const Eigen::Vector2d side(-way.y(), way.x());
  const Eigen::Vector2d base = inside - 18.0 * way;
  const std::vector<cv::Point> wedge{
      PointOf(inside), PointOf(base + 8.0 * side), PointOf(base - 8.0 * side)};
  cv::fillConvexPoly(*canvas, wedge, color, cv::LINE_AA, kShift);
}

cv::Mat3b DarkerOf(const cv::Mat& image) {
  WAYMARK_CHECK(!image.empty() && image.depth() == CV_8U &&
                    (image.channels() == 1 || image.channels() == 3),
                image.type());
  cv::Mat3b canvas;
  if (image.channels() == 1) {
    cv::cvtColor(image, canvas, cv::COLOR_GRAY2BGR);
  } else {
    image.copyTo(canvas);
  }
  // Darker: all colours of the lines are bright.
  canvas.convertTo(canvas, -1, 0.62);
  return canvas;
}

}  // namespace

PictureColor ColorOf(LineUse use) {
  switch (use) {
    case LineUse::kAlong:
      return {61, 220, 132};
    case LineUse::kAcross:
      return {255, 145, 77};
    case LineUse::kVertical:
      return {92, 184, 255};
    case LineUse::kOther:
      break;
  }
  return {150, 150, 150};
}

LineUse UseOf(const CorridorLine& line,
              const CorridorScene& scene,
              const std::optional<double>& heading) {
  if (line.edge != CorridorEdge::kNone) return LineUse::kAlong;
  const auto from = RayFromPixel(scene.camera, line.line.a);
  const auto to = RayFromPixel(scene.camera, line.line.b);
  if (!from || !to) return LineUse::kOther;
  const Eigen::Vector3d normal_R =
      (scene.X_RC.linear() * from->ray.cross(to->ray)).normalized();
  const auto holds = [&](const Eigen::Vector3d& direction_R) {
    return std::abs(normal_R.dot(direction_R)) < std::sin(kMaxMiss);
  };
  if (holds(Eigen::Vector3d::UnitZ())) return LineUse::kVertical;
  if (heading && holds(AcrossIn(*heading))) return LineUse::kAcross;
  return LineUse::kOther;
}

cv::Mat3b DrawCorridor(const cv::Mat& image,
                       const CorridorEstimate& estimate,
                       const CorridorScene& scene) {
  cv::Mat3b canvas = DarkerOf(image);
  DrawHorizon(scene, &canvas);
  DrawPredicted(estimate, scene, &canvas);
  DrawLines(estimate, scene, &canvas);
  if (estimate.vanishing_point) {
    DrawVanishingPoint(*estimate.vanishing_point, &canvas);
  }
  return canvas;
}

}  // namespace waymark
