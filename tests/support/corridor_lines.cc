#include "tests/support/corridor_lines.h"

#include "estimation/camera/pan_tilt_mount.h"
#include "estimation/geometry/pose3.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace waymark {
namespace {

std::vector<Piece3> PiecesOf(const CorridorGeometry& corridor,
                             const CorridorLinesOptions& options) {
  std::vector<Piece3> pieces;
  const double half = 0.5 * corridor.width.value_or(2.0);
  const double height = corridor.height.value_or(2.5);
  const auto along = [&](double y, double z) {
    pieces.push_back({{options.x_from, y, z}, {options.x_to, y, z}});
  };
  for (const double y : {half, -half}) {
    along(y, 0.0);
    if (options.has_ceiling) along(y, height);
    if (options.has_skirting) along(y, corridor.skirting_height.value_or(0.08));
  }
  if (!options.has_clutter) return pieces;
  for (double x = options.x_from + 1.0; x < options.x_to; x += 3.0) {
    for (const double y : {0.31, -0.29}) {  // A lamp.
      pieces.push_back({{x, y, height}, {x + 0.6, y, height}});
    }
    pieces.push_back({{x, -0.29, height}, {x, 0.31, height}});
    pieces.push_back({{x, half, 0.0}, {x, half, 2.05}});  // A door's frame.
    pieces.push_back({{x + 0.9, half, 0.0}, {x + 0.9, half, 2.05}});
    pieces.push_back({{x, half, 2.05}, {x + 0.9, half, 2.05}});
    pieces.push_back({{x, -half, 1.1}, {x + 0.7, -half, 1.1}});  // A picture.
    pieces.push_back({{x, -half, 1.7}, {x + 0.7, -half, 1.7}});
  }
  for (const double y : {0.43, -0.17}) along(y, 0.0);  // Tiles.
  pieces.push_back({{options.x_to, -half, 0.0}, {options.x_to, half, 0.0}});
  return pieces;
}

// In front of the camera; nullopt where nothing is.
std::optional<Piece3> InFront(Piece3 piece_C) {
  constexpr double kNear = 0.05;
  if (piece_C.a_L.z() < kNear && piece_C.b_L.z() < kNear) return std::nullopt;
  for (int k = 0; k < 2; ++k) {
    if (piece_C.a_L.z() < kNear) {
      const double share =
          (kNear - piece_C.a_L.z()) / (piece_C.b_L.z() - piece_C.a_L.z());
      piece_C.a_L += share * (piece_C.b_L - piece_C.a_L);
    }
    std::swap(piece_C.a_L, piece_C.b_L);
  }
  return piece_C;
}

// Within the image, by Liang and Barsky.
std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> Clip(
    const Eigen::Vector2d& a, const Eigen::Vector2d& b, const ImageSize& size) {
  double from = 0.0;
  double to = 1.0;
  const Eigen::Vector2d way = b - a;
  const Eigen::Vector2d high(size.width - 1, size.height - 1);
  for (int k = 0; k < 2; ++k) {
    for (const auto& [slope, room] :
         {std::pair(-way(k), a(k)), std::pair(way(k), high(k) - a(k))}) {
      if (slope == 0.0) {
        if (room < 0.0) return std::nullopt;
        continue;
      }
      const double share = room / slope;
      if (slope < 0.0) from = std::max(from, share);
      if (slope > 0.0) to = std::min(to, share);
    }
  }
  if (from >= to) return std::nullopt;
  return std::pair(Eigen::Vector2d(a + from * way),
                   Eigen::Vector2d(a + to * way));
}

}  // namespace

CorridorView ViewForTests(double tilt, double yaw) {
  CorridorView view;
  view.intrinsics = {457.0, 460.0, 321.0, 238.0};
  view.size = {640, 480};
  PanTiltMount mount;
  mount.X_RH.translation() << 0.13, -0.04, 0.6;
  view.X_RC = mount.CameraOnRobot(yaw, tilt);
  return view;
}

LineSet SeeCorridor(const CorridorView& view,
                    const CorridorGeometry& corridor,
                    const Pose2& X_LR,
                    const CorridorLinesOptions& options) {
  const Eigen::Isometry3d X_CL = (SpatialPose(X_LR) * view.X_RC).inverse();
  const auto pixel = [&](const Eigen::Vector3d& p_C) -> Eigen::Vector2d {
    const Intrinsics& k = view.intrinsics;
    return {k.fx * p_C.x() / p_C.z() + k.cx, k.fy * p_C.y() / p_C.z() + k.cy};
  };
  Random random(options.seed);
  LineSet set;
  for (const Piece3& piece : PiecesOf(corridor, options)) {
    const auto seen = InFront({X_CL * piece.a_L, X_CL * piece.b_L});
    if (!seen) continue;
    const auto ends = Clip(pixel(seen->a_L), pixel(seen->b_L), view.size);
    constexpr double kShortest = 15.0;  // px.
    if (!ends || (ends->second - ends->first).norm() < kShortest) continue;
    LineSegment segment;
    segment.a = ends->first;
    segment.b = ends->second;
    const Eigen::Vector2d way = segment.b - segment.a;
    const Eigen::Vector2d normal =
        Eigen::Vector2d(-way.y(), way.x()).normalized();
    segment.a += random.Normal(options.noise_px) * normal;
    segment.b += random.Normal(options.noise_px) * normal;
    // Of two ends, each known so well.
    segment.sigma_px = options.sigma_px / std::sqrt(2.0);
    segment.sigma_rad = options.sigma_px * std::sqrt(2.0) / way.norm();
    set.segments.push_back(segment);
  }
  return set;
}

}  // namespace waymark
