#include "processes/convert/world_file.h"

#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/random_world.h"
#include "estimation/base/input_error.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kRoom =
    "rooms:\n"
    "  - name: hall\n"
    "    rectangle: [0, 0, 8, 4]\n";

std::string ErrorOf(const std::string& yaml) {
  try {
    (void)WorldFromYaml(yaml, "w.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(WorldFile, ACorridorTakesThreeLines) {
  const World world = WorldFromYaml(kRoom, "some/hall.yaml");
  EXPECT_EQ(world.name, "hall");
  ASSERT_EQ(world.rooms.size(), 1u);
  const WorldRoom& room = world.rooms[0];
  EXPECT_EQ(room.outline.size(), 4u);
  EXPECT_EQ(room.walls.size(), 4u);
  EXPECT_EQ(room.where, "some/hall.yaml:2: rooms[0] (hall)");
  EXPECT_EQ(room.lamps[0], 3);  // Some 3 m apart.
  EXPECT_EQ(room.lamps[1], 1);
  EXPECT_FALSE(BuildScene(world).mesh.triangles.empty());
}

TEST(WorldFile, EveryObjectHasItsValues) {
  const World world = WorldFromYaml(
      std::string(kRoom) +
          "    height: 3\n"
          "    floor: tiles\n"
          "    walls: brick\n"
          "    wall_materials: {north: mine}\n"
          "    lamps: [0, 0]\n"
          "  - {name: bay, outline: [[0, 4.2], [4, 4.2], [2, 6]]}\n"
          "materials:\n"
          "  mine: {pattern: paint, color: [10, 20, 30], seed: 4}\n"
          "openings:\n"
          "  - {room: hall, wall: north, at: 1.5, width: 1}\n"
          "doors:\n"
          "  - {room: hall, wall: north, at: 3, open_deg: 90, hinge: right}\n"
          "pillars:\n"
          "  - {at: [4, 2], shape: round, size: 0.5}\n"
          "furniture:\n"
          "  - {kind: sofa, at: [1, 1], heading_deg: -90}\n"
          "pictures:\n"
          "  - {room: hall, wall: east, at: 2, size: [1, 0.5], seed: 9}\n"
          "  - {room: bay, wall: 1, at: 1, pattern: sign, text: Exit}\n"
          "picture_rows:\n"
          "  - {room: bay, pattern: noticeboard, widths: [0.3, 0.4]}\n"
          "lamps:\n"
          "  - {at: [1, 1, 3], light: 0.5}\n"
          "people:\n"
          "  - {motion: stand, at: [2, 2], heading_deg: 180}\n"
          "  - {motion: walk, path: [[1, 3], [5, 3]], speed: 0.7, closed: "
          "true}\n"
          "  - {motion: beside, bearing_deg: 90, clearance: 0.3, name: Ann}\n"
          "starts: [[1, 3, -270], [2, 3, 0]]\n"
          "places:\n"
          "  bay: [2, 5, -90]\n"
          "routes:\n"
          "  tour: [[1, 3], [2, 5], [1, 3]]\n"
          "seed: 5\n"
          "ambient: 1.5\n"
          "name: everything\n",
      "w.yaml");
  constexpr double kPi = std::numbers::pi;
  EXPECT_EQ(world.name, "everything");
  EXPECT_EQ(world.seed, 5u);
  EXPECT_EQ(world.rooms[0].walls,
            (std::vector<std::string>{"brick", "brick", "mine", "brick"}));
  ASSERT_EQ(world.materials.size(), 1u);
  EXPECT_EQ(*world.materials[0].look.pattern.color, cv::Vec3b(30, 20, 10));
  EXPECT_FALSE(world.openings[0].height.has_value());
  EXPECT_EQ(world.doors[0].hinge, Hinge::kRight);
  EXPECT_NEAR(world.doors[0].angle, kPi / 2.0, 1e-12);
  EXPECT_EQ(world.pillars[0].shape, PillarShape::kRound);
  EXPECT_EQ(world.furniture[0].kind, FurnitureKind::kSofa);
  EXPECT_NEAR(world.furniture[0].heading, -kPi / 2.0, 1e-12);
  EXPECT_EQ(world.pictures[0].look.pattern.seed, 9u);
  EXPECT_EQ(world.pictures[1].look.pattern.text, "Exit");
  EXPECT_EQ(world.pictures[1].place.wall, 1);
  EXPECT_EQ(world.picture_rows[0].wall, -1);
  EXPECT_EQ(world.lamps[0].light, 0.5);
  EXPECT_EQ(world.people[1].speed, 0.7);
  EXPECT_TRUE(world.people[1].is_closed);
  EXPECT_EQ(world.people[2].name, "Ann");
  EXPECT_NEAR(world.people[2].bearing, kPi / 2.0, 1e-12);
  EXPECT_NEAR(world.starts[0].X_WR.heading, kPi / 2.0, 1e-12);
  EXPECT_EQ(world.places[0].name, "bay");
  EXPECT_EQ(world.routes[0].points.size(), 3u);
  EXPECT_FALSE(BuildScene(world).mesh.triangles.empty());
}

struct Refused {
  const char* yaml;  // Behind kRoom.
  const char* error;
};

TEST(WorldFile, RefusesInOneLineThatSaysWhereAndWhatIsAllowed) {
  for (const Refused& refused : {
           Refused{"rom: 1\n", "w.yaml:4: rom: unknown key; known here: "},
           {"    hight: 3\n", "w.yaml:4: rooms[0].hight: unknown key"},
           {"    height: 3\n    height: 4\n",
            "w.yaml:5: rooms[0].height: given twice"},
           {"    height: tall\n",
            "w.yaml:4: rooms[0].height = tall: must be a number in [1, 20]"},
           {"    height: 50\n",
            "w.yaml:4: rooms[0].height = 50: must be a number in [1, 20]"},
           {"    outline: [[0, 0], [1, 0], [1, 1]]\n",
            "w.yaml:4: rooms[0].outline = a list of 3: must not be beside"},
           {"    floor: lava\n",
            "w.yaml:4: rooms[0].floor = lava: must be one of: linoleum"},
           {"places: {\"my desk\": [1, 1, 0]}\n",
            "w.yaml:4: places: 'my desk': names must be of one word"},
           {"routes: {\"a\\nb\": [[1, 1], [2, 1]]}\n",
            "w.yaml:4: routes: 'a\\x0ab': names must be of one word"},
           {"  - {name: \"a\\nb\", rectangle: [9, 0, 12, 4]}\n",
            "w.yaml:4: rooms[1].name = 'a\\x0ab': must be one line"},
           {"people: [{name: \"a\\nb\", motion: stand, at: [1, 1]}]\n",
            "w.yaml:4: people[0].name = 'a\\x0ab': must be one line"},
           {"    wall_materials: {up: brick}\n",
            "w.yaml:4: rooms[0].wall_materials.up = brick: must be a wall of "
            "that room: south, east, north, west"},
           {"    lamps: [1.5, 1]\n",
            "w.yaml:4: rooms[0].lamps = a list of 2: must be two whole"},
           {"  - {name: hall, rectangle: [0, 5, 8, 9]}\n",
            "w.yaml:4: rooms[1].name = hall: must not be that of another"},
           {"  - {rectangle: [0, 5, 8, 9]}\n",
            "w.yaml:4: rooms[1].name: is missing"},
           {"  - {name: b}\n", "w.yaml:4: rooms[1].rectangle: is missing"},
           {"  - {name: b, rectangle: [8, 5, 0, 9]}\n",
            "w.yaml:4: rooms[1].rectangle = a list of 4: must be [west, south"},
           {"  - {name: b, outline: [[0, 5], [1, 5]]}\n",
            "w.yaml:4: rooms[1].outline = a list of 2: must be a list of 3 or"},
           {"doors:\n  - {room: hal, wall: north, at: 1}\n",
            "w.yaml:5: doors[0].room = hal: must be one of: hall"},
           {"doors:\n  - {room: hall, wall: 2, at: 1}\n",
            "w.yaml:5: doors[0].wall = 2: must be a wall of that room"},
           {"doors:\n  - {room: hall, wall: north}\n",
            "w.yaml:5: doors[0].at: is missing"},
           {"doors:\n  - {room: hall, wall: east, at: 7}\n",
            "w.yaml:5: doors[0].at = 7: must be a number in [0, 4]"},
           {"doors:\n  - {room: hall, wall: east, at: 2, hinge: top}\n",
            "w.yaml:5: doors[0].hinge = top: must be one of: left, right"},
           {"doors: {room: hall}\n",
            "w.yaml:4: doors = a group: must be a list of groups"},
           {"doors: [3]\n", "w.yaml:4: doors[0] = 3: must be a group of keys"},
           {"materials:\n  a: {pattern: stone}\n",
            "w.yaml:5: materials.a.pattern = stone: must be one of: plain"},
           {"materials:\n  a: {color: [0, 300, 0]}\n",
            "w.yaml:5: materials.a.color[0] = 0: must be a number in [10, 245"},
           {"materials:\n  a: {image: no.png, size: [1, 1]}\n",
            "w.yaml:5: materials.a.image = no.png: there is no file no.png"},
           {"materials:\n  a: {image: '${NO_SUCH_VARIABLE}/a.png'}\n",
            "needs the environment variable NO_SUCH_VARIABLE"},
           {"furniture:\n  - {kind: throne, at: [1, 1]}\n",
            "w.yaml:5: furniture[0].kind = throne: must be one of: desk"},
           {"people:\n  - {motion: fly}\n",
            "w.yaml:5: people[0].motion = fly: must be one of: stand, walk"},
           {"people:\n  - {motion: walk, path: [[1, 1], [1, 1]]}\n",
            "w.yaml:5: people[0].path = a list of 2: must have a length"},
           {"people:\n  - {motion: stand, at: [1, 1], speed: 3}\n",
            "w.yaml:5: people[0].speed: unknown key"},
           {"starts: [1, 2, 3]\n",
            "w.yaml:4: starts[0] = 1: must be a list of 3 numbers"},
           {"base: no.yaml\n",
            "w.yaml:4: base = no.yaml: must be a world file beside this one"},
           {"rooms: [}\n", "w.yaml:4: "},
       }) {
    EXPECT_THAT(ErrorOf(std::string(kRoom) + refused.yaml),
                HasSubstr(refused.error))
        << refused.yaml;
  }
}

TEST(WorldFile, FindsShippedWorldsByName) {
  EXPECT_TRUE(
      std::filesystem::is_regular_file(FindWorldFile("corridor_plain")));
  EXPECT_EQ(FindWorldFile("./x.yaml"), "./x.yaml");
  try {
    (void)FindWorldFile("no_such_world");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                StartsWith("'no_such_world' is neither a file nor one of"));
    EXPECT_THAT(error.what(), HasSubstr("corridor_plain, corridor_textured"));
  }
}

TEST(WorldFile, RandomWorldsHaveNamesInPlaceOfFiles) {
  EXPECT_EQ(FindWorldFile("random:17"), "random:17");
  const World world = LoadWorldFile("random:17");
  EXPECT_EQ(world.source, "random:17");
  EXPECT_EQ(world.starts[0].X_WR, RandomWorld(17).starts[0].X_WR);
  for (const char* name : {"random:",
                           "random:x",
                           "random:-1",
                           "random:1.5",
                           "random:1 ",
                           "random:18446744073709551616"}) {
    try {
      (void)FindWorldFile(name);
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()),
                "world '" + std::string(name) +
                    "': after random: must follow a whole number, 0 to "
                    "18446744073709551615");
    }
  }
}

