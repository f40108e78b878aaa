#include "drivers/simulator/build_scene.h"

#include "drivers/simulator/build_furniture.h"
#include "drivers/simulator/random_world.h"
#include "drivers/simulator/walk_area.h"
#include "estimation/base/input_error.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/test_worlds.h"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <tuple>

namespace waymark {
namespace {

using Point = std::tuple<float, float, float>;

Point Key(const Eigen::Vector3f& p) {
  return {p.x(), p.y(), p.z()};
}

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() &&
         text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Floors, ceilings, walls and the reveals of doors: what encloses the air.
bool Encloses(const SceneSurface& surface) {
  return surface.kind == SurfaceKind::kFloor ||
         surface.kind == SurfaceKind::kCeiling ||
         (surface.kind == SurfaceKind::kWall &&
          !EndsWith(surface.name, "skirting")) ||
         EndsWith(surface.name, "reveal");
}

std::vector<SceneTriangle> Enclosure(const Scene& scene) {
  std::vector<SceneTriangle> triangles;
  for (const SceneTriangle& triangle : scene.mesh.triangles) {
    if (Encloses(scene.surfaces[triangle.surface])) {
      triangles.push_back(triangle);
    }
  }
  return triangles;
}

std::array<Eigen::Vector3f, 3> Corners(const Scene& scene,
                                       const SceneTriangle& triangle) {
  return {scene.mesh.positions[triangle.vertices[0]],
          scene.mesh.positions[triangle.vertices[1]],
          scene.mesh.positions[triangle.vertices[2]]};
}

Eigen::Vector3d Normal(const Scene& scene, const SceneTriangle& triangle) {
  const auto corner = Corners(scene, triangle);
  return (corner[1] - corner[0])
      .cast<double>()
      .cross((corner[2] - corner[0]).cast<double>());
}

// Edges that a triangle goes along in one sense and none in the other.
int OpenEdges(const Scene& scene) {
  std::map<std::pair<Point, Point>, int> edges;
  for (const SceneTriangle& triangle : Enclosure(scene)) {
    const auto corner = Corners(scene, triangle);
    for (std::size_t i = 0; i < 3; ++i) {
      const Point a = Key(corner[i]);
      const Point b = Key(corner[(i + 1) % 3]);
      ++edges[{a, b}];
      --edges[{b, a}];
    }
  }
  int open = 0;
  for (const auto& [edge, count] : edges) {
    if (count != 0) ++open;
  }
  return open;
}

// Of the air inside, by the divergence theorem; faces look inward.
double Volume(const Scene& scene) {
  double volume = 0.0;
  for (const SceneTriangle& triangle : Enclosure(scene)) {
    const auto corner = Corners(scene, triangle);
    volume -= corner[0].cast<double>().dot(
                  corner[1].cast<double>().cross(corner[2].cast<double>())) /
              6.0;
  }
  return volume;
}

double AreaOf(const Scene& scene, SurfaceKind kind) {
  double area = 0.0;
  for (const SceneTriangle& triangle : scene.mesh.triangles) {
    if (scene.surfaces[triangle.surface].kind == kind) {
      area += Normal(scene, triangle).norm() / 2.0;
    }
  }
  return area;
}

// 15 micrometres of rounding over the surface of a few rooms.
constexpr double kRounding = 0.01;

TEST(BuildScene, OneRoomIsClosedAndHasItsVolume) {
  World world;
  world.rooms = {RectangleRoom("a", 0.0, 0.0, 4.1, 3.3, 2.5)};
  const Scene scene = BuildScene(world);
  EXPECT_EQ(OpenEdges(scene), 0);
  EXPECT_NEAR(Volume(scene), 4.1 * 3.3 * 2.5, kRounding);
  EXPECT_NEAR(AreaOf(scene, SurfaceKind::kFloor), 4.1 * 3.3, kRounding);
}

TEST(BuildScene, DoorsAndOpeningsLeaveNoGap) {
  const World world = TwoRoomsAndCorridor();
  const Scene scene = BuildScene(world);
  EXPECT_EQ(OpenEdges(scene), 0);
  // Two rooms, a corridor, and the air in the passages (test_worlds.h).
  const double rooms = 10.0 * 2.0 * 2.5 + 4.0 * 3.0 * 3.0 + 5.85 * 3.0 * 2.5;
  const double passages =
      0.9 * 2.05 * 0.15 + 1.5 * 2.5 * 0.15 + 0.8 * 2.0 * 0.12;
  EXPECT_NEAR(Volume(scene), rooms + passages, kRounding);
}

TEST(BuildScene, SlantedRoomsFitTogether) {
  const World world = Turned(TwoRoomsAndCorridor(), 0.3, {3.0, -2.0});
  const Scene scene = BuildScene(world);
  EXPECT_EQ(OpenEdges(scene), 0);
}

TEST(BuildScene, LShapedRoomIsClosed) {
  World world;
  world.rooms = {
      OutlineRoom("l", {{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 5}, {0, 5}}, 2.4)};
  const Scene scene = BuildScene(world);
  EXPECT_EQ(OpenEdges(scene), 0);
  EXPECT_NEAR(Volume(scene), (6 * 2 + 2 * 3) * 2.4, kRounding);
}

// How many metres of the surface the texture's whole width and height cover.
TEST(BuildScene, TexturesHaveTheirTrueSize) {
  World world = TwoRoomsAndCorridor();
  for (WorldRoom& room : world.rooms) {
    room.floor = "tiles";
    room.ceiling = "ceiling_panels";
    room.walls.assign(room.outline.size(), "brick");
  }
  const Scene scene = BuildScene(world);
  std::map<std::string, Eigen::Vector2d> sizes;
  for (const PatternKind kind : {PatternKind::kTiles,
                                 PatternKind::kCeilingPanels,
                                 PatternKind::kBrick}) {
    PatternOptions options;
    options.kind = kind;
    sizes[NameOf(kind)] = MakePattern(options).size;
  }
  int checked = 0;
  for (const SceneTriangle& triangle : scene.mesh.triangles) {
    const auto size = sizes.find(scene.materials[triangle.material].name);
    if (size == sizes.end()) continue;
    ++checked;
    const auto corner = Corners(scene, triangle);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = (i + 1) % 3;
      const Eigen::Vector2d uv = (scene.mesh.uvs[triangle.vertices[k]] -
                                  scene.mesh.uvs[triangle.vertices[i]])
                                     .cast<double>();
      EXPECT_NEAR(uv.cwiseProduct(size->second).norm(),
                  (corner[k] - corner[i]).cast<double>().norm(),
                  1e-4);
    }
    // Not mirrored: as seen from inside, v goes down where u goes right.
    const auto& uvs = scene.mesh.uvs;
    const Eigen::Vector2f du =
        uvs[triangle.vertices[1]] - uvs[triangle.vertices[0]];
    const Eigen::Vector2f dv =
        uvs[triangle.vertices[2]] - uvs[triangle.vertices[0]];
    EXPECT_LT(du.x() * dv.y() - du.y() * dv.x(), 0.0f);
  }
  EXPECT_GT(checked, 20);
}

TEST(BuildScene, FurnitureKeepsToItsPlaceAndFacesOutward) {
  World world;
  world.rooms = {RectangleRoom("a", -3.0, -3.0, 30.0, 3.0, 2.5)};
  for (int i = 0; i <= static_cast<int>(FurnitureKind::kBox); ++i) {
    WorldFurniture piece;
    piece.kind = static_cast<FurnitureKind>(i);
    piece.at << 3.0 * i, 1.0;
    piece.heading = 0.7;
    piece.size << 0.7, 1.2, 1.1;
    piece.material = "plain";
    world.furniture.push_back(piece);
  }
  const Scene scene = BuildScene(world);
  for (const WorldFurniture& piece : world.furniture) {
    const std::string name = NameOf(piece.kind);
    const Eigen::Vector3d middle(piece.at.x(), piece.at.y(), 0.5);
    Eigen::AlignedBox3d box;
    double volume = 0.0;
    for (const SceneTriangle& triangle : scene.mesh.triangles) {
      if (scene.surfaces[triangle.surface].name != name) continue;
      const auto corner = Corners(scene, triangle);
      volume +=
          (corner[0].cast<double>() - middle).dot(Normal(scene, triangle)) /
          6.0;
      for (const Eigen::Vector3f& p : corner) box.extend(p.cast<double>());
    }
    EXPECT_GT(volume, 0.0) << name;
    EXPECT_GE(box.min().z(), -1e-4) << name;
    // Half the diagonal of its base, and a tenth.
    const double reach = 1.1 * std::hypot(0.7, 1.2) / 2.0;
    const auto off = [&](const Eigen::Vector3d& p) {
      return (p - middle).head<2>().cwiseAbs().maxCoeff();
    };
    EXPECT_LT(off(box.min()), reach) << name;
    EXPECT_LT(off(box.max()), reach) << name;
    // A screen stands on a desk.
    EXPECT_LT(box.max().z(), piece.kind == FurnitureKind::kDesk ? 1.6 : 1.11);
  }
}

TEST(BuildScene, ShutLeafFillsItsOpening) {
  World world = TwoRoomsAndCorridor();
  const Scene scene = BuildScene(world);
  // The niche's leaf: 0.8 x 2 m, front and back, and its edges.
  double area = 0.0;
  for (const SceneTriangle& triangle : scene.mesh.triangles) {
    const SceneSurface& surface = scene.surfaces[triangle.surface];
    if (surface.name != "corridor south door 2") continue;
    area += Normal(scene, triangle).norm() / 2.0;
  }
  EXPECT_NEAR(area, 2 * 0.8 * 2.0 + 2 * 0.04 * 2.8, 1e-3);
}

TEST(BuildScene, LampsHangUnderTheCeiling) {
  World world;
  world.rooms = {RectangleRoom("a", 0.0, 0.0, 6.0, 3.0, 2.5)};
  world.rooms[0].lamps = {3, 1};
  world.rooms[0].light = 0.5;
  const Scene scene = BuildScene(world);
  ASSERT_EQ(scene.lamps.size(), 3u);
  EXPECT_NEAR(scene.lamps[1].p_W.x(), 3.0, 1e-9);
  EXPECT_NEAR(scene.lamps[1].p_W.y(), 1.5, 1e-9);
  EXPECT_LT(scene.lamps[1].p_W.z(), 2.5);
  world.rooms[0].light = 1.0;
  EXPECT_NEAR(BuildScene(world).lamps[0].radiance.x(),
              2.0 * scene.lamps[0].radiance.x(),
              1e-9);
}

TEST(BuildScene, SameWorldSameScene) {
  World world = TwoRoomsAndCorridor();
  WorldPictureRow row;
  row.room = "corridor";
  row.spacing = 4.0;
  world.picture_rows = {row};
  const Scene a = BuildScene(world);
  const Scene b = BuildScene(world);
  EXPECT_EQ(a.mesh.positions, b.mesh.positions);
  EXPECT_EQ(a.mesh.uvs, b.mesh.uvs);
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (std::size_t i = 0; i < a.materials.size(); ++i) {
    const cv::Mat3b& texture = a.materials[i].texture;
    EXPECT_TRUE(std::equal(texture.begin(),
                           texture.end(),
                           b.materials[i].texture.begin(),
                           b.materials[i].texture.end()));
  }
}

TEST(BuildScene, FloorPlansBecomeWalls) {
  const TemporaryDirectory folder;
  // 6 x 4 m with a wall of 0.5 m around and a pillar of 1 m in the middle.
  cv::Mat1b image(40, 60, std::uint8_t{0});
  image(cv::Rect(5, 5, 50, 30)) = 255;
  image(cv::Rect(25, 15, 10, 10)) = 0;
  ASSERT_TRUE(cv::imwrite(folder / "plan.png", image));
  World world;
  WorldFloorPlan plan;
  plan.image = folder / "plan.png";
  plan.metres_per_pixel = 0.1;
  plan.at << 10.0, 20.0;
  plan.height = 2.5;
  world.floor_plans = {plan};
  const Scene scene = BuildScene(world);
  EXPECT_NEAR(AreaOf(scene, SurfaceKind::kFloor), 6.0 * 4.0, 1e-3);
  // The outside of the wall counts as well.
  const double inside = 2 * (5.0 + 3.0) * 2.5 + 4 * 1.0 * 2.5;
  const double outside = 2 * (6.0 + 4.0) * 2.5;
  EXPECT_NEAR(AreaOf(scene, SurfaceKind::kWall), inside + outside, 0.05);
  const WalkArea area(world);
  EXPECT_NEAR(area.Clearance({11.5, 22.0}), 1.0, 0.02);
  EXPECT_LT(area.Clearance({13.0, 22.0}), 0.0);  // In the pillar.
  EXPECT_LT(area.Clearance({10.2, 22.0}), 0.0);  // In the wall.
  EXPECT_LT(area.Clearance({9.0, 22.0}), 0.0);   // Outside.
}

TEST(BuildScene, ModelsAreScaledTurnedAndPlaced) {
  const TemporaryDirectory folder;
  std::ofstream(folder / "t.obj") << "v 1 0 0\nv 2 0 0\nv 1 3 0\nf 1 2 3\n";
  World world;
  WorldModel model;
  model.file = folder / "t.obj";
  model.scale = 0.5;
  model.at << 5.0, 6.0, 1.0;
  model.heading = std::numbers::pi / 2.0;
  world.models = {model};
  const Scene scene = BuildScene(world);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : scene.mesh.positions) {
    box.extend(p.cast<double>());
  }
  // The file's y is up; its x turns to W's y.
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3d(5.0, 6.5, 1.0), 1e-5));
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3d(5.0, 7.0, 2.5), 1e-5));
  world.models[0].where = "w.yaml:2: models[0]";
  world.models[0].file = folder / "none.obj";
  try {
    (void)BuildScene(world);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                testing::StartsWith("w.yaml:2: models[0]: file: "));
  }
}

