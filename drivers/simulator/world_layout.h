// Where the walls of a world are, and the holes in them.
#pragma once

#include "drivers/simulator/world.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace waymark {

// One wall of a room in its own frame: x along the wall from its first corner,
// y into the room, z up.
struct WallFrame {
  Eigen::Isometry3d X_WE = Eigen::Isometry3d::Identity();
  double length = 0.0;

  // Of a point on the floor beside the wall.
  [[nodiscard]] Eigen::Vector2d At(double along, double inward = 0.0) const;
};

[[nodiscard]] WallFrame FrameOfWall(const WorldRoom& room, int wall);
// Where on the wall's x axis a place is.
[[nodiscard]] double AlongWall(const WorldRoom& room, const WallPlace& place);
// "south" for a rectangle, else its index.
[[nodiscard]] std::string NameOfWall(const WorldRoom& room, int wall);

// A stretch of a wall that is open from the floor to `height`.
struct WallHole {
  double begin = 0.0;  // Along the wall.
  double end = 0.0;
  double height = 0.0;
  int passage = -1;  // Index of Layout::passages.
};

// An opening or door with the rooms that it joins.
struct Passage {
  const WorldOpening* opening = nullptr;  // Of the World.
  const WorldDoor* door = nullptr;        // Null where it has no leaf.
  int room = 0;
  int wall = 0;
  WallHole hole;
  double depth = 0.0;   // Of the wall from this room to the other.
  int other_room = -1;  // -1: a shut door to nowhere.
  int other_wall = -1;
};

struct Layout {
  std::vector<Passage> passages;
  // Of each room and wall, from its first corner on.
  std::vector<std::vector<std::vector<WallHole>>> holes;
};

// The leaf of a door in its own frame: x from the hinge to its free end, z up.
struct DoorLeaf {
  Eigen::Isometry3d X_WD = Eigen::Isometry3d::Identity();
  double width = 0.0;
  double low = 0.0;  // Along y: its two faces.
  double high = 0.0;
};
// Of a passage with a door.
[[nodiscard]] DoorLeaf LeafOf(const World& world, const Passage& passage);

// How far apart the walls of two rooms that a door joins may be, m.
inline constexpr double kMaxWallThickness = 0.6;
inline constexpr double kMinWallThickness = 0.02;

// Finds the holes. Throws InputError where the outline of a room crosses
// itself or goes clockwise, rooms overlap, an opening is not within its wall,
// overlaps another one or leads nowhere. The world must outlive the layout.
[[nodiscard]] Layout ResolveLayout(const World& world);

[[nodiscard]] bool IsInside(const std::vector<Eigen::Vector2d>& outline,
                            const Eigen::Vector2d& point);
// Of a point from the line between a and b, which may be one point.
[[nodiscard]] double DistanceToSegment(const Eigen::Vector2d& a,
                                       const Eigen::Vector2d& b,
                                       const Eigen::Vector2d& point);
[[nodiscard]] double DistanceToOutline(
    const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& point);
// Index of the room that has a point in it, or -1.
[[nodiscard]] int RoomAt(const World& world, const Eigen::Vector2d& point);
// Index of a room by name, or -1.
[[nodiscard]] int RoomNamed(const World& world, const std::string& name);

}  // namespace waymark
