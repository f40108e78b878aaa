#include "drivers/simulator/renderer.h"

#include "tests/support/box_scene.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

namespace waymark {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

CameraView Perspective(int width, int height) {
  return {
      PerspectiveCamera(
          {0.6 * width, 0.6 * width, 0.5 * (width - 1), 0.5 * (height - 1)}),
      {width, height}};
}

std::vector<CameraView> AllModels() {
  return {Perspective(97, 61),
          {FisheyeCamera({30.0, 30.0, 48.0, 30.0}), {97, 61}},
          {SphereCamera(0.9, {40.0, 40.0, 48.0, 40.0}), {97, 81}},
          {PanoramaCamera::WholeTurn({128, 40}, 20.0), {128, 40}}};
}

RenderOptions Everything() {
  RenderOptions options;
  options.linear = true;
  options.depth = true;
  options.surface = true;
  options.floor = true;
  return options;
}

// Coarse light: the geometry of pictures does not depend on it.
RendererOptions WithThreads(int num_threads) {
  RendererOptions options;
  options.num_threads = num_threads;
  options.shader.light.num_rings = 1;
  options.shader.light_map.cell_size = 1.0;
  return options;
}

struct Expected {
  double distance = 0.0;
  int surface = -1;
  // To the next edge of the room, relative: there either side may be met.
  double margin = 0.0;
};

// The ray's way out of the room [0, size] that it starts in.
Expected RoomHit(const Vector3d& size, const Vector3d& p, const Vector3d& n) {
  constexpr std::array<int, 6> kSurface = {2, 3, 4, 5, 0, 1};
  std::array<double, 3> distance{};
  std::array<int, 3> surface{};
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_up = n[axis] > 0.0;
    const auto i = static_cast<std::size_t>(axis);
    distance[i] = ((is_up ? size[axis] : 0.0) - p[axis]) / n[axis];
    surface[i] = kSurface[2 * i + (is_up ? 1 : 0)];
    if (n[axis] == 0.0) distance[i] = 1e9;
  }
  Expected expected{1e18, -1, 0.0};
  double second = 1e18;
  for (std::size_t i = 0; i < 3; ++i) {
    if (distance[i] < expected.distance) {
      second = expected.distance;
      expected.distance = distance[i];
      expected.surface = surface[i];
    } else {
      second = std::min(second, distance[i]);
    }
  }
  expected.margin = second / expected.distance - 1.0;
  return expected;
}

// Every model, near a corner of a long room, far from the origin of floats.
TEST(Renderer, DepthAndSurfaceAreThoseOfTheRoom) {
  const Vector3d size(40.0, 3.0, 2.5);
  const Renderer renderer(EmptyRoom(size, false), WithThreads(1));
  const Isometry3d X_WC = LookFrom({38.7, 0.4, 1.1}, 0.7, 0.2);
  for (const CameraView& view : AllModels()) {
    const RenderedView seen =
        renderer.Render(CameraRays(view), X_WC, {}, Everything());
    int num_checked = 0;
    for (int y = 0; y < view.size.height; ++y) {
      for (int x = 0; x < view.size.width; ++x) {
        const auto ray = RayFromPixel(view.model, {x, y});
        if (!ray) {
          EXPECT_EQ(seen.surface(y, x), -1);
          EXPECT_EQ(seen.depth(y, x), 0.0f);
          EXPECT_EQ(seen.image(y, x), cv::Vec3b(0, 0, 0));
          continue;
        }
        const Vector3d n_W = X_WC.linear() * ray->ray;
        const Expected expected = RoomHit(size, X_WC.translation(), n_W);
        EXPECT_NEAR(seen.depth(y, x) / expected.distance, 1.0, 1e-5);
        if (expected.margin < 1e-5) continue;
        EXPECT_EQ(seen.surface(y, x), expected.surface);
        EXPECT_EQ(seen.floor(y, x), expected.surface == 0 ? 255 : 0);
        ++num_checked;
      }
    }
    EXPECT_GT(num_checked, view.size.width * view.size.height / 2);
  }
}

