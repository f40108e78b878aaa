#include "drivers/simulator/light_map.h"

#include "drivers/simulator/lamp_light.h"
#include "tests/support/box_scene.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace waymark {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// A light map with what it is made from.
class Lit {
 public:
  explicit Lit(const Scene& scene,
               const LightMapOptions& options = {},
               int num_threads = 1,
               const LightFieldOptions& field_options = {})
      : caster_(scene),
        field_(scene, field_options),
        map_(scene, field_, Whites(scene), options, num_threads) {}

  // Of the triangle that a look from `eye` at `p_W` meets: there (green).
  [[nodiscard]] float At(const Vector3d& p_W, const Vector3d& eye) const {
    return ColourAt(p_W, eye)[1];
  }
  [[nodiscard]] Float4 ColourAt(const Vector3d& p_W,
                                const Vector3d& eye) const {
    RayPacket packet;
    SetOrigin(eye.cast<float>(), &packet);
    const Vector3f direction = (p_W - eye).cast<float>();
    for (int lane = 0; lane < RayPacket::kLanes; ++lane) {
      for (int i = 0; i < 3; ++i) packet.direction[i][lane] = direction[i];
    }
    caster_.Trace(&packet);
    EXPECT_NEAR(packet.distance[0], 1.0f, 1e-4f) << p_W.transpose();
    return map_.At(packet.triangle[0], p_W.cast<float>(), direction);
  }
  // Looked at from one metre above.
  [[nodiscard]] float OnFloor(double x, double y) const {
    return At({x, y, 0.0}, {x, y, 1.0});
  }
  [[nodiscard]] const LightMap& map() const { return map_; }

 private:
  static std::vector<Float4> Whites(const Scene& scene) {
    return std::vector<Float4>(scene.materials.size(), Broadcast(1.0f));
  }
  RayCaster caster_;
  LightField field_;
  LightMap map_;
};

Scene Floor(const Vector3d& low, const Vector3d& high) {
  Scene scene;
  scene.ambient.setZero();
  AddMaterial(cv::Mat3b(1, 1, {255, 255, 255}), &scene);
  AddSurface("floor", SurfaceKind::kFloor, &scene);
  AddSurface("thing", SurfaceKind::kFurniture, &scene);
  AddQuad(
      low, {high.x(), low.y(), 0}, {low.x(), high.y(), 0}, 0, 0, &scene.mesh);
  return scene;
}

SceneLamp Lamp(const Vector3d& p_W, double size_x, double size_y) {
  SceneLamp lamp;
  lamp.p_W = p_W;
  lamp.size = {size_x, size_y};
  return lamp;
}

// cos cos / d^2 summed up over `num` x `num` parts of the lamp, without its
// closed form.
double BruteForce(const SceneLamp& lamp,
                  const Vector3d& p_W,
                  const Vector3d& n_W,
                  int num = 100) {
  double sum = 0.0;
  for (int i = 0; i < num; ++i) {
    for (int j = 0; j < num; ++j) {
      const Vector3d to_lamp = lamp.p_W - p_W +
                               Vector3d(((i + 0.5) / num - 0.5) * lamp.size.x(),
                                        ((j + 0.5) / num - 0.5) * lamp.size.y(),
                                        0.0);
      const double square = to_lamp.squaredNorm();
      sum += std::max(0.0, n_W.dot(to_lamp)) * std::max(0.0, to_lamp.z()) /
             (square * square);
    }
  }
  return sum * lamp.size.prod() / (num * num);
}