TEST(BuildScene, RefusesWhatItCannotBuild) {
  const auto error_of = [](const World& world) -> std::string {
    try {
      (void)BuildScene(world);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  World world = TwoRoomsAndCorridor();
  world.rooms[0].where = "w.yaml:3: rooms[0]";
  world.rooms[0].floor = "lava";
  EXPECT_THAT(
      error_of(world),
      testing::StartsWith(
          "w.yaml:3: rooms[0]: floor = lava: must be one of: linoleum"));
  world = TwoRoomsAndCorridor();
  world.pillars.emplace_back();
  world.pillars[0].where = "w.yaml:9: pillars[0]";
  world.pillars[0].at << -5.0, 0.0;
  EXPECT_EQ(error_of(world), "w.yaml:9: pillars[0]: at: is in no room");
}

TEST(BuildScene, RandomWorldsAreClosed) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Scene scene = BuildScene(RandomWorld(seed), SceneLooks::kPlain);
    EXPECT_EQ(OpenEdges(scene), 0) << seed;
  }
}

TEST(BuildScene, PlainLooksAreTheSameMesh) {
  const World world = TwoRoomsAndCorridor();
  const Scene drawn = BuildScene(world);
  const Scene plain = BuildScene(world, SceneLooks::kPlain);
  EXPECT_EQ(plain.mesh.positions, drawn.mesh.positions);
  ASSERT_EQ(plain.mesh.triangles.size(), drawn.mesh.triangles.size());
  for (std::size_t i = 0; i < plain.mesh.triangles.size(); ++i) {
    EXPECT_EQ(plain.mesh.triangles[i].vertices,
              drawn.mesh.triangles[i].vertices);
  }
  for (const SceneMaterial& material : plain.materials) {
    EXPECT_EQ(material.texture.total(), 1u) << material.name;
  }
}

