#include "drivers/simulator/mover_tiles.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace waymark {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kHalfTurn = std::numbers::pi_v<float>;

// The directions from a point to all points of a ball.
struct Sight {
  Vector3f axis_C = Vector3f::UnitZ();
  float half_angle = kHalfTurn;
};

Sight SightOf(const Vector3d& middle_C, double radius) {
  const double distance = middle_C.norm();
  if (distance <= radius) return {};
  return {(middle_C / distance).cast<float>(),
          static_cast<float>(std::asin(radius / distance))};
}

}  // namespace

MoverTiles::MoverTiles(const Scene& scene) {
  for (const SceneMover& mover : scene.movers) {
    std::vector<Ball>& balls = balls_.emplace_back();
    if (mover.mesh.positions.empty()) continue;
    double square = 0.0;  // Of the upright cylinder about the mesh.
    double low = mover.mesh.positions[0].z();
    double high = low;
    for (const Vector3f& p : mover.mesh.positions) {
      const Vector3d p_P = p.cast<double>();
      square = std::max(square, p_P.head<2>().squaredNorm());
      low = std::min(low, p_P.z());
      high = std::max(high, p_P.z());
    }
    const double radius = std::sqrt(square);
    // Slices about as high as they are wide; more than this make no use.
    constexpr double kMostBalls = 8.0;
    const int num = static_cast<int>(std::clamp(
        std::ceil((high - low) / (2.0 * radius + 1e-3)), 1.0, kMostBalls));
    const double half = 0.5 * (high - low) / num;
    // Above the roundings of floats within a kilometre.
    constexpr double kRoom = 1e-3;
    for (int i = 0; i < num; ++i) {
      balls.push_back({Vector3d(0.0, 0.0, low + (2 * i + 1) * half),
                       std::hypot(radius, half) + kRoom});
    }
  }
}

std::vector<std::uint8_t> MoverTiles::Near(
    const CameraRays& camera,
    const Isometry3d& X_WC,
    std::span<const Isometry3d> X_WP) const {
  WAYMARK_CHECK(X_WP.size() == balls_.size(),
                X_WP.size(),
                "poses for",
                balls_.size(),
                "movers");
  std::vector<Sight> sights;
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    const Isometry3d X_CP = X_WC.inverse() * X_WP[i];
    for (const Ball& ball : balls_[i]) {
      sights.push_back(SightOf(X_CP * ball.middle_P, ball.radius));
    }
  }
  std::vector<std::uint8_t> near;
  near.reserve(camera.cones().size());
  for (const CameraRays::Cone& cone : camera.cones()) {
    const auto may_see = [&](const Sight& sight) {
      const float reach = cone.half_angle + sight.half_angle;
      // Far smaller than the room in both angles.
      constexpr float kRounding = 1e-5f;
      return reach >= kHalfTurn ||
             cone.axis_C.dot(sight.axis_C) >= std::cos(reach) - kRounding;
    };
    near.push_back(cone.half_angle >= 0.0f &&
                           std::any_of(sights.begin(), sights.end(), may_see)
                       ? 1
                       : 0);
  }
  return near;
}

}  // namespace waymark