TEST(WorldFile, ReplacesWhatItsBaseHasOfTheSameName) {
  const TemporaryDirectory folder;
  std::ofstream(folder / "base.yaml")
      << "rooms: [{name: hall, rectangle: [0, 0, 8, 4], floor: mine}]\n"
         "materials: {mine: {pattern: paint, color: [10, 20, 30]}}\n"
         "places: {desk: [1, 1, 0], door: [2, 2, 0]}\n"
         "routes: {round: [[1, 1], [2, 2]]}\n";
  const World world = WorldFromYaml(
      "base: base.yaml\n"
      "materials: {mine: {pattern: paint, color: [90, 20, 30]}}\n"
      "places: {desk: [3, 1, 0]}\n"
      "routes: {round: [[1, 1], [3, 3]]}\n",
      folder / "own.yaml");
  ASSERT_EQ(world.materials.size(), 1u);
  EXPECT_EQ(world.materials[0].look.pattern.color, cv::Vec3b(30, 20, 90));
  ASSERT_EQ(world.places.size(), 2u);
  EXPECT_EQ(world.places[0].X_WR.x, 3.0);
  ASSERT_EQ(world.routes.size(), 1u);
  EXPECT_EQ(world.routes[0].points[1].x(), 3.0);
}

}  // namespace
}  // namespace waymark
