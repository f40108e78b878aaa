#include "tests/support/test_worlds.h"

#include <Eigen/Geometry>

#include <numbers>

namespace waymark {
namespace {

WorldOpening OpeningIn(int wall, double at, double width) {
  WorldOpening opening;
  opening.place = {"corridor", wall, at};
  opening.width = width;
  return opening;
}

}  // namespace

WorldRoom OutlineRoom(const std::string& name,
                      const std::vector<Eigen::Vector2d>& outline,
                      double height) {
  WorldRoom room;
  room.name = name;
  room.where = "test: " + name;
  room.outline = outline;
  room.height = height;
  room.walls.assign(outline.size(), "plain");
  room.floor = "plain";
  room.ceiling = "plain";
  return room;
}

WorldRoom RectangleRoom(const std::string& name,
                        double west,
                        double south,
                        double east,
                        double north,
                        double height) {
  WorldRoom room =
      OutlineRoom(name,
                  {{west, south}, {east, south}, {east, north}, {west, north}},
                  height);
  room.is_rectangle = true;
  return room;
}

World TwoRoomsAndCorridor() {
  World world;
  world.rooms = {RectangleRoom("corridor", 0.0, 0.0, 10.0, 2.0, 2.5),
                 RectangleRoom("study", 0.0, 2.15, 4.0, 5.15, 3.0),
                 RectangleRoom("hall", 4.15, 2.15, 10.0, 5.15, 2.5)};
  world.openings = {OpeningIn(2, 7.0, 1.5)};
  WorldDoor open;
  open.opening = OpeningIn(2, 2.0, 0.9);
  open.opening.height = 2.05;
  open.angle = std::numbers::pi / 2.0;
  WorldDoor shut;
  shut.opening = OpeningIn(0, 5.0, 0.8);
  shut.opening.height = 2.0;
  world.doors = {open, shut};
  return world;
}

World Turned(World world, double angle, const Eigen::Vector2d& shift) {
  const Eigen::Rotation2Dd R(angle);
  for (WorldRoom& room : world.rooms) {
    for (Eigen::Vector2d& p : room.outline) p = R * p + shift;
  }
  return world;
}

}  // namespace waymark
