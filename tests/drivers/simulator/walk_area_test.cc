#include "drivers/simulator/walk_area.h"

#include "tests/support/temporary_directory.h"
#include "tests/support/test_worlds.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace waymark {
namespace {

TEST(WalkArea, MeasuresToTheNearestWall) {
  World world;
  world.rooms = {RectangleRoom("a", 0.0, 0.0, 4.0, 3.0, 2.5)};
  world.rooms[0].skirting_height = 0.0;
  const WalkArea area(world);
  EXPECT_NEAR(area.Clearance({2.0, 1.0}), 1.0, 1e-6);
  EXPECT_NEAR(area.Clearance({0.3, 1.0}), 0.3, 1e-6);
  EXPECT_NEAR(area.Clearance({-0.2, 1.0}), -0.2, 1e-6);
}

TEST(WalkArea, DoorwaysAreOpenAndShutDoorsAreNot) {
  World world = TwoRoomsAndCorridor();
  // In the middle of the open passage: half its width to each side.
  EXPECT_NEAR(WalkArea(world).Clearance({7.0, 2.075}), 0.75, 1e-6);
  // The open leaf stands at the hinge, in the corridor.
  EXPECT_LT(WalkArea(world).Clearance({1.57, 1.5}), 0.0);
  EXPECT_GT(WalkArea(world).Clearance({1.9, 1.5}), 0.2);
  world.doors[0].angle = 0.0;
  EXPECT_LT(WalkArea(world).Clearance({2.0, 2.035}), 0.0);  // In the leaf.
}

TEST(WalkArea, FurnitureAndPillarsAreInTheWay) {
  World world;
  world.rooms = {RectangleRoom("a", 0.0, 0.0, 10.0, 10.0, 2.5)};
  WorldFurniture piece;
  piece.at << 5.0, 5.0;
  piece.size << 1.0, 2.0, 0.7;
  world.furniture = {piece};
  WorldPillar pillar;
  pillar.at << 8.0, 8.0;
  pillar.shape = PillarShape::kRound;
  pillar.size = 0.6;
  world.pillars = {pillar};
  const WalkArea area(world);
  EXPECT_NEAR(area.Clearance({6.0, 5.0}), 0.5, 1e-6);  // Before its front.
  EXPECT_NEAR(area.Clearance({5.0, 6.5}), 0.5, 1e-6);  // Beside it.
  EXPECT_LE(area.Clearance({5.0, 5.0}), 0.0);
  // A polygon of 24 sides is 0.3 mm nearer than the circle.
  EXPECT_NEAR(area.Clearance({8.0, 7.0}), 0.7, 0.003);
  EXPECT_LT(area.Clearance({8.0, 8.0}), 0.0);
}

TEST(WalkArea, ATableIsInTheWayOfWhatIsHigherThanItsTop) {
  World world;
  world.rooms = {RectangleRoom("a", 0.0, 0.0, 10.0, 10.0, 2.5)};
  WorldFurniture table;
  table.kind = FurnitureKind::kTable;
  table.at << 5.0, 5.0;
  table.size << 2.0, 3.0, 0.74;
  world.furniture = {table};
  const Eigen::Vector2d below(5.0, 5.3);
  // Lines across its top are at most 0.2 m apart.
  EXPECT_LE(WalkArea(world, 1.1).Clearance(below), 0.1);
  EXPECT_GT(WalkArea(world, 0.5).Clearance(below), 0.3);
}

TEST(WalkArea, ModelsAreInTheWayAndTheirSurroundingsAreAllThatIsFree) {
  TemporaryDirectory folder;
  const std::string file = folder / "wall.obj";
  std::ofstream(file) << "v 1 0 0\nv 1 4 0\nv 1 4 2\nv 1 0 2\n"
                         "v 5 0 0\nv 5 4 0\nv 5 4 2\nv 5 0 2\n"
                         "f 1 2 3 4\nf 5 6 7 8\n";
  World world;
  world.models.push_back({"w.yaml:1: models[0]", file});
  world.models[0].is_y_up = false;
  EXPECT_NEAR(WalkArea(world).Clearance({1.3, 2.0}), 0.3, 1e-6);
  EXPECT_LT(WalkArea(world).Clearance({0.5, 2.0}), 0.0);
  world.rooms = {RectangleRoom("a", 0.0, 0.0, 9.0, 4.0, 2.5)};
  EXPECT_NEAR(WalkArea(world).Clearance({0.5, 2.0}), 0.488, 0.02);
  EXPECT_NEAR(WalkArea(world).Clearance({1.1, 2.0}), 0.1, 1e-6);
}

TEST(WalkArea, WithoutAPlanEverythingIsFree) {
  EXPECT_GT(WalkArea(World{}).Clearance({3.0, 4.0}), 100.0);
}

}  // namespace
}  // namespace waymark
