#include "logs/report/corridor_picture.h"

#include "estimation/geometry/angle.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
const Intrinsics kLens{457.0, 457.0, 319.5, 239.5};

// Looks along R's x, tilted down, 60 cm above the floor.
CorridorScene Scene(const CameraModel& camera) {
  CorridorScene scene;
  scene.camera = camera;
  Eigen::Matrix3d looking;  // Of a camera that looks along x.
  looking << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  scene.X_RC =
      Eigen::Translation3d(0.1, 0.05, 0.6) *
      Eigen::AngleAxisd(RadiansFromDegrees(7.0), Eigen::Vector3d::UnitY()) *
      Eigen::Isometry3d(Eigen::Quaterniond(looking));
  return scene;
}

std::vector<CameraModel> Cameras() {
  LensDistortion lens;
  lens.k1 = -0.2;
  return {PerspectiveCamera(kLens), PerspectiveCamera(kLens, lens)};
}

Eigen::Vector2d PixelOf(const CorridorScene& scene,
                        const Eigen::Vector3d& point_R) {
  return PixelFromRay(scene.camera, scene.X_RC.inverse() * point_R)
      .value()
      .pixel;
}

CorridorLine LineOf(const CorridorScene& scene,
                    const Eigen::Vector3d& from_R,
                    const Eigen::Vector3d& to_R) {
  CorridorLine line;
  line.line.a = PixelOf(scene, from_R);
  line.line.b = PixelOf(scene, to_R);
  return line;
}

cv::Mat3b Black() {
  return cv::Mat3b(kHeight, kWidth, cv::Vec3b(0, 0, 0));
}

// Where a colour stands out in one channel: mean place, by weight, and how much
// of it there is within `radius` of `pixel`.
double InkNear(const cv::Mat3b& image,
               const Eigen::Vector2d& pixel,
               int radius) {
  double sum = 0.0;
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      if ((Eigen::Vector2d(u, v) - pixel).norm() > radius) continue;
      const cv::Vec3b& p = image(v, u);
      sum += p[0] + p[1] + p[2];
    }
  }
  return sum;
}

// A scene whose horizon is not in the image, for what else is drawn.
CorridorScene FloorScene() {
  CorridorScene scene = Scene(PerspectiveCamera(kLens));
  scene.X_RC.linear() =
      Eigen::AngleAxisd(RadiansFromDegrees(60.0), Eigen::Vector3d::UnitY()) *
      scene.X_RC.linear();
  return scene;
}

TEST(CorridorPictureTest, LinesLieWhereTheSegmentsAre) {
  for (const auto& [a, b] :
       {std::pair(Eigen::Vector2d(100.3, 80.7), Eigen::Vector2d(500.6, 200.1)),
        std::pair(Eigen::Vector2d(320.25, 20.0),
                  Eigen::Vector2d(320.25, 460.0)),
        std::pair(Eigen::Vector2d(600.0, 40.5),
                  Eigen::Vector2d(30.0, 430.75))}) {
    CorridorEstimate estimate;
    CorridorLine line;
    line.line.a = a;
    line.line.b = b;
    line.edge = CorridorEdge::kFloorLeft;
    line.is_used = true;
    estimate.lines = {line};
    const cv::Mat3b drawn = DrawCorridor(Black(), estimate, FloorScene());
    const Eigen::Vector2d along = (b - a).normalized();
    const Eigen::Vector2d across(-along.y(), along.x());
    double weight = 0.0;
    double offset = 0.0;
    for (int v = 0; v < drawn.rows; ++v) {
      for (int u = 0; u < drawn.cols; ++u) {
        const int ink = drawn(v, u)[1];
        if (ink == 0) continue;
        const Eigen::Vector2d p = Eigen::Vector2d(u, v) - a;
        // Half its width, and its soft border.
        EXPECT_LT(std::abs(across.dot(p)), 4.0);
        EXPECT_GT(along.dot(p), -4.0);
        EXPECT_LT(along.dot(p), (b - a).norm() + 4.0);
        weight += ink;
        offset += ink * across.dot(p);
      }
    }
    EXPECT_GT(weight, 255.0 * (b - a).norm());
    // OpenCV draws to sixteenths of a pixel.
    EXPECT_NEAR(offset / weight, 0.0, 0.15);
  }
}

TEST(CorridorPictureTest, LinesThatSupportThePositionAreThicker) {
  CorridorEstimate estimate;
  CorridorLine line;
  line.line.a = {100, 100};
  line.line.b = {500, 300};
  line.edge = CorridorEdge::kAlong;
  estimate.lines = {line};
  const auto ink = [&] {
    return InkNear(
        DrawCorridor(Black(), estimate, FloorScene()), {300.0, 200.0}, 100);
  };
  const double thin = ink();
  estimate.lines[0].is_used = true;
  EXPECT_GT(ink(), 1.8 * thin);
}

