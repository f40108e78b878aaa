#include "estimation/corridor/corridor_view.h"

#include "estimation/geometry/angle.h"

#include <cmath>

namespace waymark {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// From the middle of a line to a homogeneous pixel, times its third component.
Eigen::Vector2d WayTo(const SeenLine& line, const Eigen::Vector3d& pixel) {
  return pixel.head<2>() - pixel.z() * line.middle;
}

// In (-pi / 2, pi / 2].
double ModuloPi(double angle) {
  angle = WrapAngle(angle);
  if (angle > 0.5 * kPi) return angle - kPi;
  return angle <= -0.5 * kPi ? angle + kPi : angle;
}

}  // namespace

Eigen::Vector3d CorridorView::PixelOf(
    const Eigen::Vector3d& direction_R) const {
  const Eigen::Vector3d d_C = X_RC.linear().transpose() * direction_R;
  return {intrinsics.fx * d_C.x() + intrinsics.cx * d_C.z(),
          intrinsics.fy * d_C.y() + intrinsics.cy * d_C.z(),
          d_C.z()};
}

Eigen::Vector3d CorridorView::RayOf(const Eigen::Vector2d& pixel) const {
  return X_RC.linear() *
         Eigen::Vector3d((pixel.x() - intrinsics.cx) / intrinsics.fx,
                         (pixel.y() - intrinsics.cy) / intrinsics.fy,
                         1.0);
}

SeenLine SeenLineOf(const LineSegment& segment,
                    double model_px,
                    double model_rad) {
  SeenLine line;
  const Eigen::Vector2d way = segment.b - segment.a;
  line.middle = 0.5 * (segment.a + segment.b);
  line.length = way.norm();
  line.direction = line.length > 0.0 ? Eigen::Vector2d(way / line.length)
                                     : Eigen::Vector2d(1.0, 0.0);
  line.sigma_px = std::hypot(segment.sigma_px, model_px);
  line.sigma_rad = std::hypot(segment.sigma_rad, model_rad);
  return line;
}

Eigen::Vector3d AxisIn(double heading) {
  return {std::cos(heading), -std::sin(heading), 0.0};
}

Eigen::Vector3d AcrossIn(double heading) {
  return {std::sin(heading), std::cos(heading), 0.0};
}

double VanishingResidual(const SeenLine& line,
                         const Eigen::Vector3d& vanishing_pixel) {
  const Eigen::Vector2d way = WayTo(line, vanishing_pixel);
  const double sigma = std::hypot(line.sigma_px * vanishing_pixel.z(),
                                  line.sigma_rad * way.norm());
  return Cross(line.direction, way) / sigma;
}

std::optional<LineHeading> HeadingOfLine(const CorridorView& view,
                                         const SeenLine& line,
                                         double direction_L) {
  // The direction in R, at heading h, is (cos a, sin a) with a = direction_L -
  // h; its vanishing pixel is linear in both, and on the line for one a.
  const double along = Cross(
      line.direction, WayTo(line, view.PixelOf(Eigen::Vector3d::UnitX())));
  const double left = Cross(
      line.direction, WayTo(line, view.PixelOf(Eigen::Vector3d::UnitY())));
  if (!(std::hypot(along, left) > 0.0)) return std::nullopt;
  const double angle = std::atan2(-along, left);
  const Eigen::Vector3d vanishing =
      view.PixelOf(Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0));
  const Eigen::Vector2d way = WayTo(line, vanishing);
  const double sigma =
      std::hypot(line.sigma_px * vanishing.z(), line.sigma_rad * way.norm());
  // d(along cos a + left sin a) / da there.
  const double slope = std::hypot(along, left);
  return LineHeading{ModuloPi(direction_L - angle), sigma / slope};
}

std::optional<Eigen::Vector2d> PlaceOf(CorridorEdge edge,
                                       const CorridorGeometry& corridor) {
  if (!corridor.width) return std::nullopt;
  const double half = 0.5 * *corridor.width;
  // The floor ends where the board begins, which hides the wall's foot.
  const double foot =
      half - (corridor.skirting_height ? corridor.skirting_depth : 0.0);
  const auto at = [](double y, const std::optional<double>& z) {
    return z ? std::optional(Eigen::Vector2d(y, *z)) : std::nullopt;
  };
  switch (edge) {
    case CorridorEdge::kFloorLeft:
      return at(foot, 0.0);
    case CorridorEdge::kFloorRight:
      return at(-foot, 0.0);
    case CorridorEdge::kCeilingLeft:
      return at(half, corridor.height);
    case CorridorEdge::kCeilingRight:
      return at(-half, corridor.height);
    case CorridorEdge::kSkirtingLeft:
      return at(half, corridor.skirting_height);
    case CorridorEdge::kSkirtingRight:
      return at(-half, corridor.skirting_height);
    case CorridorEdge::kNone:
    case CorridorEdge::kAlong:
      break;
  }
  return std::nullopt;
}

Eigen::Vector2d RayAcross(const CorridorView& view,
                          const Eigen::Vector2d& pixel,
                          double heading) {
  const Eigen::Vector3d ray_R = view.RayOf(pixel);
  return {ray_R.dot(AcrossIn(heading)), ray_R.z()};
}

Eigen::Vector2d CameraIn(const CorridorView& view, double y, double heading) {
  const Eigen::Vector3d p_RC = view.X_RC.translation();
  return {y + std::sin(heading) * p_RC.x() + std::cos(heading) * p_RC.y(),
          p_RC.z()};
}

std::optional<Eigen::Vector3d> ImageOfEdge(const CorridorView& view,
                                           const Eigen::Vector2d& place,
                                           double y,
                                           double heading) {
  const Eigen::Vector2d to_edge = place - CameraIn(view, y, heading);
  // Two directions of the plane through the camera and the edge.
  const Eigen::Vector3d axis = view.PixelOf(AxisIn(heading));
  const Eigen::Vector3d across = view.PixelOf(
      to_edge.x() * AcrossIn(heading) + to_edge.y() * Eigen::Vector3d::UnitZ());
  Eigen::Vector3d line = axis.cross(across);
  const double norm = line.head<2>().norm();
  if (!(norm > 0.0)) return std::nullopt;
  return line / norm;
}

}  // namespace waymark
