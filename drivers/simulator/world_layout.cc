#include "drivers/simulator/world_layout.h"

#include "estimation/base/input_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace waymark {
namespace {

constexpr double kLeafThickness = 0.04;
constexpr double kLeafRecess = 0.015;  // Of a shut leaf behind the wall.
constexpr double kNicheDepth = 0.12;   // Behind a shut door to nowhere.

// Room for rounding of coordinates that a person typed, m.
constexpr double kSlack = 1e-6;

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

std::string Meters(double value) {
  std::string text = std::to_string(std::round(value * 1000.0) / 1000.0);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

const Eigen::Vector2d& Corner(const WorldRoom& room, std::size_t i) {
  return room.outline[i % room.outline.size()];
}

// Whether two segments have a point in common.
bool Touch(const Eigen::Vector2d& a,
           const Eigen::Vector2d& b,
           const Eigen::Vector2d& c,
           const Eigen::Vector2d& d) {
  const auto side = [](const Eigen::Vector2d& p,
                       const Eigen::Vector2d& q,
                       const Eigen::Vector2d& r) {
    const double cross = Cross(q - p, r - p);
    return cross > kSlack ? 1 : cross < -kSlack ? -1 : 0;
  };
  const auto is_between = [](const Eigen::Vector2d& p,
                             const Eigen::Vector2d& q,
                             const Eigen::Vector2d& r) {
    return (r - p).dot(r - q) <= kSlack;
  };
  const int s1 = side(a, b, c);
  const int s2 = side(a, b, d);
  const int s3 = side(c, d, a);
  const int s4 = side(c, d, b);
  if (s1 * s2 < 0 && s3 * s4 < 0) return true;
  return (s1 == 0 && is_between(a, b, c)) || (s2 == 0 && is_between(a, b, d)) ||
         (s3 == 0 && is_between(c, d, a)) || (s4 == 0 && is_between(c, d, b));
}

void CheckOutline(const WorldRoom& room) {
  const std::size_t n = room.outline.size();
  double area = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    area += Cross(Corner(room, i), Corner(room, i + 1)) / 2.0;
    if ((Corner(room, i + 1) - Corner(room, i)).norm() < 0.01) {
      throw InputError(room.where + ": outline: wall " + std::to_string(i) +
                       " must be 0.01 m long or longer");
    }
    for (std::size_t k = i + 2; k < n; ++k) {
      if (i == 0 && k == n - 1) continue;  // Neighbours share a corner.
      if (Touch(Corner(room, i),
                Corner(room, i + 1),
                Corner(room, k),
                Corner(room, k + 1))) {
        throw InputError(room.where + ": outline: walls " + std::to_string(i) +
                         " and " + std::to_string(k) + " cross");
      }
    }
  }
  if (area <= 0.0) {
    throw InputError(room.where +
                     ": outline: its corners must go counter-clockwise");
  }
}

// Between two outlines that do not cross: at a corner of one of them.
double Distance(const WorldRoom& a, const WorldRoom& b) {
  double distance = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const Eigen::Vector2d& p : from->outline) {
      distance = std::min(distance, DistanceToOutline(to->outline, p));
    }
  }
  return distance;
}

bool Overlap(const WorldRoom& a, const WorldRoom& b) {
  for (std::size_t i = 0; i < a.outline.size(); ++i) {
    for (std::size_t k = 0; k < b.outline.size(); ++k) {
      if (Touch(Corner(a, i), Corner(a, i + 1), Corner(b, k), Corner(b, k + 1)))
        return true;
    }
  }
  return IsInside(a.outline, b.outline[0]) || IsInside(b.outline, a.outline[0]);
}

void CheckRooms(const World& world) {
  for (const WorldRoom& room : world.rooms) CheckOutline(room);
  for (std::size_t i = 0; i < world.rooms.size(); ++i) {
    for (std::size_t k = i + 1; k < world.rooms.size(); ++k) {
      const WorldRoom& a = world.rooms[i];
      const WorldRoom& b = world.rooms[k];
      if (Overlap(a, b)) {
        throw InputError(b.where + ": overlaps the room '" + a.name + "'");
      }
      if (Distance(a, b) < kMinWallThickness - kSlack) {
        throw InputError(b.where + ": must be " + Meters(kMinWallThickness) +
                         " m or farther from the room '" + a.name +
                         "': the wall between them");
      }
    }
  }
}

struct Facing {
  int room = -1;
  int wall = -1;
  WallHole hole;
  double depth = 0.0;
};

