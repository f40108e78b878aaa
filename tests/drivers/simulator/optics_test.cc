// Whether pictures show things where the camera models say, in each of them.
#include "drivers/simulator/renderer.h"
#include "estimation/base/random.h"
#include "estimation/camera/pan_tilt_mount.h"
#include "estimation/geometry/angle.h"
#include "tests/support/box_scene.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct Case {
  std::string name;
  CameraView view;
};

// Rounded from the cameras that come with the simulator; lenses of more bend,
// both mirror images (one lens into one mirror: fy < 0).
std::vector<Case> Cases() {
  return {{"pinhole",
           {PerspectiveCamera({457.0, 455.0, 321.3, 238.8}), {640, 480}}},
          {"perspective",
           {PerspectiveCamera({457.0, 455.0, 321.3, 238.8},
                              {-0.28, 0.08, 1.2e-3, -4e-4, 0.0}),
            {640, 480}}},
          {"fisheye",
           {FisheyeCamera({210.0, 211.0, 317.7, 240.9},
                          {0.03, -0.01, 0.003, -0.0005}),
            {640, 480}}},
          {"mirror",
           {SphereCamera(0.95, {202.0, -202.0, 319.5, 318.2}), {640, 640}}},
          {"distorted_mirror",
           {SphereCamera(1.0, {180.0, -181.0, 322.1, 317.0}, {-0.05, 0.01}),
            {640, 640}}},
          {"panorama",
           {PanoramaCamera::WholeTurn({1024, 256}, 120.0), {1024, 256}}}};
}

// An upright robot somewhere in W, turned.
Isometry3d RobotPose() {
  Isometry3d X_WR = Isometry3d::Identity();
  X_WR.linear() = Eigen::AngleAxisd(0.7, Vector3d::UnitZ()).toRotationMatrix();
  X_WR.translation() << 21.0, -7.5, 0.0;
  return X_WR;
}

Isometry3d CameraPose() {
  const PanTiltMount mount{Isometry3d(Eigen::Translation3d(0.1, 0.0, 0.6)),
                           Vector3d::Zero()};
  return RobotPose() * mount.CameraOnRobot(0.2, 0.3);
}

// A star of eight sectors, black and white by turns: the corner is where four
// edges cross. A single edge at an unlucky angle is off by what sixteen samples
// a pixel cannot tell, all along.
constexpr int kSectors = 8;

struct Mark {
  Vector3d corner_W;
  Eigen::Matrix3d R_WB;
  double radius = 0.0;  // m.

  // In W, from the corner along edge i.
  [[nodiscard]] Vector3d Spoke(int i) const {
    const double angle = 2.0 * kPi * i / kSectors;
    return radius *
           (std::cos(angle) * R_WB.col(0) + std::sin(angle) * R_WB.col(1));
  }
};

// In light of their own: what is measured is where they are.
void AddMark(const Mark& mark, Scene* scene) {
  if (scene->materials.empty()) {
    for (const std::uint8_t grey : {std::uint8_t{20}, std::uint8_t{235}}) {
      const auto i = AddMaterial(cv::Mat3b(1, 1, cv::Vec3b::all(grey)), scene);
      scene->materials[i].is_emissive = true;
    }
    AddSurface("marks", SurfaceKind::kPicture, scene);
  }
  for (int i = 0; i < kSectors; ++i) {
    const auto first = static_cast<std::uint32_t>(scene->mesh.positions.size());
    for (const Vector3d& p : {Vector3d(mark.corner_W),
                              Vector3d(mark.corner_W + mark.Spoke(i)),
                              Vector3d(mark.corner_W + mark.Spoke(i + 1))}) {
      scene->mesh.positions.push_back(p.cast<float>());
      scene->mesh.uvs.emplace_back(0.0f, 0.0f);
    }
    scene->mesh.triangles.push_back(
        {{first, first + 1, first + 2}, static_cast<std::uint32_t>(i % 2), 0});
  }
}

