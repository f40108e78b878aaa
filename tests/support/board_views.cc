#include "tests/support/board_views.h"

#include "estimation/geometry/angle.h"

#include <utility>

namespace waymark {
namespace {

constexpr double kTilt = 0.7;    // rad.
constexpr double kSide = 0.042;  // Of a square, m.

}  // namespace

std::vector<CalibrationCase> CalibrationCases() {
  const auto options = [](CameraKind kind, int num_distortion) {
    CalibrationOptions o;
    o.kind = kind;
    o.size = {1280, 1024};
    o.num_distortion = num_distortion;
    return o;
  };
  std::vector<CalibrationCase> cases{
      {"perspective",
       PerspectiveCamera({901.0, 905.0, 652.0, 498.0},
                         {-0.21, 0.06, 8e-4, -5e-4, 0.0}),
       options(CameraKind::kPerspective, 4)},
      {"fisheye",
       FisheyeCamera({352.0, 351.0, 633.0, 520.0},
                     {0.03, -0.012, 0.004, -0.001}),
       options(CameraKind::kFisheye, 4)},
      {"mirror",
       SphereCamera(0.96, {330.0, -331.0, 641.0, 522.0}, {-0.05, 0.01}),
       options(CameraKind::kSphere, 2)},
      {"parabolic_mirror",
       SphereCamera(1.0, {330.0, -331.0, 641.0, 522.0}),
       options(CameraKind::kSphere, 0)}};
  cases[2].options.is_mirrored = true;
  cases[3].options.is_mirrored = true;
  cases[3].options.xi = 1.0;
  return cases;
}

std::vector<Eigen::Vector2d> BoardPoints() {
  std::vector<Eigen::Vector2d> points;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 8; ++column) {
      points.emplace_back(kSide * column, kSide * row);
    }
  }
  return points;
}

Eigen::Isometry3d RandomBoard(const Eigen::Vector3d& ray,
                              double tilt,
                              Random* random) {
  const Eigen::Vector3d side = ray.unitOrthogonal();
  Eigen::Matrix3d R;
  R << side, ray.cross(side), ray;
  R = R *
      Eigen::AngleAxisd(random->Uniform(-kPi, kPi), Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  R = R *
      Eigen::AngleAxisd(random->Uniform(-tilt, tilt), Eigen::Vector3d::UnitX())
          .toRotationMatrix();
  R = R *
      Eigen::AngleAxisd(random->Uniform(-tilt, tilt), Eigen::Vector3d::UnitY())
          .toRotationMatrix();
  Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
  X_CB.linear() = R;
  const Eigen::Vector3d middle(3.5 * kSide, 2.5 * kSide, 0.0);
  X_CB.translation() = random->Uniform(0.35, 0.7) * ray - R * middle;
  return X_CB;
}

BoardScene MakeBoardScene(const CameraModel& camera,
                          const ImageSize& size,
                          int num_views,
                          double noise_px,
                          Random* random) {
  BoardScene scene;
  while (static_cast<int>(scene.views.size()) < num_views) {
    // Apart, since arguments have no order of evaluation.
    const double u = random->Uniform(0.0, size.width);
    const double v = random->Uniform(0.0, size.height);
    const auto back = RayFromPixel(camera, {u, v});
    if (!back) continue;
    const Eigen::Isometry3d X_CB = RandomBoard(back->ray, kTilt, random);
    BoardView view;
    view.points_B = BoardPoints();
    for (const Eigen::Vector2d& point : view.points_B) {
      const auto seen =
          PixelFromRay(camera, X_CB * Eigen::Vector3d(point.x(), point.y(), 0));
      if (!seen || !IsInside(size, seen->pixel)) break;
      const double du = random->Normal(noise_px);
      const double dv = random->Normal(noise_px);
      view.pixels.push_back(seen->pixel + Eigen::Vector2d(du, dv));
    }
    if (view.pixels.size() != view.points_B.size()) continue;
    scene.views.push_back(std::move(view));
    scene.poses.push_back(X_CB);
  }
  return scene;
}

}  // namespace waymark