// The wall of another room right behind a hole.
std::optional<Facing> FacingWall(const World& world,
                                 const Passage& passage,
                                 const std::string& where) {
  const WallFrame frame = FrameOfWall(
      world.rooms[static_cast<std::size_t>(passage.room)], passage.wall);
  std::optional<Facing> nearest;
  for (std::size_t r = 0; r < world.rooms.size(); ++r) {
    if (static_cast<int>(r) == passage.room) continue;
    for (std::size_t w = 0; w < world.rooms[r].outline.size(); ++w) {
      const WallFrame other = FrameOfWall(world.rooms[r], static_cast<int>(w));
      const Eigen::Isometry3d X_EF = frame.X_WE.inverse() * other.X_WE;
      // Antiparallel, to a millimetre over a wall's thickness.
      if (X_EF.linear()(0, 0) > -0.9999) continue;
      const double depth = -X_EF.translation().y();
      if (depth < kMinWallThickness - kSlack || depth > kMaxWallThickness) {
        continue;
      }
      const double begin = X_EF.translation().x() - passage.hole.end;
      const double end = X_EF.translation().x() - passage.hole.begin;
      if (end < kSlack || begin > other.length - kSlack) continue;
      if (begin < -kSlack || end > other.length + kSlack) {
        throw InputError(where + ": reaches past the wall of the room '" +
                         world.rooms[r].name + "' behind it");
      }
      if (nearest && nearest->depth < depth) continue;
      nearest = Facing{static_cast<int>(r),
                       static_cast<int>(w),
                       {begin, end, passage.hole.height, -1},
                       depth};
    }
  }
  return nearest;
}

void AddHole(const WorldRoom& room,
             const WallHole& hole,
             const std::string& where,
             std::vector<WallHole>* holes) {
  if (hole.height > room.height + kSlack) {
    throw InputError(where + ": height = " + Meters(hole.height) +
                     ": must be at most that of the room '" + room.name +
                     "', " + Meters(room.height));
  }
  for (const WallHole& other : *holes) {
    if (hole.begin < other.end - kSlack && other.begin < hole.end - kSlack) {
      throw InputError(where + ": overlaps another opening of the same wall");
    }
  }
  holes->push_back(hole);
  std::sort(
      holes->begin(), holes->end(), [](const WallHole& a, const WallHole& b) {
        return a.begin < b.begin;
      });
}

Passage StartPassage(const World& world, const WorldOpening& opening) {
  Passage passage;
  passage.opening = &opening;
  passage.room = RoomNamed(world, opening.place.room);
  passage.wall = opening.place.wall;
  if (passage.room < 0) {
    throw InputError(opening.where + ": room = " + opening.place.room +
                     ": no such room");
  }
  const WorldRoom& room = world.rooms[static_cast<std::size_t>(passage.room)];
  const double length = FrameOfWall(room, passage.wall).length;
  const double middle = AlongWall(room, opening.place);
  passage.hole.begin = middle - opening.width / 2.0;
  passage.hole.end = middle + opening.width / 2.0;
  if (passage.hole.begin < -kSlack || passage.hole.end > length + kSlack) {
    throw InputError(opening.where + ": at = " + Meters(opening.place.at) +
                     ": must be in [" + Meters(opening.width / 2.0) + ", " +
                     Meters(length - opening.width / 2.0) +
                     "], which is on the wall");
  }
  passage.hole.begin = std::max(passage.hole.begin, 0.0);
  passage.hole.end = std::min(passage.hole.end, length);
  return passage;
}

void AddPassage(const World& world, Passage passage, Layout* layout) {
  const std::string& where = passage.opening->where;
  const WorldRoom& room = world.rooms[static_cast<std::size_t>(passage.room)];
  const auto facing = FacingWall(world, passage, where);
  if (!facing && (passage.door == nullptr || passage.door->angle != 0.0)) {
    throw InputError(where +
                     ": leads nowhere: no wall of another room within " +
                     Meters(kMaxWallThickness) + " m behind it");
  }
  double height = room.height;
  if (facing) {
    passage.other_room = facing->room;
    passage.other_wall = facing->wall;
    passage.depth = facing->depth;
    height = std::min(
        height, world.rooms[static_cast<std::size_t>(facing->room)].height);
  } else {
    passage.depth = kNicheDepth;
  }
  passage.hole.height = passage.opening->height.value_or(height);
  passage.hole.passage = static_cast<int>(layout->passages.size());
  AddHole(room,
          passage.hole,
          where,
          &layout->holes[static_cast<std::size_t>(passage.room)]
                        [static_cast<std::size_t>(passage.wall)]);
  if (facing) {
    WallHole hole = facing->hole;
    hole.begin = std::max(hole.begin, 0.0);
    hole.height = passage.hole.height;
    hole.passage = passage.hole.passage;
    AddHole(world.rooms[static_cast<std::size_t>(facing->room)],
            hole,
            where,
            &layout->holes[static_cast<std::size_t>(facing->room)]
                          [static_cast<std::size_t>(facing->wall)]);
  }
  layout->passages.push_back(passage);
}

}  // namespace