// Marks all over the image, `spacing` px apart, with corners anywhere between
// the pixels' centres, each some `radius` px large, tilted and turned.
std::vector<Mark> MarksOver(const CameraView& view,
                            const Isometry3d& X_WC,
                            Scene* scene) {
  constexpr int kSpacing = 64;
  constexpr double kRadius = 20.0;
  Random random(17);
  std::vector<Mark> marks;
  for (int y = kSpacing / 2; y < view.size.height; y += kSpacing) {
    for (int x = kSpacing / 2; x < view.size.width; x += kSpacing) {
      const double u = x + random.Uniform(-3.0, 3.0);
      const double v = y + random.Uniform(-3.0, 3.0);
      const double turn = random.Uniform(-kPi, kPi);
      const double tilt_x = random.Uniform(-0.5, 0.5);
      const double tilt_y = random.Uniform(-0.5, 0.5);
      const double distance = random.Uniform(0.8, 6.0);
      const auto back = RayFromPixel(view.model, {u, v});
      if (!back) continue;
      const Vector3d n_W = X_WC.linear() * back->ray;
      const Vector3d across = n_W.unitOrthogonal();
      Eigen::Matrix3d R_WB;
      R_WB << across, n_W.cross(across), n_W;
      R_WB *= (Eigen::AngleAxisd(turn, Vector3d::UnitZ()) *
               Eigen::AngleAxisd(tilt_x, Vector3d::UnitX()) *
               Eigen::AngleAxisd(tilt_y, Vector3d::UnitY()))
                  .toRotationMatrix();
      const double pixel = back->d_pixel.norm() / std::sqrt(2.0);  // rad.
      marks.push_back({X_WC.translation() + distance * n_W,
                       R_WB,
                       kRadius * pixel * distance});
      AddMark(marks.back(), scene);
    }
  }
  return marks;
}