// At flat angles, where the distance of a float intersection is worst.
TEST(Renderer, DepthAlongALongFloorIsExact) {
  const Vector3d size(200.0, 200.0, 30.0);
  RendererOptions options = WithThreads(1);
  options.shader.light_map.cell_size = 20.0;
  const Renderer renderer(EmptyRoom(size, true), options);
  const CameraView view = Perspective(200, 151);
  const Isometry3d X_WC = LookFrom({100.3, 99.1, 0.05}, 0.3, 0.0);
  const RenderedView seen =
      renderer.Render(CameraRays(view), X_WC, {}, Everything());
  for (int y = 76; y < 151; ++y) {
    for (int x = 0; x < 200; ++x) {
      const Vector3d n_W =
          X_WC.linear() * RayFromPixel(view.model, {x, y})->ray;
      const Expected expected = RoomHit(size, X_WC.translation(), n_W);
      ASSERT_NEAR(seen.depth(y, x) / expected.distance, 1.0, 1e-5)
          << x << ' ' << y;
    }
  }
}

std::vector<Isometry3d> PersonAt(double x, double y, double yaw) {
  Isometry3d X_WP = Isometry3d::Identity();
  X_WP.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  X_WP.translation() = Vector3d(x, y, 0.0);
  return {X_WP};
}

TEST(Renderer, SameBytesForAnyNumberOfThreads) {
  const Scene scene = FurnishedCorridor();
  const CameraRays camera(Perspective(63, 41));
  const Isometry3d X_WC = LookFrom({1.0, 0.8, 1.2}, 0.1, 0.1);
  const auto people = PersonAt(4.0, 1.0, 0.3);
  const Renderer with_one(scene, WithThreads(1));
  const Renderer with_two(scene, WithThreads(2));
  const Renderer with_three(scene, WithThreads(3));
  for (const RenderQuality quality :
       {RenderQuality::kSingle, RenderQuality::kLive, RenderQuality::kStill}) {
    RenderOptions options = Everything();
    options.quality = quality;
    const RenderedView first = with_one.Render(camera, X_WC, people, options);
    for (const Renderer* renderer : {&with_two, &with_three}) {
      const RenderedView other =
          renderer->Render(camera, X_WC, people, options);
      const auto same = [](const cv::Mat& a, const cv::Mat& b) {
        return a.size() == b.size() && a.type() == b.type() &&
               std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
      };
      EXPECT_TRUE(same(first.image, other.image));
      EXPECT_TRUE(same(first.linear, other.linear));
      EXPECT_TRUE(same(first.depth, other.depth));
      EXPECT_TRUE(same(first.surface, other.surface));
      EXPECT_TRUE(same(first.floor, other.floor));
    }
  }
}

// Eight pixels at once, with textures, shadows, lamps and a person in the
// picture: as one by one.
TEST(Renderer, WideShadingIsThatOfSinglePixels) {
  const Scene scene = FurnishedCorridor();
  RendererOptions options = WithThreads(1);
  const Renderer wide(scene, options);
  options.shader.is_wide = false;
  const Renderer single(scene, options);
  for (const CameraView& view : AllModels()) {
    const CameraRays camera(view);
    const Isometry3d X_WC = LookFrom({1.0, 0.8, 1.2}, 0.1, 0.1);
    const auto people = PersonAt(3.0, 1.2, 0.3);
    const RenderedView a = wide.Render(camera, X_WC, people, Everything());
    const RenderedView b = single.Render(camera, X_WC, people, Everything());
    EXPECT_LT(cv::norm(a.linear, b.linear, cv::NORM_INF), 2e-4);
    EXPECT_LE(cv::norm(a.image, b.image, cv::NORM_INF), 1.0);
    // Light within reach of the person is less.
    const RenderedView alone =
        wide.Render(camera, X_WC, PersonAt(-9.0, 1.0, 0.0), Everything());
    EXPECT_LT(cv::sum(a.linear)[1], cv::sum(alone.linear)[1]);
  }
}