TEST(CorridorPictureTest, KnowsWhatLinesAreBySpace) {
  const double heading = 0.25;
  // Along and across the corridor, from R.
  const Eigen::Vector3d along(std::cos(heading), -std::sin(heading), 0.0);
  const Eigen::Vector3d across(std::sin(heading), std::cos(heading), 0.0);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  for (const CameraModel& camera : Cameras()) {
    const CorridorScene scene = Scene(camera);
    for (const Eigen::Vector3d& place : {Eigen::Vector3d(3.0, 0.7, 0.1),
                                         Eigen::Vector3d(4.0, -1.0, 1.0),
                                         Eigen::Vector3d(2.5, 0.2, 0.9)}) {
      const auto use = [&](const Eigen::Vector3d& direction,
                           std::optional<double> known) {
        return UseOf(
            LineOf(scene, place, place + 0.4 * direction), scene, known);
      };
      EXPECT_EQ(use(up, heading), LineUse::kVertical);
      EXPECT_EQ(use(up, std::nullopt), LineUse::kVertical);
      EXPECT_EQ(use(across, heading), LineUse::kAcross);
      EXPECT_EQ(use(across, std::nullopt), LineUse::kOther);
      // The heading with the wrong sign is another one.
      EXPECT_EQ(use(across, -heading), LineUse::kOther);
      // The estimate alone says what is along it.
      EXPECT_EQ(use(along, heading), LineUse::kOther);
      CorridorLine line = LineOf(scene, place, place + 0.4 * along);
      line.edge = CorridorEdge::kAlong;
      EXPECT_EQ(UseOf(line, scene, heading), LineUse::kAlong);
    }
  }
}

TEST(CorridorPictureTest, PredictedEdgesLieWhereTheyShouldBe) {
  for (const CameraModel& camera : Cameras()) {
    CorridorScene scene = Scene(camera);
    CorridorGeometry& corridor = scene.corridor.emplace();
    corridor.width = 2.0;
    CorridorEstimate estimate;
    estimate.y = 0.3;
    estimate.heading = RadiansFromDegrees(8.0);
    const cv::Mat3b drawn = DrawCorridor(Black(), estimate, scene);
    const Eigen::Isometry3d X_RL =
        (Eigen::Translation3d(0.0, *estimate.y, 0.0) *
         Eigen::AngleAxisd(*estimate.heading, Eigen::Vector3d::UnitZ()))
            .inverse();
    for (const double side : {1.0, -1.0}) {
      for (const double x : {3.2, 3.6, 4.0}) {
        const auto at = [&](double y) {
          return PixelOf(scene, X_RL * Eigen::Vector3d(x, y, 0.0));
        };
        EXPECT_GT(InkNear(drawn, at(side), 2), 100.0) << side << " " << x;
        // 25 cm beside it there is nothing.
        EXPECT_EQ(InkNear(drawn, at(0.75 * side), 2), 0.0);
        EXPECT_EQ(InkNear(drawn, at(1.25 * side), 2), 0.0);
      }
    }
    // Without a position none are drawn.
    estimate.y.reset();
    const cv::Mat3b none = DrawCorridor(Black(), estimate, scene);
    EXPECT_EQ(
        InkNear(none, PixelOf(scene, X_RL * Eigen::Vector3d(3.5, 1, 0)), 2),
        0.0);
  }
}

TEST(CorridorPictureTest, TheVanishingPointIsRinged) {
  CorridorEstimate estimate;
  estimate.vanishing_point = Eigen::Vector2d(200.25, 150.5);
  const cv::Mat3b drawn = DrawCorridor(Black(), estimate, FloorScene());
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  for (int v = 0; v < drawn.rows; ++v) {
    for (int u = 0; u < drawn.cols; ++u) {
      weight += drawn(v, u)[2];
      sum += drawn(v, u)[2] * Eigen::Vector2d(u, v);
    }
  }
  ASSERT_GT(weight, 0.0);
  EXPECT_NEAR(sum.x() / weight, 200.25, 0.2);
  EXPECT_NEAR(sum.y() / weight, 150.5, 0.2);
}

TEST(CorridorPictureTest, AWedgePointsToWhatIsBesideTheImage) {
  CorridorEstimate estimate;
  estimate.vanishing_point = Eigen::Vector2d(2000.0, 150.0);
  const cv::Mat3b drawn = DrawCorridor(Black(), estimate, FloorScene());
  EXPECT_GT(InkNear(drawn, {kWidth - 8.0, 150.0}, 6), 0.0);
  EXPECT_EQ(InkNear(drawn, {8.0, 150.0}, 6), 0.0);
}

TEST(CorridorPictureTest, TakesGrayAndColourAndLinesFromAnywhere) {
  CorridorEstimate estimate;
  CorridorLine line;
  line.line.a = {-1e7, 1e7};
  line.line.b = {1e7, -1e7};
  estimate.lines = {line};
  estimate.vanishing_point = Eigen::Vector2d(-1e9, 1e9);
  const cv::Mat1b gray(48, 64, uchar{100});
  const CorridorScene scene = Scene(Cameras()[1]);
  EXPECT_EQ(DrawCorridor(gray, estimate, scene).size(), gray.size());
  const cv::Mat3b color(48, 64, cv::Vec3b(10, 20, 30));
  EXPECT_EQ(DrawCorridor(color, estimate, scene).size(), color.size());
  EXPECT_THROW((void)DrawCorridor(cv::Mat(), estimate, scene),
               std::logic_error);
  EXPECT_THROW((void)DrawCorridor(cv::Mat1f(4, 4, 0.0F), estimate, scene),
               std::logic_error);
}

}  // namespace
}  // namespace waymark