cv::Mat1f Grey(const cv::Mat3f& linear) {
  cv::Mat1f grey;
  cv::cvtColor(linear, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

// A curved edge in an image, as a parabola about a point of it.
struct ImageEdge {
  Vector2d along = Vector2d::UnitX();  // Unit, in px.
  double bend = 0.0;                   // Per px.

  // Share of the pixel at `d` from the edge's point on its one side minus that
  // on the other: a box of 1 px cut by a straight line.
  [[nodiscard]] double Sides(const Vector2d& d) const {
    const Vector2d normal(-along.y(), along.x());
    const double distance =
        normal.dot(d) - 0.5 * bend * std::pow(along.dot(d), 2);
    const double p = along.cwiseAbs().maxCoeff();
    const double q = along.cwiseAbs().minCoeff();
    const double x = std::abs(distance);
    double side = 1.0;
    if (x < 0.5 * (p - q)) {
      side = 2.0 * x / p;
    } else if (x < 0.5 * (p + q)) {
      side = 1.0 - std::pow(0.5 * (p + q) - x, 2) / (p * q);
    }
    return std::copysign(side, distance);
  }
};

// The mark's edge along a direction, from `length` px before its corner to as
// much behind it.
ImageEdge EdgeOf(const CameraView& view,
                 const Vector3d& corner_C,
                 const Vector3d& reach_C) {
  const Vector2d middle = PixelFromRay(view.model, corner_C)->pixel;
  const Vector2d a = PixelFromRay(view.model, corner_C - reach_C)->pixel;
  const Vector2d b = PixelFromRay(view.model, corner_C + reach_C)->pixel;
  ImageEdge edge;
  edge.along = (b - a).normalized();
  const Vector2d normal(-edge.along.y(), edge.along.x());
  edge.bend = 2.0 * normal.dot(0.5 * (a + b) - middle) /
              std::pow(0.5 * (b - a).norm(), 2);
  return edge;
}

// How far from where the model has it a mark's corner lies in the picture:
// least squares over the pixels about it, with black and white free. Each has
// the share of its area on either side of the edges, so that nothing is lost to
// aliasing, as it is where a picture of sharp edges is blurred or
// differentiated; pixels at the crossing itself, cut by both, are left out.
Vector2d Displacement(const cv::Mat1f& grey,
                      const CameraView& view,
                      const Isometry3d& X_WC,
                      const Mark& mark) {
  const Vector3d corner_C = X_WC.inverse() * mark.corner_W;
  const Vector2d expected = PixelFromRay(view.model, corner_C)->pixel;
  // Where a mark of tilt 0.7 rad still is.
  constexpr double kShare = 0.7;
  std::vector<ImageEdge> edges;
  for (int i = 0; i < kSectors / 2; ++i) {
    edges.push_back(EdgeOf(
        view, corner_C, kShare * (X_WC.linear().transpose() * mark.Spoke(i))));
  }
  constexpr int kRadius = 13;
  constexpr double kCrossing = 3.0;
  const int x0 = static_cast<int>(std::lround(expected.x()));
  const int y0 = static_cast<int>(std::lround(expected.y()));
  std::vector<Vector2d> pixels;
  std::vector<double> values;
  for (int y = y0 - kRadius; y <= y0 + kRadius; ++y) {
    for (int x = x0 - kRadius; x <= x0 + kRadius; ++x) {
      const double distance = (Vector2d(x, y) - expected).norm();
      if (distance > kRadius || distance < kCrossing) continue;
      pixels.emplace_back(Vector2d(x, y) - expected);
      values.push_back(grey(y, x));
    }
  }
  const auto num = static_cast<Eigen::Index>(values.size());
  const Eigen::Map<const Eigen::VectorXd> seen(values.data(), num);
  const auto residuals = [&](const Vector2d& shift) {
    Eigen::VectorXd pattern(num);
    for (Eigen::Index i = 0; i < num; ++i) {
      const Vector2d d = pixels[static_cast<std::size_t>(i)] - shift;
      pattern(i) = 1.0;
      for (const ImageEdge& edge : edges) pattern(i) *= edge.Sides(d);
    }
    pattern.array() -= pattern.mean();
    const double contrast = pattern.dot(seen) / pattern.squaredNorm();
    return Eigen::VectorXd((seen.array() - seen.mean()).matrix() -
                           contrast * pattern);
  };
  Vector2d shift = Vector2d::Zero();
  for (int step = 0; step < 20; ++step) {
    constexpr double kStep = 1e-4;
    Eigen::MatrixX2d J(num, 2);
    for (int p = 0; p < 2; ++p) {
      const Vector2d change = kStep * Vector2d::Unit(p);
      J.col(p) =
          (residuals(shift + change) - residuals(shift - change)) / (2 * kStep);
    }
    Vector2d change =
        -(J.transpose() * J).ldlt().solve(J.transpose() * residuals(shift));
    if (change.norm() > 0.5) change *= 0.5 / change.norm();
    shift += change;
    if (change.norm() < 1e-4) break;
  }
  return shift;
}

class OpticsTest : public testing::TestWithParam<Case> {};

TEST_P(OpticsTest, CornersLieWhereTheModelSays) {
  const CameraView& view = GetParam().view;
  const Isometry3d X_WC = CameraPose();
  Scene scene;
  const std::vector<Mark> marks = MarksOver(view, X_WC, &scene);
  RenderOptions options{.quality = RenderQuality::kStill, .linear = true};
  options.depth = true;
  const RenderedView seen = Renderer(scene).Render(view, X_WC, {}, options);
  const cv::Mat1f grey = Grey(seen.linear);
  constexpr int kBorder = 14;  // px: what Displacement looks at.
  int num_checked = 0;
  double largest = 0.0;
  double largest_depth = 0.0;
  Vector2d sum = Vector2d::Zero();
  for (const Mark& mark : marks) {
    const auto there = PixelFromRay(view.model, X_WC.inverse() * mark.corner_W);
    ASSERT_TRUE(there);
    const Vector2d& pixel = there->pixel;
    const cv::Point centre(static_cast<int>(std::lround(pixel.x())),
                           static_cast<int>(std::lround(pixel.y())));
    if (centre.x < kBorder || centre.x >= view.size.width - kBorder ||
        centre.y < kBorder || centre.y >= view.size.height - kBorder) {
      continue;
    }
    const Vector2d shift = Displacement(grey, view, X_WC, mark);
    EXPECT_LT(shift.norm(), 0.05) << pixel.transpose();
    largest = std::max(largest, shift.norm());
    sum += shift;
    // The mark's plane along the ray of that pixel's centre.
    const auto back = RayFromPixel(view.model, {centre.x, centre.y});
    ASSERT_TRUE(back);
    const Vector3d n_W = X_WC.linear() * back->ray;
    const double depth =
        mark.R_WB.col(2).dot(mark.corner_W - X_WC.translation()) /
        mark.R_WB.col(2).dot(n_W);
    const double off = std::abs(seen.depth(centre) / depth - 1.0);
    EXPECT_LT(off, 1e-5) << pixel.transpose();
    largest_depth = std::max(largest_depth, off);
    ++num_checked;
  }
  EXPECT_GT(num_checked, 40);
  // Errors without a direction: a shift of a part of a pixel would have one.
  EXPECT_LT((sum / num_checked).norm(), 0.005);
  std::printf(
      "%s: %d corners, off by %.4f px at most, %.4f in the mean; depth "
      "by %.1e\n",
      GetParam().name.c_str(),
      num_checked,
      largest,
      (sum / num_checked).norm(),
      largest_depth);
}

// One for all models: its light takes the longest.
const Renderer& Corridor() {
  static const Renderer kRenderer(FurnishedCorridor());
  return kRenderer;
}

struct Step {
  RenderQuality quality = RenderQuality::kLive;
  Vector3d shift_W;
};

// Between two pictures a robot moves by millimetres: what flickers then is not
// the world.
TEST_P(OpticsTest, AMillimetreChangesLittle) {
  const CameraRays rays(GetParam().view);
  Isometry3d X_WC = Isometry3d::Identity();
  X_WC.linear() = Eigen::AngleAxisd(0.3, Vector3d::UnitZ()).toRotationMatrix() *
                  ForwardCameraRotation();
  X_WC.translation() << 3.1, 0.9, 1.1;
  const std::vector<Isometry3d> X_WP{
      Isometry3d(Eigen::Translation3d(5.0, 1.2, 0.0))};
  const auto grey = [&](const RenderQuality quality, const Vector3d& shift_W) {
    const RenderedView seen =
        Corridor().Render(rays,
                          Eigen::Translation3d(shift_W) * X_WC,
                          X_WP,
                          RenderOptions{.quality = quality});
    cv::Mat1b image;
    cv::cvtColor(seen.image, image, cv::COLOR_BGR2GRAY);
    return image;
  };
  constexpr double kMillimetre = 1e-3;
  for (const Step& step :
       {Step{RenderQuality::kLive, Vector3d::UnitX()},
        Step{RenderQuality::kLive, Vector3d::UnitY()},
        Step{RenderQuality::kLive, Vector3d::UnitZ()},
        Step{RenderQuality::kStill, Vector3d::Ones().normalized()}}) {
    cv::Mat1b change;
    cv::absdiff(grey(step.quality, Vector3d::Zero()),
                grey(step.quality, kMillimetre * step.shift_W),
                change);
    const double mean = cv::mean(change)[0];
    EXPECT_LT(mean, 1.5) << step.shift_W.transpose();
    EXPECT_GT(mean, 0.0);
    std::printf("%s, %s, along (%.1f %.1f %.1f): mean change %.3f\n",
                GetParam().name.c_str(),
                step.quality == RenderQuality::kLive ? "live" : "still",
                step.shift_W.x(),
                step.shift_W.y(),
                step.shift_W.z(),
                mean);
  }
}

INSTANTIATE_TEST_SUITE_P(Models,
                         OpticsTest,
                         testing::ValuesIn(Cases()),
                         [](const auto& test) { return test.param.name; });

// The head's angles from its description alone: pan to the left, then tilt
// downward, about the crossing of its axes.
TEST(Optics, APanTiltHeadLooksWhereItIsTold) {
  const CameraView view{PerspectiveCamera({240.0, 240.0, 161.0, 118.0},
                                          {-0.1, 0.02, 1e-3, -4e-4}),
                        {320, 240}};
  const PanTiltMount mount{Isometry3d(Eigen::Translation3d(0.08, -0.02, 1.2)),
                           Vector3d(0.05, 0.0, 0.03)};
  const Isometry3d X_WR = RobotPose();
  for (const auto& [pan, tilt] : std::vector<std::pair<double, double>>{
           {0.0, 0.0}, {0.9, 0.0}, {-1.7, 0.4}, {0.4, -0.5}, {2.5, 0.8}}) {
    const Vector3d forward(std::cos(tilt) * std::cos(pan),
                           std::cos(tilt) * std::sin(pan),
                           -std::sin(tilt));
    const Vector3d up(std::sin(tilt) * std::cos(pan),
                      std::sin(tilt) * std::sin(pan),
                      std::cos(tilt));
    Isometry3d X_RC = Isometry3d::Identity();
    X_RC.linear() << forward.cross(up), -up, forward;
    X_RC.translation() =
        Vector3d(0.08, -0.02, 1.2) + 0.05 * forward + 0.03 * up;
    const Isometry3d X_WC = X_WR * X_RC;
    Scene scene;
    std::vector<Mark> marks;
    for (const Vector3d& point_C : {Vector3d(0.0, 0.0, 2.0),
                                    Vector3d(-0.8, 0.2, 2.0),
                                    Vector3d(0.4, -0.6, 2.0)}) {
      marks.push_back(
          {X_WC * point_C,
           X_WC.linear() *
               Eigen::AngleAxisd(0.3, Vector3d::UnitZ()).toRotationMatrix(),
           0.17});
      AddMark(marks.back(), &scene);
    }
    const RenderOptions options{.quality = RenderQuality::kStill,
                                .linear = true};
    const cv::Mat1f grey = Grey(
        Renderer(scene)
            .Render(view, X_WR * mount.CameraOnRobot(pan, tilt), {}, options)
            .linear);
    for (const Mark& mark : marks) {
      EXPECT_LT(Displacement(grey, view, X_WC, mark).norm(), 0.05)
          << pan << " " << tilt;
    }
  }
}

}  // namespace
}  // namespace waymark