TEST(Renderer, SeesAMoverWhereItIsPlaced) {
  const Scene scene = FurnishedCorridor();
  const Renderer renderer(scene, WithThreads(1));
  const CameraView view = Perspective(160, 120);
  const Isometry3d X_WC = LookFrom({1.0, 1.0, 1.0}, 0.0);
  const int person = static_cast<int>(scene.surfaces.size()) - 1;
  for (const double x : {3.0, 6.0}) {
    const RenderedView seen = renderer.Render(
        CameraRays(view), X_WC, PersonAt(x, 1.0, 0.5), Everything());
    const cv::Point middle(80, 60);
    EXPECT_EQ(seen.surface(middle), person);
    // The cylinder of 24 sides lies between its inner and outer radius.
    EXPECT_NEAR(seen.depth(middle), x - 1.0 - 0.22, 0.005);
  }
  const RenderedView away = renderer.Render(
      CameraRays(view), X_WC, PersonAt(-5.0, 1.0, 0.0), Everything());
  EXPECT_EQ(cv::countNonZero(away.surface == person), 0);
}

TEST(Renderer, EmptySceneIsBlack) {
  const Renderer renderer(Scene{});
  const RenderedView seen = renderer.Render(
      CameraRays(Perspective(9, 7)), Isometry3d::Identity(), {}, Everything());
  EXPECT_EQ(cv::countNonZero(seen.image.reshape(1)), 0);
  EXPECT_EQ(cv::countNonZero(seen.depth), 0);
  EXPECT_EQ(cv::countNonZero(seen.surface + 1), 0);
}

TEST(Renderer, OnePixelAndNoPixelOfThePicture) {
  const Renderer renderer(EmptyRoom({4.0, 3.0, 2.5}, false), WithThreads(1));
  const CameraView one = {PerspectiveCamera({1.0, 1.0, 0.0, 0.0}), {1, 1}};
  for (const RenderQuality quality :
       {RenderQuality::kLive, RenderQuality::kStill}) {
    RenderOptions options = Everything();
    options.quality = quality;
    const RenderedView seen = renderer.Render(
        CameraRays(one), LookFrom({1.0, 1.0, 1.0}, 0.0), {}, options);
    EXPECT_NEAR(seen.depth(0, 0), 3.0, 3e-5);
    EXPECT_EQ(seen.surface(0, 0), 3);
  }
  EXPECT_THROW(CameraRays({one.model, {0, 1}}), std::invalid_argument);
}

TEST(Renderer, ACameraInsideAWallSeesItFromWithin) {
  Scene scene;
  AddMaterial(cv::Mat3b(1, 1, {200, 200, 200}), &scene);
  AddSurface("block", SurfaceKind::kWall, &scene);
  AddBox({0, 0, 0}, {1, 1, 1}, 0, 0, &scene.mesh);
  const RenderedView seen =
      Renderer(scene).Render(CameraRays(Perspective(20, 16)),
                             LookFrom({0.5, 0.5, 0.5}, 0.0),
                             {},
                             Everything());
  EXPECT_EQ(cv::countNonZero(seen.surface), 0);
  EXPECT_NEAR(seen.depth(8, 10), 0.5, 0.01);
}

TEST(Renderer, RefusesWrongArguments) {
  EXPECT_THROW(Renderer(Scene{}, WithThreads(0)), std::invalid_argument);
  Scene bad = EmptyRoom({1, 1, 1}, true);
  bad.mesh.triangles[0].material = 77;
  EXPECT_THROW(Renderer{bad}, std::invalid_argument);
  EXPECT_THROW(
      (void)Renderer(FurnishedCorridor(), WithThreads(1))
          .Render(CameraRays(Perspective(4, 4)), Isometry3d::Identity(), {}),
      std::logic_error);
}

}  // namespace
}  // namespace waymark
