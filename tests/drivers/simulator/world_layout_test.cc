#include "drivers/simulator/world_layout.h"

#include "estimation/base/input_error.h"
#include "tests/support/test_worlds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <utility>

namespace waymark {
namespace {

using testing::HasSubstr;

std::string ErrorOf(const World& world) {
  try {
    (void)ResolveLayout(world);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(WorldLayout, FrameOfWallLooksIntoTheRoom) {
  const WorldRoom room = RectangleRoom("a", 1.0, 2.0, 5.0, 4.0, 2.5);
  for (int wall = 0; wall < 4; ++wall) {
    const WallFrame frame = FrameOfWall(room, wall);
    EXPECT_TRUE(IsInside(room.outline, frame.At(frame.length / 2.0, 0.1)));
    EXPECT_FALSE(IsInside(room.outline, frame.At(frame.length / 2.0, -0.1)));
    EXPECT_NEAR(frame.X_WE.linear().determinant(), 1.0, 1e-12);
  }
}

TEST(WorldLayout, OutlinesAreAsFarAsTheirNearestWallOrCorner) {
  const WorldRoom room = RectangleRoom("a", 1.0, 2.0, 5.0, 4.0, 2.5);
  const auto distance = [&](double x, double y) {
    return DistanceToOutline(room.outline, {x, y});
  };
  EXPECT_NEAR(distance(2.0, 2.5), 0.5, 1e-12);
  EXPECT_NEAR(distance(2.0, 1.5), 0.5, 1e-12);
  EXPECT_NEAR(distance(4.9, 3.0), 0.1, 1e-12);
  EXPECT_NEAR(distance(5.3, 4.4), 0.5, 1e-12);
  EXPECT_NEAR(distance(0.7, 1.6), 0.5, 1e-12);
}

TEST(WorldLayout, RectanglesMeasureFromWestAndSouth) {
  const WorldRoom room = RectangleRoom("a", 1.0, 2.0, 5.0, 4.0, 2.5);
  const auto at = [&](int wall, double along) -> Eigen::Vector2d {
    return FrameOfWall(room, wall).At(AlongWall(room, {"a", wall, along}));
  };
  EXPECT_TRUE(at(0, 0.5).isApprox(Eigen::Vector2d(1.5, 2.0)));
  EXPECT_TRUE(at(1, 0.5).isApprox(Eigen::Vector2d(5.0, 2.5)));
  EXPECT_TRUE(at(2, 0.5).isApprox(Eigen::Vector2d(1.5, 4.0)));
  EXPECT_TRUE(at(3, 0.5).isApprox(Eigen::Vector2d(1.0, 2.5)));
}

TEST(WorldLayout, CutsTheWallsOfBothRooms) {
  const World world = TwoRoomsAndCorridor();
  const Layout layout = ResolveLayout(world);
  ASSERT_EQ(layout.passages.size(), 3u);
  for (const Passage& passage : layout.passages) {
    if (passage.other_room < 0) continue;
    EXPECT_NEAR(passage.depth, 0.15, 1e-9);
    const auto& holes =
        layout.holes[static_cast<std::size_t>(passage.other_room)]
                    [static_cast<std::size_t>(passage.other_wall)];
    ASSERT_EQ(holes.size(), 1u);
    const WallFrame here = FrameOfWall(
        world.rooms[static_cast<std::size_t>(passage.room)], passage.wall);
    const WallFrame there =
        FrameOfWall(world.rooms[static_cast<std::size_t>(passage.other_room)],
                    passage.other_wall);
    // Its two ends are straight behind each other.
    EXPECT_NEAR(
        (here.At(passage.hole.begin, -0.15) - there.At(holes[0].end)).norm(),
        0.0,
        1e-9);
  }
  // An opening without a height goes up to the lower ceiling.
  EXPECT_DOUBLE_EQ(layout.passages[0].hole.height, 2.5);
  EXPECT_EQ(layout.passages[2].other_room, -1);
}

TEST(WorldLayout, LeavesTurnAboutTheirHingeIntoTheRoom) {
  for (const Hinge hinge : {Hinge::kLeft, Hinge::kRight}) {
    World world = TwoRoomsAndCorridor();
    WorldDoor& door = world.doors[0];
    door.hinge = hinge;
    for (const double angle : {1.2, -1.2}) {
      door.angle = angle;
      const Layout layout = ResolveLayout(world);
      const DoorLeaf leaf = LeafOf(world, layout.passages[1]);
      const Eigen::Vector3d hinge_W = leaf.X_WD.translation();
      const Eigen::Vector3d end_W = leaf.X_WD * Eigen::Vector3d::UnitX();
      // The wall runs along y = 2; the corridor is south of it. Seen from
      // there, left is west.
      EXPECT_NEAR(hinge_W.x(), hinge == Hinge::kLeft ? 1.55 : 2.45, 1e-9);
      EXPECT_NEAR(hinge_W.y(), angle > 0.0 ? 2.0 : 2.15, 1e-9);
      EXPECT_EQ(end_W.y() < hinge_W.y(), angle > 0.0);
      EXPECT_EQ(end_W.x() > hinge_W.x(), hinge == Hinge::kLeft);
      // Shut, it would lie within the wall.
      const Eigen::Vector3d thick =
          leaf.X_WD.linear() *
          Eigen::Vector3d(0.0, (leaf.low + leaf.high) / 2.0, 0.0);
      const Eigen::Vector3d at_shut =
          Eigen::AngleAxisd((hinge == Hinge::kLeft ? 1.0 : -1.0) * angle,
                            Eigen::Vector3d::UnitZ()) *
              thick +
          hinge_W;
      EXPECT_GT(at_shut.y(), 2.0);
      EXPECT_LT(at_shut.y(), 2.15);
    }
  }
}

TEST(WorldLayout, NamesWhatDoesNotFit) {
  World world = TwoRoomsAndCorridor();
  world.rooms[1].outline[0].y() = 1.9;
  EXPECT_THAT(ErrorOf(world), HasSubstr("test: study: overlaps the room"));
  world = TwoRoomsAndCorridor();
  world.rooms[1].outline[0].y() = 2.0;
  world.rooms[1].outline[1].y() = 2.0;
  EXPECT_THAT(ErrorOf(world), HasSubstr("overlaps the room 'corridor'"));
  world.rooms[1].outline[0].y() = 2.01;
  world.rooms[1].outline[1].y() = 2.01;
  EXPECT_THAT(ErrorOf(world), HasSubstr("must be 0.02 m or farther"));
  world = TwoRoomsAndCorridor();
  std::swap(world.rooms[1].outline[0], world.rooms[1].outline[1]);
  EXPECT_THAT(ErrorOf(world), HasSubstr("outline: walls"));
  world = TwoRoomsAndCorridor();
  std::reverse(world.rooms[1].outline.begin(), world.rooms[1].outline.end());
  EXPECT_THAT(ErrorOf(world), HasSubstr("counter-clockwise"));
}

TEST(WorldLayout, NamesOpeningsThatLeadNowhere) {
  World world = TwoRoomsAndCorridor();
  world.openings[0].where = "w:1: openings[0]";
  world.openings[0].place.wall = 0;
  EXPECT_THAT(ErrorOf(world), HasSubstr("w:1: openings[0]: leads nowhere"));
  world = TwoRoomsAndCorridor();
  world.openings[0].place.at = 9.5;
  EXPECT_THAT(ErrorOf(world), HasSubstr("at = 9.5: must be in [0.75, 9.25]"));
  world = TwoRoomsAndCorridor();
  world.openings[0].place.at = 4.2;  // Half before the wall of each room.
  EXPECT_THAT(ErrorOf(world), HasSubstr("reaches past the wall"));
  world = TwoRoomsAndCorridor();
  world.openings[0].place.at = 2.5;
  EXPECT_THAT(ErrorOf(world), HasSubstr("overlaps another opening"));
  world = TwoRoomsAndCorridor();
  world.openings[0].height = 2.6;
  EXPECT_THAT(ErrorOf(world), HasSubstr("height = 2.6: must be at most"));
  world = TwoRoomsAndCorridor();
  world.doors[1].angle = 0.5;
  EXPECT_THAT(ErrorOf(world), HasSubstr("leads nowhere"));
}

}  // namespace
}  // namespace waymark
