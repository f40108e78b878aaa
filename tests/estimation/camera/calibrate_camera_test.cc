#include "estimation/camera/calibrate_camera.h"

#include "estimation/base/random.h"
#include "estimation/camera/board_pose.h"
#include "estimation/geometry/angle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

const ImageSize kSize{1280, 1024};

struct Case {
  std::string name;
  CameraModel camera;
  CalibrationOptions options;
};

std::vector<Case> Cases() {
  const auto options = [](CameraKind kind, int num_distortion) {
    CalibrationOptions o;
    o.kind = kind;
    o.size = kSize;
    o.num_distortion = num_distortion;
    return o;
  };
  std::vector<Case> cases{
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
      {"parabolic mirror",
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
      points.emplace_back(0.042 * column, 0.042 * row);
    }
  }
  return points;
}

// Looks at the camera from somewhere along a ray, tilted up to `tilt`.
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
  const Eigen::Vector3d middle(3.5 * 0.042, 2.5 * 0.042, 0.0);
  X_CB.translation() = random->Uniform(0.35, 0.7) * ray - R * middle;
  return X_CB;
}

struct Scene {
  std::vector<BoardView> views;
  std::vector<Eigen::Isometry3d> poses;
};

// Boards all over the image, whole ones only.
Scene MakeScene(const CameraModel& camera,
                int num_views,
                double noise_px,
                double tilt,
                Random* random) {
  Scene scene;
  while (static_cast<int>(scene.views.size()) < num_views) {
    const Eigen::Vector2d pixel(random->Uniform(0.0, kSize.width),
                                random->Uniform(0.0, kSize.height));
    const auto back = RayFromPixel(camera, pixel);
    if (!back) continue;
    const Eigen::Isometry3d X_CB = RandomBoard(back->ray, tilt, random);
    BoardView view;
    view.points_B = BoardPoints();
    for (const Eigen::Vector2d& point : view.points_B) {
      const auto seen =
          PixelFromRay(camera, X_CB * Eigen::Vector3d(point.x(), point.y(), 0));
      if (!seen || !IsInside(kSize, seen->pixel)) break;
      view.pixels.push_back(
          seen->pixel +
          Eigen::Vector2d(random->Normal(noise_px), random->Normal(noise_px)));
    }
    if (view.pixels.size() != view.points_B.size()) continue;
    scene.views.push_back(std::move(view));
    scene.poses.push_back(X_CB);
  }
  return scene;
}

constexpr double kTilt = 0.7;

class CalibrateCameraTest : public testing::TestWithParam<Case> {};

TEST_P(CalibrateCameraTest, ExactCornersGiveTheCamera) {
  Random random(5);
  const Scene scene = MakeScene(GetParam().camera, 8, 0.0, kTilt, &random);
  const auto report = CalibrateCamera(scene.views, GetParam().options);
  ASSERT_TRUE(report.result) << report.reason;
  const Eigen::VectorXd truth = ParametersOf(GetParam().camera);
  const Eigen::VectorXd found = ParametersOf(report.result->camera);
  // What 14 digits of the cost leave of the parameters.
  EXPECT_LT((found - truth).cwiseAbs().head<4>().maxCoeff(), 1e-4);
  EXPECT_LT((found - truth).cwiseAbs().tail(found.size() - 4).maxCoeff(), 1e-6);
  EXPECT_LT(report.result->rms_px, 1e-6);
  for (std::size_t v = 0; v < scene.poses.size(); ++v) {
    EXPECT_LT((report.result->views[v].X_CB.matrix() - scene.poses[v].matrix())
                  .norm(),
              1e-6);
    EXPECT_EQ(report.result->views[v].num_used, 48);
  }
}

// Normalised by the stated sigmas the errors are of variance one.
TEST_P(CalibrateCameraTest, ErrorsAreAsLargeAsStated) {
  constexpr double kNoise = 0.3;
  constexpr int kSeeds = 12;
  const Eigen::VectorXd truth = ParametersOf(GetParam().camera);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(truth.size());
  Eigen::VectorXd sigma;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random(Random(static_cast<std::uint64_t>(seed)).Bits());
    const Scene scene = MakeScene(GetParam().camera, 8, kNoise, kTilt, &random);
    const auto report = CalibrateCamera(scene.views, GetParam().options);
    ASSERT_TRUE(report.result) << seed << ": " << report.reason;
    // 2 x 8 x 48 residuals: 3 % of spread, five sigma.
    EXPECT_NEAR(report.result->sigma_px, kNoise, 0.15 * kNoise);
    sigma = report.result->sigma;
    const Eigen::VectorXd error = ParametersOf(report.result->camera) - truth;
    for (Eigen::Index i = 0; i < truth.size(); ++i) {
      if (sigma(i) > 0.0) sum(i) += std::pow(error(i) / sigma(i), 2);
    }
  }
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    if (sigma(i) == 0.0) continue;
    // Chi-square of 12 degrees over 12; 99.98 %, since there are many numbers.
    EXPECT_GT(sum(i) / kSeeds, 0.14)
        << ParameterNames(GetParam().options.kind)[static_cast<std::size_t>(i)];
    EXPECT_LT(sum(i) / kSeeds, 3.3)
        << ParameterNames(GetParam().options.kind)[static_cast<std::size_t>(i)];
  }
}

