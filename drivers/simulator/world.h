// What a world file says: rooms, what stands in them, who walks through them.
#pragma once

#include "drivers/simulator/material_pattern.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

// How far from W's origin anything may be, along x and y: fine in a float, and
// as far as walls are found quickly. m.
inline constexpr double kMaxWorldReach = 200.0;

// Every object carries `where`, the place in the file that it comes from
// ("office.yaml:12: doors[2]"), for errors that are found only once it is
// built. Lengths in m, angles in rad; headings from W's x toward its y.

// What a surface looks like: a drawn pattern, or an image file.
struct WorldLook {
  PatternOptions pattern;
  std::string image;  // Path; empty: the pattern.
  // What the image covers, m. Patterns have their size in `pattern`.
  Eigen::Vector2d image_size{1.0, 1.0};
};

struct WorldMaterial {
  std::string where;
  std::string name;
  WorldLook look;
};

// What rooms, doors and furniture name as their material: one of
// World::materials, else of the built-in ones (finishes.h).
using MaterialName = std::string;

struct WorldRoom {
  std::string where;
  std::string name;
  // Inner outline, counter-clockwise, without its first corner again. Wall i
  // goes from corner i to the next.
  std::vector<Eigen::Vector2d> outline;
  // A rectangle's walls have names too: south, east, north, west are its walls
  // 0 to 3.
  bool is_rectangle = false;
  double height = 2.6;
  MaterialName floor = "linoleum";
  std::vector<MaterialName> walls;  // One per wall.
  MaterialName ceiling = "ceiling";
  MaterialName skirting = "skirting";
  double skirting_height = 0.08;  // 0: none.
  // Lamps on the ceiling in a regular grid, along x and y; {0, 0}: none.
  std::array<int, 2> lamps{0, 0};
  Eigen::Vector2d lamp_size{0.6, 0.6};
  double light = 1.0;  // Of its lamps: 1 makes a bright office.
};

// A stretch of a wall of a room. For walls of a rectangle, `at` is measured
// from its west or south end, otherwise from the wall's first corner.
struct WallPlace {
  std::string room;
  int wall = 0;     // Index of WorldRoom::outline.
  double at = 0.0;  // Middle of the stretch along the wall.
};

// A hole in the wall of a room down to the floor, and in the wall of the room
// behind it.
struct WorldOpening {
  std::string where;
  WallPlace place;
  double width = 0.9;
  std::optional<double> height;  // Absent: up to the lower ceiling.
};

enum class Hinge : std::uint8_t { kLeft, kRight };  // Seen from the room.

// An opening with a leaf in it.
struct WorldDoor {
  WorldOpening opening;
  Hinge hinge = Hinge::kLeft;
  double angle = 0.0;  // 0: shut; positive opens into the room, negative out.
  MaterialName leaf = "door";
  MaterialName frame = "door_frame";
};

enum class PillarShape : std::uint8_t { kSquare, kRound };

struct WorldPillar {
  std::string where;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  PillarShape shape = PillarShape::kSquare;
  double size = 0.4;  // Side or diameter.
  double heading = 0.0;
  MaterialName material = "plaster";
};

enum class FurnitureKind : std::uint8_t {
  kDesk,
  kTable,
  kChair,
  kCabinet,
  kShelf,
  kSofa,
  kPlant,
  kBin,
  kBox,
};

// Stands on the floor, its front toward its heading.
struct WorldFurniture {
  std::string where;
  FurnitureKind kind = FurnitureKind::kBox;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  // Middle of its base.
  double z = 0.0;                                // Of its base above the floor.
  double heading = 0.0;
  Eigen::Vector3d size{1.0, 1.0, 1.0};  // Depth (along x), width, height.
  MaterialName material;                // Empty: that of its kind.
  std::uint64_t seed = 1;  // Of what differs between two of a kind: books.
};

// Flat things on walls: pictures, posters, noticeboards.
struct WorldPicture {
  std::string where;
  WallPlace place;
  double height = 1.5;             // Of its middle.
  Eigen::Vector2d size{0.8, 0.6};  // Width, height.
  WorldLook look;
};

// Pictures all along the walls of a room, wherever no door or other picture
// is; what they show follows from the seed.
struct WorldPictureRow {
  std::string where;
  std::string room;
  int wall = -1;         // -1: all.
  double spacing = 1.2;  // From middle to middle, about.
  double height = 1.5;   // Of their middles, about.
  std::vector<PatternKind> patterns{PatternKind::kPicture,
                                    PatternKind::kNoticeboard};
  Eigen::Vector2d size{0.6, 0.8};  // Smallest and largest width.
  std::uint64_t seed = 1;
};

// One lamp, other than those of WorldRoom::lamps.
struct WorldLamp {
  std::string where;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Vector2d size{0.6, 0.6};
  double light = 1.0;
};

// A mesh file: glTF or OBJ.
struct WorldModel {
  std::string where;
  std::string file;
  double scale = 1.0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  double heading = 0.0;
  bool is_y_up = true;
  bool has_baked_light = false;
};

// An image of a floor plan, dark walls on light ground, made into one.
struct WorldFloorPlan {
  std::string where;
  std::string image;
  double metres_per_pixel = 0.05;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  // Its lower left corner.
  double height = 2.6;
  MaterialName floor = "linoleum";
  MaterialName walls = "plaster";
  MaterialName ceiling = "ceiling";
};

enum class PersonMotion : std::uint8_t { kStand, kWalk, kBeside };

struct WorldPerson {
  std::string where;
  std::string name;
  PersonMotion motion = PersonMotion::kStand;
  double height = 1.75;
  std::uint64_t seed = 1;  // Of clothes and hair.
  // Stand: here.
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double heading = 0.0;
  // Walk: along these points, then back to the first (closed) or the same way
  // back; starts `start` m along.
  std::vector<Eigen::Vector2d> path;
  bool is_closed = false;
  double speed = 1.0;
  double start = 0.0;
  // Beside the robot: at this bearing, with this much air between its cylinder
  // and the robot's.
  double bearing = 0.0;
  double clearance = 0.2;
};

struct WorldPose {
  std::string where;
  std::string name;
  Pose2 X_WR;
};

struct WorldRoute {
  std::string where;
  std::string name;
  std::vector<Eigen::Vector2d> points;
};

struct World {
  std::string name;
  std::string source;      // The file.
  double ambient = 1.0;    // Share of the usual light from everywhere.
  std::uint64_t seed = 1;  // Mixed into those of all that hangs on walls.
  std::vector<WorldMaterial> materials;
  std::vector<WorldRoom> rooms;
  std::vector<WorldOpening> openings;
  std::vector<WorldDoor> doors;
  std::vector<WorldPillar> pillars;
  std::vector<WorldFurniture> furniture;
  std::vector<WorldPicture> pictures;
  std::vector<WorldPictureRow> picture_rows;
  std::vector<WorldLamp> lamps;
  std::vector<WorldModel> models;
  std::vector<WorldFloorPlan> floor_plans;
  std::vector<WorldPerson> people;
  std::vector<WorldPose> starts;  // Of the robot; the first is the usual one.
  std::vector<WorldPose> places;  // Goals.
  std::vector<WorldRoute> routes;
};

}  // namespace waymark