TEST(LampIrradiance, IsTheIntegralOverTheLamp) {
  const SceneLamp lamp = Lamp({0.4, -0.2, 2.5}, 1.2, 0.5);
  for (const Vector3d& p :
       {Vector3d(0.4, -0.2, 0.0), Vector3d(2.0, 1.0, 0.3), Vector3d(0, 0, 2)}) {
    for (Vector3d n : {Vector3d(0, 0, 1),
                       Vector3d(1, 0, 0),
                       Vector3d(-1, 0.3, 0.2),
                       Vector3d(0, 0, -1)}) {
      n.normalize();
      EXPECT_NEAR(LampIrradiance(lamp, p, n), BruteForce(lamp, p, n, 400), 1e-5)
          << p.transpose() << " | " << n.transpose();
    }
  }
  EXPECT_EQ(LampIrradiance(lamp, {0, 0, 3}, Vector3d::UnitZ()), 0.0);
  EXPECT_EQ(LampIrradiance(lamp, {0, 0, 3}, -Vector3d::UnitZ()), 0.0);
  // The scene's own example, for which it takes the lamp for a point: 0.16.
  EXPECT_NEAR(LampIrradiance(Lamp({0, 0, 2.5}, 1, 1), {0, 0, 0}, {0, 0, 1}),
              0.16,
              0.01);
}

TEST(LightMap, LampOnAFloorAsTheFormFactorSays) {
  Scene scene = Floor({-4, -4, 0}, {4, 4, 0});
  scene.lamps.push_back(Lamp({0.3, 0.1, 2.5}, 1.0, 0.6));
  scene.lamps[0].radiance = {1.0, 2.0, 3.0};
  const Lit lit(scene);
  const double top = BruteForce(scene.lamps[0], {0.3, 0.1, 0}, {0, 0, 1});
  for (double x = -3.9; x < 4.0; x += 0.37) {
    for (double y = -3.9; y < 4.0; y += 0.53) {
      const double expected = BruteForce(scene.lamps[0], {x, y, 0}, {0, 0, 1});
      // Half a percent of the brightest: straight lines from corner to corner
      // of cells.
      EXPECT_NEAR(lit.OnFloor(x, y), 2.0 * expected, 0.005 * 2.0 * top);
    }
  }
  const Float4 colour = lit.ColourAt({1, 1, 0}, {1, 1, 1});
  EXPECT_NEAR(colour[1] / colour[0], 2.0f, 1e-4f);
  EXPECT_NEAR(colour[2] / colour[0], 3.0f, 1e-4f);
  // From below it is dark.
  EXPECT_EQ(lit.At({0.3, 0.1, 0}, {0.3, 0.1, -1}), 0.0f);
}

TEST(LightMap, AmbientLightInCorners) {
  Scene scene = Floor({0, 0, 0}, {10, 10, 0});
  scene.ambient = {0.5, 1.0, 2.0};
  AddQuad({0, 0, 0}, {0, 10, 0}, {0, 0, 10}, 0, 1, &scene.mesh);
  const Lit lit(scene);
  // Of two walls: half, and a little by the far part of the wall.
  EXPECT_NEAR(lit.OnFloor(0.003, 5.0), 0.5, 0.05);
  EXPECT_NEAR(lit.At({0, 5, 0.003}, {1, 5, 0.003}), 0.5, 0.05);
  EXPECT_NEAR(lit.OnFloor(8.0, 5.0), 1.0, 0.01);
  const Float4 colour = lit.ColourAt({8, 5, 0}, {8, 5, 1});
  EXPECT_NEAR(colour[0], 0.5f, 0.01f);
  EXPECT_NEAR(colour[2], 2.0f, 0.02f);
  // Between: less and less shade.
  float before = 0.0f;
  for (double x = 0.01; x < 3.0; x += 0.05) {
    const float light = lit.OnFloor(x, 5.0);
    EXPECT_GE(light, before - 0.005f) << x;
    before = light;
  }
}

TEST(LightMap, CornerOfThreeWallsHasAQuarter) {
  Scene scene = EmptyRoom({6, 6, 6}, true);
  const Lit lit(scene);
  EXPECT_NEAR(lit.OnFloor(0.003, 0.003), 0.25, 0.06);
  EXPECT_NEAR(lit.OnFloor(3.0, 3.0), 1.0, 0.01);
}