// Their light would take hours.
TEST(BuildScene, RefusesWorldsFarLargerThanBuildings) {
  const auto error_of = [](const World& world) -> std::string {
    try {
      (void)BuildScene(world);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  World world;
  world.rooms = {RectangleRoom("plain", -100, -100, 100, 100.1, 3.0)};
  world.rooms[0].where = "w.yaml:1: rooms[0]";
  EXPECT_EQ(error_of(world),
            "w.yaml:1: rooms[0]: more than 20000 m^2 of floor with this room");
  world.rooms = {RectangleRoom("hall", 0, 0, 30, 30, 3.0)};
  world.rooms[0].lamps = {50, 41};
  EXPECT_THAT(error_of(world), testing::HasSubstr("more than 2000 lamps"));

  const TemporaryDirectory folder;
  cv::Mat1b image(400, 400, std::uint8_t{255});
  image.row(0) = 0;
  ASSERT_TRUE(cv::imwrite(folder / "plan.png", image));
  WorldFloorPlan plan;
  plan.where = "w.yaml:2: floor_plans[0]";
  plan.image = folder / "plan.png";
  plan.metres_per_pixel = 0.5;
  world.rooms.clear();
  world.floor_plans = {plan};
  EXPECT_EQ(error_of(world),
            "w.yaml:2: floor_plans[0]: metres_per_pixel: the image is 200 x "
            "200 m with it: more than 20000 m^2 of floor with this plan");
  world.floor_plans[0].metres_per_pixel = 10.0;
  EXPECT_THAT(error_of(world), testing::HasSubstr("reaches beyond 200 m"));
  // Its lamps count with those of rooms.
  world.floor_plans[0].metres_per_pixel = 0.3;  // 40 x 40 lamps.
  WorldLamp lamp;
  lamp.at << 1.0, 1.0, 2.0;
  world.lamps.assign(401, lamp);
  EXPECT_THAT(
      error_of(world),
      testing::AllOf(
          testing::StartsWith("w.yaml:2: floor_plans[0]: metres_per_pixel: "),
          testing::HasSubstr("more than 2000 lamps with this plan's")));
  world.lamps.clear();
  EXPECT_EQ(BuildScene(world, SceneLooks::kPlain).lamps.size(), 1600u);
}

// Lines across them, and their light, would take hours.
TEST(BuildScene, RefusesModelsWithFarMoreFacesThanBuildings) {
  const TemporaryDirectory folder;
  {
    std::ofstream file(folder / "levels.obj");
    file << "v 0 0.5 0\nv 199 0.5 0\nv 199 0.5 199\nv 0 0.5 199\n";
    for (int i = 0; i < 3; ++i) file << "f 1 2 3 4\n";
  }
  World world;
  WorldModel model;
  model.where = "w.yaml:2: models[0]";
  model.file = folder / "levels.obj";
  model.at << 0.0, 199.0, 0.0;
  world.models = {model};
  EXPECT_FALSE(WalkArea(world).map().segments().empty());
  model.where = "w.yaml:3: models[1]";
  world.models.push_back(model);
  EXPECT_THROW((void)BuildScene(world), InputError);
  try {
    (void)BuildScene(world, SceneLooks::kPlain);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "w.yaml:3: models[1]: file: " + model.file +
                  ": more than 200000 m^2 of faces with this model");
  }
}

}  // namespace
}  // namespace waymark
