#include "drivers/simulator/random_world.h"

#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/mesh_outline.h"
#include "drivers/simulator/obstacle_map.h"
#include "drivers/simulator/walk_area.h"
#include "drivers/simulator/world_layout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>
#include <vector>

namespace waymark {
namespace {

constexpr std::uint64_t kNumSeeds = 200;

TEST(RandomWorld, EveryoneHasAFreeStartAndPeopleWhoStandOnFloor) {
  for (std::uint64_t seed = 0; seed < kNumSeeds; ++seed) {
    const World world = RandomWorld(seed);
    ASSERT_EQ(world.starts.size(), 1u) << seed;
    const WalkArea area(world);
    const Eigen::Vector2d start = world.starts[0].X_WR.position();
    EXPECT_GE(area.Clearance(start), kStartClearance - 1e-9) << seed;
    for (const WorldPerson& person : world.people) {
      EXPECT_EQ(person.motion, PersonMotion::kStand);
      EXPECT_GT(area.Clearance(person.at), 0.0) << seed;
      EXPECT_GT((person.at - start).norm(), kStartClearance) << seed;
    }
  }
}

// With any compiler: a start follows from all that was drawn before.
TEST(RandomWorld, DrawsComeInOneOrder) {
  for (const auto& [seed, x, y] : {std::tuple(3, -1.0219675056, -2.5145584693),
                                   {17, 0.6753311824, -0.7065954655},
                                   {29, 4.6710956585, 3.7152367558},
                                   {41, 2.1977470235, 3.1645812946}}) {
    const World world = RandomWorld(static_cast<std::uint64_t>(seed));
    EXPECT_NEAR(world.starts[0].X_WR.x, x, 1e-8) << seed;
    EXPECT_NEAR(world.starts[0].X_WR.y, y, 1e-8) << seed;
  }
}

// What the robot bumps into, too: walls all around, nothing at the start.
TEST(RandomWorld, CanBeBuiltAndHoldsARobot) {
  for (std::uint64_t seed = 0; seed < kNumSeeds; ++seed) {
    const World world = RandomWorld(seed);
    const Scene scene = BuildScene(world, SceneLooks::kPlain);
    const ObstacleMap map(OutlineOfMesh(scene.mesh, HeightBand{}));
    const Eigen::Vector2d start = world.starts[0].X_WR.position();
    EXPECT_FALSE(map.Nearest(start, 0.95 * kStartClearance)) << seed;
    for (int i = 0; i < 360; ++i) {
      EXPECT_TRUE(map.CastRay(start, i * 3.14159 / 180.0, 100.0))
          << seed << " at " << i << " deg";
    }
  }
}

TEST(RandomWorld, RoomsAreJoined) {
  for (std::uint64_t seed = 0; seed < kNumSeeds; ++seed) {
    const World world = RandomWorld(seed);
    std::set<int> reached{0};
    const Layout layout = ResolveLayout(world);
    for (std::size_t i = 0; i < layout.passages.size(); ++i) {
      for (const Passage& passage : layout.passages) {
        if (passage.other_room < 0) continue;
        if (reached.contains(passage.room)) reached.insert(passage.other_room);
        if (reached.contains(passage.other_room)) reached.insert(passage.room);
      }
    }
    EXPECT_EQ(reached.size(), world.rooms.size()) << seed;
  }
}

TEST(RandomWorld, AreOfAllKinds) {
  std::set<std::size_t> num_rooms;
  int num_turned = 0;
  int num_slanting = 0;
  int num_shut = 0;
  int num_open = 0;
  int num_round = 0;
  int num_square = 0;
  std::set<FurnitureKind> kinds;
  for (std::uint64_t seed = 0; seed < kNumSeeds; ++seed) {
    const World world = RandomWorld(seed);
    num_rooms.insert(world.rooms.size());
    const Eigen::Vector2d side =
        world.rooms[0].outline[1] - world.rooms[0].outline[0];
    num_turned += std::abs(side.x() * side.y()) > 1e-9;
    num_slanting += world.rooms[0].outline.size() > 4;
    for (const WorldDoor& door : world.doors) {
      (door.angle == 0.0 ? num_shut : num_open) += 1;
    }
    for (const WorldPillar& pillar : world.pillars) {
      (pillar.shape == PillarShape::kRound ? num_round : num_square) += 1;
    }
    for (const WorldFurniture& piece : world.furniture) {
      kinds.insert(piece.kind);
    }
  }
  EXPECT_EQ(num_rooms.size(), 5u);
  EXPECT_EQ(kinds.size(), 9u);
  for (const int num : {num_turned, num_slanting, num_shut, num_open}) {
    EXPECT_GT(num, 50);
  }
  EXPECT_GT(num_round, 50);
  EXPECT_GT(num_square, 50);
}

TEST(RandomWorld, SameSeedSameWorldOtherSeedAnother) {
  std::set<double> starts;
  for (std::uint64_t seed = 0; seed < kNumSeeds; ++seed) {
    const World world = RandomWorld(seed);
    const World again = RandomWorld(seed);
    starts.insert(world.starts[0].X_WR.x);
    EXPECT_EQ(world.starts[0].X_WR, again.starts[0].X_WR);
    ASSERT_EQ(world.furniture.size(), again.furniture.size());
    for (std::size_t i = 0; i < world.furniture.size(); ++i) {
      EXPECT_EQ(world.furniture[i].at, again.furniture[i].at);
    }
  }
  EXPECT_EQ(starts.size(), kNumSeeds);
}

}  // namespace
}  // namespace waymark