TEST(LightMap, SoftShadowOfATable) {
  Scene scene = Floor({-4, -4, 0}, {4, 4, 0});
  scene.lamps.push_back(Lamp({0, 0, 3.0}, 0.6, 0.6));
  AddQuad({-0.8, -0.8, 1}, {0.8, -0.8, 1}, {-0.8, 0.8, 1}, 0, 1, &scene.mesh);
  const Lit lit(scene);
  const auto open = [&](double x) {
    return BruteForce(scene.lamps[0], {x, 0, 0}, {0, 0, 1});
  };
  const auto floor = [&](double x) { return lit.At({x, 0, 0}, {x, 0, 0.5}); };
  // The umbra ends at 1.05 m, the penumbra at 1.35 m.
  EXPECT_EQ(floor(0.0), 0.0f);
  EXPECT_LT(floor(0.8), 0.01 * open(0.8));
  EXPECT_NEAR(floor(1.2), 0.5 * open(1.2), 0.15 * open(1.2));
  EXPECT_NEAR(floor(2.2), open(2.2), 0.01 * open(0.0));
  float before = -1.0f;
  for (double x = 0.0; x < 1.3; x += 0.01) {
    // While no further one of the four columns of shadow rays gets through,
    // light falls with the distance.
    EXPECT_GE(floor(x), before - 0.005 * open(0.0));
    before = floor(x);
  }
  // Nothing comes through the table: its lower side has what the floor gives.
  EXPECT_LT(lit.At({0, 0, 1}, {0, 0, 0.5}), 0.05f);
}

// A floor that goes on under a wall without thickness, one of whose sides is
// lit: the worst case for leaks.
TEST(LightMap, NoLightBehindAWall) {
  Scene scene = Floor({-3, -3, 0}, {3, 3, 0});
  AddQuad({0.1, -3, 0}, {0.1, 3, 0}, {0.1, -3, 4}, 0, 1, &scene.mesh);
  scene.lamps.push_back(Lamp({1.5, 0, 2.5}, 0.6, 0.6));
  const Lit lit(scene);
  const float bright = lit.OnFloor(0.2, 0.0);
  EXPECT_GT(bright, 0.01f);
  // An eighth of a cell, and where it lies in the grid.
  for (const double gap : {0.035, 0.06, 0.1, 0.2, 0.5}) {
    for (double y = -2.9; y < 3.0; y += 0.11) {
      EXPECT_LT(lit.OnFloor(0.1 - gap, y), 1e-3f * bright) << gap << ' ' << y;
      EXPECT_GT(lit.OnFloor(0.1 + gap, 0.1), 0.5f * bright);
    }
  }
}

// Steps of light between points a hair apart, over cells of all sizes.
float LargestStep(const Lit& lit, bool is_along_x, double at) {
  float largest = 0.0f;
  float before = -1.0f;
  for (double s = -1.9; s < 1.9; s += 0.002) {
    const float light = is_along_x ? lit.OnFloor(s, at) : lit.OnFloor(at, s);
    if (before >= 0.0f) largest = std::max(largest, std::abs(light - before));
    before = light;
  }
  return largest;
}

TEST(LightMap, NoSeamBetweenCellsNorBetweenPieces) {
  Scene scene = Floor({-2, -2, 0}, {2, 2, 0});
  scene.mesh = {};
  // The same floor in four pieces that share no vertex.
  for (const double x : {-2.0, 0.07}) {
    for (const double y : {-2.0, 0.31}) {
      const double right = x < 0.0 ? 0.07 : 2.0;
      const double far = y < 0.0 ? 0.31 : 2.0;
      AddQuad({x, y, 0}, {right, y, 0}, {x, far, 0}, 0, 0, &scene.mesh);
    }
  }
  AddQuad(
      {-0.5, -0.5, 1.2}, {0.5, -0.5, 1.2}, {-0.5, 0.5, 1.2}, 0, 1, &scene.mesh);
  scene.lamps.push_back(Lamp({0, 0, 2.5}, 0.6, 0.6));
  scene.lamps[0].radiance = {10, 10, 10};
  const Lit lit(scene);
  for (const double at : {-1.37, -0.6, 0.051, 0.9}) {
    // From umbra to full light are 1.5 within some 0.3 m: 0.01 for 2 mm.
    EXPECT_LT(LargestStep(lit, true, at), 0.02f);
    EXPECT_LT(LargestStep(lit, false, at), 0.02f);
  }
}

