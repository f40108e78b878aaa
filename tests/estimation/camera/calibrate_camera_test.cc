#include "estimation/camera/calibrate_camera.h"

#include "estimation/base/random.h"
#include "estimation/camera/board_pose.h"
#include "tests/support/board_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

BoardScene MakeScene(const CalibrationCase& c,
                     int num_views,
                     double noise_px,
                     Random* random) {
  return MakeBoardScene(c.camera, c.options.size, num_views, noise_px, random);
}

class CalibrateCameraTest : public testing::TestWithParam<CalibrationCase> {};

TEST_P(CalibrateCameraTest, ExactCornersGiveTheCamera) {
  Random random(5);
  const BoardScene scene = MakeScene(GetParam(), 8, 0.0, &random);
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
    const BoardScene scene = MakeScene(GetParam(), 8, kNoise, &random);
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
  BoardScene scene = MakeScene(GetParam(), 8, 0.2, &random);
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
                         testing::ValuesIn(CalibrationCases()),
                         [](const auto& test) { return test.param.name; });

struct EdgeCase {
  CameraModel camera;
  int num_distortion = 0;
  std::uint64_t seed = 0;
};

// Boards up to where the lens folds its image over: on the way there the
// minimiser's cameras do not reach all corners, and may tip a board over.
// Each of these once ended in a wrong lens or none.
TEST(CalibrateCamera, FindsLensesThatEndAtTheImagesEdge) {
  constexpr double kNoise = 0.3;
  const FisheyeCamera fisheye({400.0, 401.0, 633.0, 520.0},
                              {-0.1, 0.0, 0.0, 0.0});
  const PerspectiveCamera barrel({600.0, 602.0, 640.0, 512.0}, {-0.3});
  const SphereCamera sphere(
      1.3, {600.0, 602.0, 640.0, 512.0}, {-0.1, 0.02, 1e-3, -1e-3});
  const std::vector<EdgeCase> cases{{fisheye, 4, 31},
                                    {fisheye, 4, 77},
                                    {barrel, 2, 24},
                                    {barrel, 5, 8},
                                    {barrel, 5, 91},
                                    {sphere, 4, 46}};
  for (const EdgeCase& c : cases) {
    CalibrationOptions options;
    options.kind = KindOf(c.camera);
    options.size = {1280, 1024};
    options.num_distortion = c.num_distortion;
    Random random(Random(c.seed).Bits());
    const BoardScene scene =
        MakeBoardScene(c.camera, options.size, 8, kNoise, &random);
    const auto report = CalibrateCamera(scene.views, options);
    ASSERT_TRUE(report.result) << c.seed << ": " << report.reason;
    // 2 x 8 x 48 residuals: 3 % of spread, five sigma.
    EXPECT_NEAR(report.result->sigma_px, kNoise, 0.15 * kNoise) << c.seed;
    const Eigen::VectorXd error =
        ParametersOf(report.result->camera) - ParametersOf(c.camera);
    // Of some 50 numbers none is beyond five sigmas.
    for (Eigen::Index i = 0; i < error.size(); ++i) {
      EXPECT_LE(std::abs(error(i)), 5.0 * report.result->sigma(i)) << c.seed;
    }
  }
}

TEST(CalibrateCamera, ParallelBoardsDoNotShowTheFocalLength) {
  Random random(8);
  const CalibrationCase perspective = CalibrationCases()[0];
  BoardScene scene;
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
  const CalibrationCase perspective = CalibrationCases()[0];
  EXPECT_THAT(CalibrateCamera({}, perspective.options).reason,
              HasSubstr("fewer than two views"));
  Random random(9);
  BoardScene scene = MakeScene(perspective, 3, 0.0, &random);
  scene.views[1].pixels.resize(3);
  EXPECT_THROW((void)CalibrateCamera(scene.views, perspective.options),
               std::invalid_argument);
  scene.views[1].points_B.resize(3);
  EXPECT_THAT(CalibrateCamera(scene.views, perspective.options).reason,
              HasSubstr("fewer than four corners"));
  // Pixels anywhere.
  scene = MakeScene(perspective, 3, 0.0, &random);
  for (BoardView& view : scene.views) {
    for (Eigen::Vector2d& pixel : view.pixels) {
      pixel = {random.Uniform(0, perspective.options.size.width),
               random.Uniform(0, perspective.options.size.height)};
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
    const Eigen::Isometry3d X_CB = RandomBoard(ray, 0.7, &random);
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