Eigen::Vector2d WallFrame::At(double along, double inward) const {
  return (X_WE * Eigen::Vector3d(along, inward, 0.0)).head<2>();
}

WallFrame FrameOfWall(const WorldRoom& room, int wall) {
  const Eigen::Vector2d& a = Corner(room, static_cast<std::size_t>(wall));
  const Eigen::Vector2d& b = Corner(room, static_cast<std::size_t>(wall) + 1);
  WallFrame frame;
  frame.length = (b - a).norm();
  const Eigen::Vector2d x = (b - a) / frame.length;
  frame.X_WE.linear().col(0) << x, 0.0;
  frame.X_WE.linear().col(1) << -x.y(), x.x(), 0.0;
  frame.X_WE.translation() << a, 0.0;
  return frame;
}

double AlongWall(const WorldRoom& room, const WallPlace& place) {
  // North and west walls run from the east and from the north.
  if (!room.is_rectangle || place.wall < 2) return place.at;
  return FrameOfWall(room, place.wall).length - place.at;
}

std::string NameOfWall(const WorldRoom& room, int wall) {
  static const std::vector<std::string> kNames{
      "south", "east", "north", "west"};
  return room.is_rectangle ? kNames[static_cast<std::size_t>(wall)]
                           : std::to_string(wall);
}

Layout ResolveLayout(const World& world) {
  CheckRooms(world);
  Layout layout;
  for (const WorldRoom& room : world.rooms) {
    layout.holes.emplace_back(room.outline.size());
  }
  for (const WorldOpening& opening : world.openings) {
    AddPassage(world, StartPassage(world, opening), &layout);
  }
  for (const WorldDoor& door : world.doors) {
    Passage passage = StartPassage(world, door.opening);
    passage.door = &door;
    AddPassage(world, passage, &layout);
  }
  return layout;
}

DoorLeaf LeafOf(const World& world, const Passage& passage) {
  const WallFrame frame = FrameOfWall(
      world.rooms[static_cast<std::size_t>(passage.room)], passage.wall);
  const WorldDoor& door = *passage.door;
  // It turns about an edge of the wall: on this side where it opens into the
  // room, on the other where it opens out.
  const double hinge_y = door.angle < 0.0 ? -passage.depth : 0.0;
  // Seen from the room, a wall's first corner is at its right.
  const bool is_left = door.hinge == Hinge::kLeft;
  const double hinge_x = is_left ? passage.hole.end : passage.hole.begin;
  DoorLeaf leaf;
  leaf.width = passage.hole.end - passage.hole.begin;
  leaf.X_WD =
      frame.X_WE * Eigen::Translation3d(hinge_x, hinge_y, 0.0) *
      Eigen::AngleAxisd(is_left ? std::numbers::pi - door.angle : door.angle,
                        Eigen::Vector3d::UnitZ());
  const double recess = door.angle == 0.0 ? kLeafRecess : 0.0;
  // D's y goes out of the room where the hinge is at the left.
  const bool is_positive = is_left == (door.angle >= 0.0);
  leaf.low = is_positive ? recess : -recess - kLeafThickness;
  leaf.high = leaf.low + kLeafThickness;
  return leaf;
}

bool IsInside(const std::vector<Eigen::Vector2d>& outline,
              const Eigen::Vector2d& point) {
  bool is_inside = false;
  for (std::size_t i = 0, k = outline.size() - 1; i < outline.size(); k = i++) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[k];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    const double x =
        a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (point.x() < x) is_inside = !is_inside;
  }
  return is_inside;
}

double DistanceToSegment(const Eigen::Vector2d& a,
                         const Eigen::Vector2d& b,
                         const Eigen::Vector2d& point) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0
                       ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0)
                       : 0.0;
  return (a + t * along - point).norm();
}

double DistanceToOutline(const std::vector<Eigen::Vector2d>& outline,
                         const Eigen::Vector2d& point) {
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, k = outline.size() - 1; i < outline.size(); k = i++) {
    distance =
        std::min(distance, DistanceToSegment(outline[k], outline[i], point));
  }
  return distance;
}

int RoomAt(const World& world, const Eigen::Vector2d& point) {
  for (std::size_t i = 0; i < world.rooms.size(); ++i) {
    if (IsInside(world.rooms[i].outline, point)) return static_cast<int>(i);
  }
  return -1;
}

int RoomNamed(const World& world, const std::string& name) {
  for (std::size_t i = 0; i < world.rooms.size(); ++i) {
    if (world.rooms[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace waymark