TEST(LightMap, WallsThrowBackTheirColour) {
  Scene scene = Floor({0, -3, 0}, {6, 3, 0});
  AddQuad({0, -3, 0}, {0, 3, 0}, {0, -3, 3}, 0, 1, &scene.mesh);
  scene.lamps.push_back(Lamp({2, 0, 2.9}, 1, 1));
  const Lit lit(scene);
  // White by white: more than the lamp alone gives.
  const double direct = BruteForce(scene.lamps[0], {0.5, 0, 0}, {0, 0, 1});
  EXPECT_GT(lit.OnFloor(0.5, 0.0), 1.02 * direct);
  EXPECT_LT(lit.OnFloor(0.5, 0.0), 2.0 * direct);
}

TEST(LightMap, SameForAnyNumberOfThreads) {
  const Scene scene = FurnishedCorridor();
  LightMapOptions options;
  options.cell_size = 0.5;
  const Lit first(scene, options, 1);
  for (const int num_threads : {2, 3}) {
    const Lit other(scene, options, num_threads);
    ASSERT_EQ(first.map().num_nodes(), other.map().num_nodes());
    for (std::uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
      const auto& corners = scene.mesh.triangles[t].vertices;
      const Vector3f middle =
          (scene.mesh.positions[corners[0]] + scene.mesh.positions[corners[1]] +
           scene.mesh.positions[corners[2]]) /
          3.0f;
      for (const Vector3f& d : {Vector3f(1, 2, 3), Vector3f(-1, -2, -3)}) {
        const Float4 a = first.map().At(t, middle, d);
        const Float4 b = other.map().At(t, middle, d);
        for (int c = 0; c < 3; ++c) EXPECT_EQ(a[c], b[c]);
      }
    }
  }
}

TEST(LightMap, MemoryIsBounded) {
  Scene scene = Floor({0, 0, 0}, {900, 700, 0});
  LightMapOptions options;
  options.max_cells = 5000;
  const Lit lit(scene, options);
  // 128 bytes a cell and side, twice as many for the rectangle about it.
  EXPECT_LT(lit.map().num_bytes(), std::size_t{5000} * 300);
}

TEST(LightMap, OddTrianglesDoNoHarm) {
  Scene scene = Floor({0, 0, 0}, {1, 1, 0});
  scene.ambient = {0.4, 0.4, 0.4};
  // Without area; farther out than cells reach; very small; the largest.
  AddQuad({0, 0, 1}, {0, 0, 1}, {0, 0, 1}, 0, 1, &scene.mesh);
  AddQuad({1e9, 0, 1}, {1e9, 1, 1}, {1e9, 0, 2}, 0, 1, &scene.mesh);
  AddQuad({2, 2, 1}, {2.0001, 2, 1}, {2, 2.0001, 1}, 0, 1, &scene.mesh);
  const double huge = 1e38;
  AddQuad({huge, 0, 0}, {0, huge, 0}, {0, 0, huge}, 0, 1, &scene.mesh);
  const Lit lit(scene);
  EXPECT_NEAR(lit.OnFloor(0.5, 0.5), 0.4, 0.01);
  for (std::uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
    const Float4 light = lit.map().At(t, {1, 1, 1}, {0, 0, 1});
    EXPECT_TRUE(std::isfinite(light[0]));
  }
}

TEST(LightMap, RefusesWrongOptions) {
  const Scene scene = Floor({0, 0, 0}, {1, 1, 0});
  EXPECT_THROW(Lit(scene, {0.0, 1000}), std::invalid_argument);
  EXPECT_THROW(Lit(scene, {0.2, 0}), std::invalid_argument);
  EXPECT_THROW(Lit(scene, {}, 1, {0, 8, 1.0}), std::invalid_argument);
  EXPECT_THROW(Lit(scene, {}, 1, {4, 0, 1.0}), std::invalid_argument);
  EXPECT_THROW(Lit(scene, {}, 1, {4, 8, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace waymark
