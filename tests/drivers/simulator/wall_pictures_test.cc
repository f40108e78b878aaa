#include "drivers/simulator/wall_pictures.h"

#include "estimation/base/input_error.h"
#include "tests/support/test_worlds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

using testing::HasSubstr;

World WithRow(std::uint64_t world_seed) {
  World world = TwoRoomsAndCorridor();
  WorldPictureRow row;
  row.room = "corridor";
  row.spacing = 1.1;
  world.picture_rows = {row};
  world.seed = world_seed;
  return world;
}

TEST(WallPictures, RowsKeepClearOfDoorsAndEachOther) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const World world = WithRow(seed);
    const Layout layout = ResolveLayout(world);
    const auto hung = HangPictures(world, layout);
    EXPECT_GT(hung.size(), 8u);
    for (std::size_t i = 0; i < hung.size(); ++i) {
      const double begin = hung[i].along - hung[i].size.x() / 2.0;
      const double end = hung[i].along + hung[i].size.x() / 2.0;
      EXPECT_GE(begin, 0.1);
      EXPECT_LE(end, FrameOfWall(world.rooms[0], hung[i].wall).length - 0.1);
      for (const WallHole& hole :
           layout.holes[0][static_cast<std::size_t>(hung[i].wall)]) {
        EXPECT_TRUE(end < hole.begin - 0.1 || begin > hole.end + 0.1 ||
                    hung[i].height - hung[i].size.y() / 2.0 > hole.height);
      }
      for (std::size_t k = 0; k < i; ++k) {
        if (hung[k].wall != hung[i].wall) continue;
        EXPECT_GE(std::abs(hung[k].along - hung[i].along),
                  (hung[k].size.x() + hung[i].size.x()) / 2.0 + 0.1);
      }
      EXPECT_LT(hung[i].height + hung[i].size.y() / 2.0, 2.5);
    }
  }
}

TEST(WallPictures, TheWorldsSeedChangesWhatTheyShow) {
  const World a = WithRow(1);
  const World b = WithRow(2);
  const auto hung_a = HangPictures(a, ResolveLayout(a));
  const auto hung_b = HangPictures(b, ResolveLayout(b));
  const auto again = HangPictures(a, ResolveLayout(a));
  ASSERT_EQ(hung_a.size(), again.size());
  for (std::size_t i = 0; i < hung_a.size(); ++i) {
    EXPECT_EQ(hung_a[i].look.pattern.seed, again[i].look.pattern.seed);
    EXPECT_EQ(hung_a[i].along, again[i].along);
  }
  for (const HungPicture& p : hung_a) {
    for (const HungPicture& q : hung_b) {
      EXPECT_NE(p.look.pattern.seed, q.look.pattern.seed);
    }
  }
}

TEST(WallPictures, RefusesPicturesOverDoorsAndPastWalls) {
  const auto error_of = [](double at, double height) -> std::string {
    World world = TwoRoomsAndCorridor();
    WorldPicture picture;
    picture.where = "w:5: pictures[0]";
    picture.place = {"corridor", 2, at};
    picture.height = height;
    world.pictures = {picture};
    try {
      (void)HangPictures(world, ResolveLayout(world));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of(4.0, 1.5), "");
  EXPECT_THAT(error_of(2.0, 1.5), HasSubstr("w:5: pictures[0]: at"));
  EXPECT_THAT(error_of(9.8, 1.5), HasSubstr("within its wall"));
  EXPECT_THAT(error_of(4.0, 2.4), HasSubstr("between floor and ceiling"));
}

}  // namespace
}  // namespace waymark
