// World files: refused in one line, or a world with walls, pictures and people
// that can be computed.
#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/walk_area.h"
#include "drivers/simulator/wall_pictures.h"
#include "drivers/simulator/world_layout.h"
#include "processes/convert/world_file.h"
#include "tests/fuzz/fuzz_target.h"

#include <cmath>

namespace waymark::fuzz {
namespace {

void UsePlan(const World& world) {
  const Layout layout = ResolveLayout(world);
  for (const WorldRoom& room : world.rooms) {
    Expect(room.walls.size() == room.outline.size(), "a material per wall");
  }
  for (const Passage& passage : layout.passages) {
    Expect(passage.hole.begin < passage.hole.end, "holes have a width");
    Expect(passage.depth > 0.0 && passage.depth <= kMaxWallThickness,
           "walls have a thickness");
  }
  for (const HungPicture& picture : HangPictures(world, layout)) {
    Expect(std::isfinite(picture.along) && std::isfinite(picture.height),
           "pictures hang somewhere");
  }
}

void UsePeople(const World& world) {
  const People people(world, {});
  for (const double t : {0.0, 1.7, 1e4}) {
    const auto poses = people.PosesAt(t, {1.0, 0.5, 0.3});
    Expect(poses.size() == world.people.size(), "a pose for everybody");
    for (const Pose2& pose : poses) {
      Expect(std::isfinite(pose.x) && std::isfinite(pose.y) &&
                 std::isfinite(pose.heading),
             "finite");
    }
  }
}

// Built as it is bumped into, where a body has room in it.
void UseScene(const World& world) {
  const Scene scene = BuildScene(world, SceneLooks::kPlain);
  const WalkArea area(world, scene.mesh, 1.1);
  for (const WorldPose& start : world.starts) {
    Expect(!std::isnan(area.Clearance(start.X_WR.position())), "a number");
  }
}

// Walls around 6 x 4 pixels, a triangle; beside the world file.
bool WriteFiles() {
  std::string plan = "P5 6 4 255\n";
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 6; ++x) {
      plan += y % 3 == 0 || x % 5 == 0 ? '\0' : '\xff';
    }
  }
  WriteScratch("plan.pgm", AsBytes(plan));
  WriteScratch("t.obj", AsBytes("v 1 0 0\nv 2 1 0\nv 1 3 0\nf 1 2 3\n"));
  return true;
}

}  // namespace

void RunOne(Bytes data) {
  static const bool kHasFiles = WriteFiles();
  Expect(kHasFiles, "files beside the world");
  World world;
  const bool taken = TakesOrRefuses([&] {
    world =
        WorldFromYaml(std::string(Text(data)), ScratchFolder() + "/fuzz.yaml");
  });
  if (!taken) return;
  // Objects of thousands of pairs are slow, not wrong.
  if (world.rooms.size() > 50 || world.people.size() > 50) return;
  (void)TakesOrRefuses([&] { UsePlan(world); });
  (void)TakesOrRefuses([&] { UsePeople(world); });
  (void)TakesOrRefuses([&] { UseScene(world); });
}

std::vector<std::string> Seeds() {
  const std::string room = "rooms:\n  - {name: a, rectangle: [0, 0, 8, 4]}\n";
  return {
      room + "starts: [[1, 1, 0]]\n",
      room +
          "  - {name: b, outline: [[0, 4.1], [3, 4.1], [3, 6], [0, 6]]}\n"
          "openings: [{room: a, wall: north, at: 1.5}]\n"
          "doors: [{room: a, wall: 'east', at: 1, open_deg: 0}]\n",
      room +
          "    height: 3\n    wall_materials: {north: brick}\n"
          "materials: {m: {pattern: paint, color: [10, 20, 30]}}\n"
          "pillars: [{at: [2, 2], shape: round}]\n"
          "furniture: [{kind: desk, at: [1, 1], size: [1, 1, 1]}]\n",
      room +
          "pictures: [{room: a, wall: north, at: 2, pattern: sign, text: x}]\n"
          "picture_rows: [{room: a, spacing: 1.5, widths: [0.3, 0.5]}]\n"
          "lamps: [{at: [1, 1, 2]}]\nseed: 3\nambient: 0.5\n",
      room +
          "people:\n  - {motion: walk, path: [[1, 1], [5, 1]], speed: 2}\n"
          "  - {motion: beside, bearing_deg: 90}\n"
          "  - {motion: stand, at: [1, 1]}\n"
          "places: {p: [1, 2, 3]}\nroutes: {r: [[1, 1], [2, 2]]}\n",
      "floor_plans: [{image: plan.pgm, metres_per_pixel: 0.5, at: [1, 2]}]\n"
      "starts: [[2, 3, 0]]\n",
      room +
          "models: [{file: t.obj, scale: 2, at: [1, 1, 0], heading_deg: 9, "
          "baked_light: true}]\n"};
}

}  // namespace waymark::fuzz
