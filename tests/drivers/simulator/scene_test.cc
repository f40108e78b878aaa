#include "drivers/simulator/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace waymark {
namespace {

using testing::HasSubstr;

Scene OneTriangle() {
  Scene scene;
  scene.materials.push_back({"white", cv::Mat3b(1, 1), false});
  scene.surfaces.push_back({"wall", SurfaceKind::kWall});
  scene.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
  scene.mesh.triangles.push_back({{0, 1, 2}, 0, 0});
  scene.lamps.emplace_back();
  return scene;
}

std::string ErrorOf(const Scene& scene) {
  try {
    CheckScene(scene);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

TEST(CheckScene, TakesASoundScene) {
  EXPECT_EQ(ErrorOf(OneTriangle()), "none");
  EXPECT_EQ(ErrorOf(Scene{}), "none");
}

TEST(CheckScene, NamesTheFirstThingOutOfOrder) {
  Scene scene = OneTriangle();
  scene.mesh.triangles[0].vertices[2] = 3;
  EXPECT_THAT(ErrorOf(scene), HasSubstr("mesh, triangle 0: no such vertex"));

  scene = OneTriangle();
  scene.mesh.triangles[0].material = 1;
  EXPECT_THAT(ErrorOf(scene), HasSubstr("triangle 0: no such material"));

  scene = OneTriangle();
  scene.mesh.triangles[0].surface = 1;
  EXPECT_THAT(ErrorOf(scene), HasSubstr("triangle 0: no such surface"));

  scene = OneTriangle();
  scene.mesh.positions[1].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(ErrorOf(scene), HasSubstr("vertex 1: not finite"));

  scene = OneTriangle();
  scene.mesh.uvs.pop_back();
  EXPECT_THAT(ErrorOf(scene), HasSubstr("as many uvs as positions"));

  scene = OneTriangle();
  scene.materials[0].texture.release();
  EXPECT_THAT(ErrorOf(scene), HasSubstr("material white: no texture"));

  scene = OneTriangle();
  scene.lamps[0].size.y() = 0.0;
  EXPECT_THAT(ErrorOf(scene), HasSubstr("lamp 0: its size"));

  scene = OneTriangle();
  scene.movers.push_back({"person", scene.mesh, 0.0, 1.7});
  EXPECT_THAT(ErrorOf(scene), HasSubstr("mover person: radius"));
}

TEST(FingerprintOf, ChangesWithEverythingButNames) {
  Scene scene = OneTriangle();
  scene.materials[0].texture = cv::Vec3b(1, 2, 3);
  scene.movers.push_back({"person", scene.mesh, 0.3, 1.8});
  scene.movers[0].name = "other";
  const std::uint64_t before = FingerprintOf(scene);
  scene.movers[0].name = "person";
  scene.surfaces[0].name = "north";
  EXPECT_EQ(FingerprintOf(scene), before);
  const auto changed = [&](const auto& change) {
    Scene other = scene;
    other.materials[0].texture = scene.materials[0].texture.clone();
    change(&other);
    return FingerprintOf(other) != before;
  };
  EXPECT_TRUE(changed([](Scene* s) { s->mesh.positions[1].z() = 1e-6f; }));
  EXPECT_TRUE(changed([](Scene* s) { s->mesh.uvs[2].x() = 0.5f; }));
  EXPECT_TRUE(changed([](Scene* s) { s->mesh.triangles[0].vertices[2] = 0; }));
  EXPECT_TRUE(changed([](Scene* s) { s->materials[0].texture(0, 0)[2] = 4; }));
  EXPECT_TRUE(changed([](Scene* s) { s->materials[0].is_emissive = true; }));
  EXPECT_TRUE(
      changed([](Scene* s) { s->surfaces[0].kind = SurfaceKind::kFloor; }));
  EXPECT_TRUE(changed([](Scene* s) { s->lamps[0].radiance[0] = 2.0; }));
  EXPECT_TRUE(changed([](Scene* s) { s->ambient[1] = 0.0; }));
  EXPECT_TRUE(changed([](Scene* s) { s->movers[0].height = 1.7; }));
  EXPECT_TRUE(changed([](Scene* s) { s->movers.clear(); }));
}

}  // namespace
}  // namespace waymark
