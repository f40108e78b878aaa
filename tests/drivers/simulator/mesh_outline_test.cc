#include "drivers/simulator/mesh_outline.h"

#include "drivers/simulator/obstacle_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace waymark {
namespace {

void AddTriangle(const Eigen::Vector3f& a,
                 const Eigen::Vector3f& b,
                 const Eigen::Vector3f& c,
                 SceneMesh* mesh) {
  const auto first = static_cast<std::uint32_t>(mesh->positions.size());
  mesh->positions.insert(mesh->positions.end(), {a, b, c});
  mesh->triangles.push_back({{first, first + 1, first + 2}, 0, 0});
}

void AddWall(const Eigen::Vector2f& a,
             const Eigen::Vector2f& b,
             float low,
             float high,
             SceneMesh* mesh) {
  const Eigen::Vector3f al(a.x(), a.y(), low), ah(a.x(), a.y(), high);
  const Eigen::Vector3f bl(b.x(), b.y(), low), bh(b.x(), b.y(), high);
  AddTriangle(al, bl, bh, mesh);
  AddTriangle(al, bh, ah, mesh);
}

double Length(const std::vector<Segment2>& segments) {
  double sum = 0.0;
  for (const Segment2& s : segments) sum += (s.b - s.a).norm();
  return sum;
}

TEST(MeshOutline, AWallOfTwoTrianglesIsOneSegment) {
  SceneMesh mesh;
  AddWall({1.0f, 2.0f}, {4.0f, 6.0f}, 0.0f, 2.6f, &mesh);
  const auto outline = OutlineOfMesh(mesh, {});
  ASSERT_EQ(outline.size(), 1u);
  EXPECT_NEAR((outline[0].b - outline[0].a).norm(), 5.0, 1e-5);
  EXPECT_NEAR(std::min(outline[0].a.x(), outline[0].b.x()), 1.0, 1e-5);
}

TEST(MeshOutline, PiecesOfOneLineAreJoinedAndGapsStay) {
  SceneMesh mesh;
  AddWall({0.0f, 1.0f}, {2.0f, 1.0f}, 0.0f, 2.6f, &mesh);
  AddWall({5.0f, 1.0f}, {2.0f, 1.0f}, 0.0f, 2.6f, &mesh);  // Other side.
  AddWall({6.0f, 1.0f}, {9.0f, 1.0f}, 0.0f, 2.6f, &mesh);  // Past a door.
  AddWall({5.0f, 1.0f}, {6.0f, 1.0f}, 2.1f, 2.6f, &mesh);  // Its lintel.
  AddWall({0.0f, 1.1f}, {9.0f, 1.1f}, 0.0f, 2.6f, &mesh);  // Behind.
  const auto outline = OutlineOfMesh(mesh, {});
  EXPECT_EQ(outline.size(), 3u);
  EXPECT_NEAR(Length(outline), 5.0 + 3.0 + 9.0, 1e-5);
}

TEST(MeshOutline, BandLeavesOutFloorAndWhatIsHigher) {
  SceneMesh mesh;
  AddTriangle({0, 0, 0}, {9, 0, 0}, {0, 9, 0}, &mesh);              // Floor.
  AddTriangle({0, 0, 2.6f}, {9, 0, 2.6f}, {0, 9, 2.6f}, &mesh);     // Ceiling.
  AddTriangle({1, 1, .7f}, {1.1f, 1, .7f}, {1, 1.1f, .7f}, &mesh);  // A stool.
  EXPECT_TRUE(OutlineOfMesh(mesh, {0.02, 0.6}).empty());
  EXPECT_TRUE(OutlineOfMesh(mesh, {0.8, 2.0}).empty());
  const auto high = OutlineOfMesh(mesh, {});
  EXPECT_EQ(high.size(), 3u);
  EXPECT_NEAR(Length(high), 0.2 + 0.1 * std::sqrt(2.0), 1e-5);
}

TEST(MeshOutline, NothingIsFreeWithinATableTop) {
  SceneMesh mesh;
  AddTriangle({1, 1, 0.7f}, {4, 1, 0.7f}, {4, 3, 0.7f}, &mesh);
  AddTriangle({1, 1, 0.7f}, {4, 3, 0.7f}, {1, 3, 0.7f}, &mesh);
  const ObstacleMap map(OutlineOfMesh(mesh, {}));
  for (double x = 1.0; x <= 4.0; x += 0.05) {
    for (double y = 1.0; y <= 3.0; y += 0.05) {
      EXPECT_TRUE(map.Nearest({x, y}, kHatch / 2.0 + 1e-6)) << x << " " << y;
    }
  }
  EXPECT_FALSE(map.Nearest({0.9, 2.0}, 0.099));  // As large as it is.
  EXPECT_FALSE(map.Nearest({2.0, 3.1}, 0.099));
}

TEST(MeshOutline, ARampCountsFromWhereItReachesTheBand) {
  SceneMesh mesh;
  // Rises by 0.1 per metre along x: in the band from x = 0.2 to 5.
  AddTriangle({0, 0, 0}, {10, 0, 1}, {10, 2, 1}, &mesh);
  AddTriangle({0, 0, 0}, {10, 2, 1}, {0, 2, 0}, &mesh);
  double low = 1e9;
  double high = -1e9;
  for (const Segment2& s : OutlineOfMesh(mesh, {0.02, 0.5})) {
    low = std::min({low, s.a.x(), s.b.x()});
    high = std::max({high, s.a.x(), s.b.x()});
  }
  EXPECT_NEAR(low, 0.2, 1e-5);
  EXPECT_NEAR(high, 5.0, 1e-5);
}

TEST(MeshOutline, RefusesWhatIsNoMesh) {
  SceneMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}};
  mesh.triangles.push_back({{0, 1, 2}, 0, 0});
  EXPECT_THROW((void)OutlineOfMesh(mesh, {}), std::logic_error);
  EXPECT_THROW((void)OutlineOfMesh({}, {0.5, 0.5}), std::logic_error);
}

}  // namespace
}  // namespace waymark