TEST_P(CalibrateCameraTest, CornersThatAreOffAreLeftOut) {
  Random random(6);
  Scene scene = MakeScene(GetParam().camera, 8, 0.2, kTilt, &random);
  for (const std::size_t v : {1u, 4u}) {
    scene.views[v].pixels[7 * v] += Eigen::Vector2d(6.0, -5.0);
  }
  const auto report = CalibrateCamera(scene.views, GetParam().options);
  ASSERT_TRUE(report.result) << report.reason;
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    EXPECT_EQ(report.result->views[v].num_left_out, v == 1 || v == 4 ? 1 : 0);
  }
  EXPECT_LT(report.result->rms_px, 0.35);
}

INSTANTIATE_TEST_SUITE_P(Models,
                         CalibrateCameraTest,
                         testing::ValuesIn(Cases()),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           for (char& c : name) {
                             if (c == ' ') c = '_';
                           }
                           return name;
                         });

TEST(CalibrateCamera, ParallelBoardsDoNotShowTheFocalLength) {
  Random random(8);
  const Case perspective = Cases()[0];
  Scene scene;
  for (int i = 0; i < 6; ++i) {
    Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
    X_CB.translation() << 0.05 * i - 0.25, 0.03 * i - 0.15, 0.6;
    BoardView view;
    view.points_B = BoardPoints();
    for (const Eigen::Vector2d& point : view.points_B) {
      const auto seen =
          PixelFromRay(PerspectiveCamera({901.0, 905.0, 652.0, 498.0}),
                       X_CB * Eigen::Vector3d(point.x(), point.y(), 0));
      view.pixels.push_back(seen->pixel + Eigen::Vector2d(random.Normal(0.2),
                                                          random.Normal(0.2)));
    }
    scene.views.push_back(std::move(view));
  }
  const auto report = CalibrateCamera(scene.views, perspective.options);
  EXPECT_FALSE(report.result);
  EXPECT_THAT(report.reason, HasSubstr("do not show all parameters"));
}

TEST(CalibrateCamera, NonsenseHasAReason) {
  const Case perspective = Cases()[0];
  EXPECT_THAT(CalibrateCamera({}, perspective.options).reason,
              HasSubstr("fewer than two views"));
  Random random(9);
  Scene scene = MakeScene(perspective.camera, 3, 0.0, kTilt, &random);
  scene.views[1].pixels.resize(3);
  EXPECT_THROW((void)CalibrateCamera(scene.views, perspective.options),
               std::invalid_argument);
  scene.views[1].points_B.resize(3);
  EXPECT_THAT(CalibrateCamera(scene.views, perspective.options).reason,
              HasSubstr("fewer than four corners"));
  // Pixels anywhere.
  scene = MakeScene(perspective.camera, 3, 0.0, kTilt, &random);
  for (BoardView& view : scene.views) {
    for (Eigen::Vector2d& pixel : view.pixels) {
      pixel = {random.Uniform(0, kSize.width), random.Uniform(0, kSize.height)};
    }
  }
  EXPECT_FALSE(CalibrateCamera(scene.views, perspective.options).result);
  CalibrationOptions options = perspective.options;
  options.xi = 1.0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = perspective.options;
  options.num_distortion = 6;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

TEST(BoardPoseFromRays, IsExactAllAroundTheCamera) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d ray =
        Eigen::Vector3d(
            random.Normal(1.0), random.Normal(1.0), random.Normal(1.0))
            .normalized();
    const Eigen::Isometry3d X_CB = RandomBoard(ray, kTilt, &random);
    std::vector<Eigen::Vector3d> rays;
    const std::vector<Eigen::Vector2d> points = BoardPoints();
    for (const Eigen::Vector2d& point : points) {
      rays.push_back(
          (X_CB * Eigen::Vector3d(point.x(), point.y(), 0)).normalized());
    }
    const auto found = BoardPoseFromRays(rays, points);
    ASSERT_TRUE(found) << i;
    // A normal matrix has half of the sixteen digits.
    EXPECT_LT((found->matrix() - X_CB.matrix()).norm(), 1e-6);
  }
}

TEST(BoardPoseFromRays, PointsOnALineTellNothing) {
  std::vector<Eigen::Vector3d> rays;
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 6; ++i) {
    points.emplace_back(0.1 * i, 0.05 * i);
    rays.push_back(Eigen::Vector3d(0.1 * i, 0.05 * i, 1.0).normalized());
  }
  EXPECT_FALSE(BoardPoseFromRays(rays, points));
}

}  // namespace
}  // namespace waymark
