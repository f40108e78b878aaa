#include "drivers/simulator/random_world.h"

#include "drivers/simulator/build_furniture.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/walk_area.h"
#include "drivers/simulator/world_layout.h"
#include "estimation/base/check.h"
#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using Point = Eigen::Vector2d;

// From passages to corners, m: where frames of doors find room.
constexpr double kBesideDoor = 0.15;

// A room in the making, its sides along x and y; the world is turned in the
// end. Sides are 0 to 3 as the walls of a rectangle: south, east, north, west.
struct Plan {
  Eigen::AlignedBox2d box;
  // Of each side, along its x or y: where corners may not reach.
  std::array<std::vector<std::pair<double, double>>, 4> used;
  std::array<int, 4> first_wall{};  // Index of the wall that is on a side.
  std::vector<Point> outline;
};

struct Join {
  int room = 0;  // Its side has the passage; the other room is behind it.
  int side = 0;
  double middle = 0.0;  // Along x or y.
  double width = 0.9;
};

bool IsAlongX(int side) {
  return side % 2 == 0;
}

// Something that stands, or is to stay free.
struct Spot {
  Point p;
  double radius = 0.0;
};

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed) {}

  // nullopt where nothing is left to start from.
  std::optional<World> Make(const std::string& name) {
    world_.name = world_.source = name;
    world_.seed = random_.Bits() >> 33;
    R_ = Eigen::Rotation2Dd(Maybe(0.5) ? random_.Uniform(-kPi, kPi) : 0.0);
    PlanRooms();
    for (Plan& plan : plans_) CutCorners(&plan);
    AddRooms();
    for (const Join& join : joins_) AddPassage(join);
    AddShutDoors();
    if (!ChooseStart()) return std::nullopt;
    for (std::size_t i = 0; i < plans_.size(); ++i) Furnish(i);
    return std::move(world_);
  }

 private:
  bool Maybe(double probability) { return random_.Uniform() < probability; }
  // Ends included.
  int Between(int low, int high) {
    const int num = high - low + 1;
    return low +
           static_cast<int>(random_.Index(static_cast<std::uint64_t>(num)));
  }
  template <typename T>
  const T& OneOf(const std::vector<T>& all) {
    return all[random_.Index(all.size())];
  }
  std::string Where(const char* list, std::size_t index) const {
    return world_.source + ": " + list + "[" + std::to_string(index) + "]";
  }

  // ---- rooms ---------------------------------------------------------------

  Point RandomSize() {
    if (Maybe(0.4)) {
      const Point corridor(random_.Uniform(4.0, 12.0),
                           random_.Uniform(1.3, 2.6));
      return Maybe(0.5) ? corridor : Point(corridor.y(), corridor.x());
    }
    return {random_.Uniform(2.5, 7.0), random_.Uniform(2.5, 7.0)};
  }

  void PlanRooms() {
    const int num_rooms = Between(1, 5);
    plans_.push_back({{Point::Zero(), RandomSize()}, {}, {}, {}});
    constexpr int kMaxDraws = 100;
    for (int i = 0; i < kMaxDraws; ++i) {
      if (static_cast<int>(plans_.size()) == num_rooms) return;
      Attach();
    }
  }

  // A room behind a side of one that there is; none where it does not fit.
  void Attach() {
    const auto from = static_cast<std::size_t>(random_.Index(plans_.size()));
    const int side = Between(0, 3);
    const int x = IsAlongX(side) ? 0 : 1;  // Along the wall,
    const int y = 1 - x;                   // and across.
    const Eigen::AlignedBox2d& old = plans_[from].box;
    const Point size = RandomSize();
    const double wall = random_.Uniform(0.08, 0.35);
    const double widest =
        std::min(1.6, std::min(size[x], old.sizes()[x]) - 2.0 * kBesideDoor);
    const double width = Maybe(0.5) ? 0.9 : random_.Uniform(0.8, widest);
    // At least the passage is in common.
    const double least = width + 2.0 * kBesideDoor;
    const double begin =
        random_.Uniform(old.min()[x] + least - size[x], old.max()[x] - least);
    Point low;
    low[x] = begin;
    low[y] = side == 1 || side == 2 ? old.max()[y] + wall
                                    : old.min()[y] - wall - size[y];
    const Eigen::AlignedBox2d box(low, low + size);
    constexpr double kApart = 0.08;  // Of rooms that are no neighbours, m.
    const Eigen::AlignedBox2d around(
        box.min() - Point::Constant(0.99 * kApart),
        box.max() + Point::Constant(0.99 * kApart));
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      const Eigen::AlignedBox2d& other = plans_[i].box;
      if (i == from ? box.intersects(other) : around.intersects(other)) return;
    }
    const double low_end = std::max(begin, old.min()[x]) + 0.5 * least;
    const double high_end =
        std::min(begin + size[x], old.max()[x]) - 0.5 * least;
    const double middle = random_.Uniform(low_end, high_end);
    const std::pair<double, double> stretch(middle - 0.5 * least,
                                            middle + 0.5 * least);
    auto& used = plans_[from].used[static_cast<std::size_t>(side)];
    for (const auto& [a, b] : used) {
      if (stretch.first < b && a < stretch.second) return;
    }
    used.push_back(stretch);
    plans_.push_back({box, {}, {}, {}});
    plans_.back().used[static_cast<std::size_t>((side + 2) % 4)].push_back(
        stretch);
    joins_.push_back({static_cast<int>(from), side, middle, width});
  }

  // How far from an end of a side a corner may reach.
  double FreeAt(const Plan& plan, int side, bool is_low_end) const {
    const int x = IsAlongX(side) ? 0 : 1;
    const double low = plan.box.min()[x];
    const double high = plan.box.max()[x];
    double free = 0.35 * (high - low);
    for (const auto& [a, b] : plan.used[static_cast<std::size_t>(side)]) {
      free = std::min(free, is_low_end ? a - low : high - b);
    }
    return free;
  }

  // Corners as they are, cut off, or built out into the room.
  void CutCorners(Plan* plan) {
    const std::array<Point, 4> corners{
        plan->box.corner(Eigen::AlignedBox2d::BottomLeft),
        plan->box.corner(Eigen::AlignedBox2d::BottomRight),
        plan->box.corner(Eigen::AlignedBox2d::TopRight),
        plan->box.corner(Eigen::AlignedBox2d::TopLeft)};
    const Point middle = plan->box.center();
    for (int i = 0; i < 4; ++i) {
      const Point& corner = corners[static_cast<std::size_t>(i)];
      const int before = (i + 3) % 4;  // The side that ends here.
      const auto reach = [&](int side) {
        const int x = IsAlongX(side) ? 0 : 1;
        return FreeAt(*plan, side, corner[x] < middle[x]);
      };
      const double back = random_.Uniform(0.1, 1.0) * reach(before);
      const double on = random_.Uniform(0.1, 1.0) * reach(i);
      const double kind = random_.Uniform();
      constexpr double kLeast = 0.05;  // Of a wall, m.
      const auto first = [&] {
        plan->first_wall[static_cast<std::size_t>(i)] =
            static_cast<int>(plan->outline.size()) - 1;
      };
      if (kind < 0.5 || back < kLeast || on < kLeast) {
        plan->outline.push_back(corner);
        first();
        continue;
      }
      const auto toward = [&](int side, double way) {
        const int x = IsAlongX(side) ? 0 : 1;
        Point p = corner;
        p[x] += corner[x] < middle[x] ? way : -way;
        return p;
      };
      plan->outline.push_back(toward(before, back));
      if (kind < 0.75) {
        plan->outline.push_back(toward(before, back) + toward(i, on) - corner);
      }
      plan->outline.push_back(toward(i, on));
      first();
    }
  }

  void AddRooms() {
    static const std::vector<std::string> kFloors{
        "linoleum", "carpet", "tiles", "parquet", "planks"};
    static const std::vector<std::string> kWalls{"plaster", "paint", "brick"};
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      const Plan& plan = plans_[i];
      WorldRoom room;
      room.where = Where("rooms", i);
      room.name = "room " + std::to_string(i + 1);
      for (const Point& p : plan.outline) room.outline.push_back(R_ * p);
      room.height = random_.Uniform(2.4, 3.2);
      room.floor = OneOf(kFloors);
      room.walls.assign(room.outline.size(), OneOf(kWalls));
      AddLamps(plan, room);
      WorldPictureRow row;
      row.where = Where("picture_rows", i);
      row.room = room.name;
      row.spacing = random_.Uniform(1.2, 2.5);
      row.seed = random_.Bits() >> 33;
      world_.picture_rows.push_back(row);
      world_.rooms.push_back(std::move(room));
    }
  }

  // Every 3 m.
  void AddLamps(const Plan& plan, const WorldRoom& room) {
    const Point num = (plan.box.sizes() / 3.0).array().round().max(1.0);
    for (double i = 0.5; i < num.x(); ++i) {
      for (double k = 0.5; k < num.y(); ++k) {
        WorldLamp lamp;
        lamp.where = Where("lamps", world_.lamps.size());
        const Point at =
            R_ * (plan.box.min() + Point(i, k).cwiseQuotient(num).cwiseProduct(
                                       plan.box.sizes()));
        lamp.at << at, room.height;
        if (!IsInside(room.outline, at) ||
            DistanceToWalls(room, at) < lamp.size.norm() / 2.0) {
          continue;
        }
        world_.lamps.push_back(lamp);
      }
    }
  }

  // ---- passages ------------------------------------------------------------

  WorldOpening OpeningAt(std::size_t room,
                         int side,
                         double middle,
                         double width) const {
    const Plan& plan = plans_[room];
    WorldOpening opening;
    opening.place.room = world_.rooms[room].name;
    opening.place.wall = plan.first_wall[static_cast<std::size_t>(side)];
    const int x = IsAlongX(side) ? 0 : 1;
    const Point& from =
        plan.outline[static_cast<std::size_t>(opening.place.wall)];
    opening.place.at = std::abs(middle - from[x]);
    opening.width = width;
    return opening;
  }

  void AddPassage(const Join& join) {
    WorldOpening opening = OpeningAt(static_cast<std::size_t>(join.room),
                                     join.side,
                                     join.middle,
                                     join.width);
    constexpr double kWidestLeaf = 1.1;
    if (Maybe(0.4) || join.width > kWidestLeaf) {
      opening.where = Where("openings", world_.openings.size());
      world_.openings.push_back(opening);
      return;
    }
    WorldDoor door;
    door.opening = opening;
    const double angle = RadiansFromDegrees(random_.Uniform(15.0, 95.0));
    door.angle = Maybe(0.5) ? angle : -angle;
    AddDoor(door, Maybe(0.1));
  }

  void AddDoor(WorldDoor door, bool is_shut) {
    door.opening.where = Where("doors", world_.doors.size());
    door.opening.height = 2.05;
    door.hinge = Maybe(0.5) ? Hinge::kLeft : Hinge::kRight;
    if (is_shut) door.angle = 0.0;
    world_.doors.push_back(door);
  }

  // Into the walls that no room is behind.
  void AddShutDoors() {
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      for (int side = 0; side < 4; ++side) {
        const Plan& plan = plans_[i];
        if (!plan.used[static_cast<std::size_t>(side)].empty() || Maybe(0.6)) {
          continue;
        }
        const int x = IsAlongX(side) ? 0 : 1;
        const double low = plan.box.min()[x] + FreeAt(plan, side, true);
        const double high = plan.box.max()[x] - FreeAt(plan, side, false);
        constexpr double kWidth = 0.85;
        if (high - low < kWidth || IsRoomBehind(i, side)) continue;
        WorldDoor door;
        door.opening = OpeningAt(i, side, (low + high) / 2.0, kWidth);
        AddDoor(door, true);
      }
    }
  }

  bool IsRoomBehind(std::size_t room, int side) const {
    const int y = IsAlongX(side) ? 1 : 0;
    Eigen::AlignedBox2d behind = plans_[room].box;
    (side == 1 || side == 2 ? behind.max() : behind.min())[y] +=
        side == 1 || side == 2 ? kMaxWallThickness : -kMaxWallThickness;
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      if (i != room && behind.intersects(plans_[i].box)) return true;
    }
    return false;
  }

  // ---- what stands there ---------------------------------------------------

  Point PointIn(const Plan& plan) {
    const Point share(random_.Uniform(), random_.Uniform());
    return R_ * (plan.box.min() + share.cwiseProduct(plan.box.sizes()));
  }

  bool ChooseStart() {
    const WalkArea walls(world_);
    constexpr int kMaxDraws = 300;
    for (int i = 0; i < kMaxDraws; ++i) {
      const Point p = PointIn(OneOf(plans_));
      if (walls.Clearance(p) < kStartClearance) continue;
      world_.starts.push_back({Where("starts", 0),
                               "start 1",
                               {p.x(), p.y(), random_.Uniform(-kPi, kPi)}});
      spots_.push_back({p, kStartClearance});
      break;
    }
    // So that what stands there keeps doors free, and their leaves.
    for (const Join& join : joins_) {
      const Plan& plan = plans_[static_cast<std::size_t>(join.room)];
      const int x = IsAlongX(join.side) ? 0 : 1;
      Point p;
      p[x] = join.middle;
      p[1 - x] = (join.side == 1 || join.side == 2 ? plan.box.max()
                                                   : plan.box.min())[1 - x];
      spots_.push_back({R_ * p, 0.3 + join.width});
    }
    return !world_.starts.empty();
  }

  // A place in a room for something within `radius`, which it is from then on.
  std::optional<Point> Place(const WorldRoom& room,
                             const Plan& plan,
                             double radius) {
    constexpr int kMaxDraws = 20;
    for (int i = 0; i < kMaxDraws; ++i) {
      const Point p = PointIn(plan);
      if (!IsInside(room.outline, p) || DistanceToWalls(room, p) < radius ||
          std::any_of(spots_.begin(), spots_.end(), [&](const Spot& spot) {
            return (spot.p - p).norm() < spot.radius + radius;
          })) {
        continue;
      }
      spots_.push_back({p, radius});
      return p;
    }
    return std::nullopt;
  }

  static double DistanceToWalls(const WorldRoom& room, const Point& p) {
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t w = 0; w < room.outline.size(); ++w) {
      const WallFrame frame = FrameOfWall(room, static_cast<int>(w));
      const Point q =
          (frame.X_WE.inverse() * Eigen::Vector3d(p.x(), p.y(), 0.0)).head<2>();
      const double along = std::clamp(q.x(), 0.0, frame.length);
      distance = std::min(distance, (q - Point(along, 0.0)).norm());
    }
    return distance;
  }

  void Furnish(std::size_t index) {
    const Plan& plan = plans_[index];
    const WorldRoom& room = world_.rooms[index];
    const double area = plan.box.volume();
    for (int i = Between(0, 2); i > 0; --i) AddPillar(room, plan);
    const int most = std::clamp(static_cast<int>(area / 3.0), 1, 8);
    for (int i = Between(0, most); i > 0; --i) AddFurniture(room, plan);
    for (int i = Between(0, 2); i > 0; --i) AddPerson(room, plan);
  }

  void AddPillar(const WorldRoom& room, const Plan& plan) {
    WorldPillar pillar;
    pillar.where = Where("pillars", world_.pillars.size());
    pillar.shape = Maybe(0.5) ? PillarShape::kRound : PillarShape::kSquare;
    pillar.size = random_.Uniform(0.05, 0.6);
    pillar.heading = random_.Uniform(-kPi, kPi);
    const auto at = Place(room, plan, pillar.size * std::sqrt(0.5));
    if (!at) return;
    pillar.at = *at;
    world_.pillars.push_back(pillar);
  }

  void AddFurniture(const WorldRoom& room, const Plan& plan) {
    WorldFurniture piece;
    piece.where = Where("furniture", world_.furniture.size());
    piece.kind = static_cast<FurnitureKind>(
        Between(0, static_cast<int>(FurnitureKind::kBox)));
    piece.size = random_.Uniform(0.8, 1.2) * UsualSize(piece.kind);
    piece.heading = random_.Uniform(-kPi, kPi);
    piece.seed = random_.Bits() >> 33;
    const auto at = Place(room, plan, piece.size.head<2>().norm() / 2.0);
    if (!at) return;
    piece.at = *at;
    world_.furniture.push_back(piece);
  }

  void AddPerson(const WorldRoom& room, const Plan& plan) {
    WorldPerson person;
    person.where = Where("people", world_.people.size());
    person.name = "person " + std::to_string(world_.people.size() + 1);
    person.height = random_.Uniform(1.5, 1.95);
    person.heading = random_.Uniform(-kPi, kPi);
    person.seed = random_.Bits() >> 33;
    const auto at = Place(room, plan, kPersonRadius);
    if (!at) return;
    person.at = *at;
    world_.people.push_back(person);
  }

  Random random_;
  World world_;
  Eigen::Rotation2Dd R_{0.0};
  std::vector<Plan> plans_;
  std::vector<Join> joins_;
  std::vector<Spot> spots_;
};

}  // namespace

World RandomWorld(std::uint64_t seed) {
  const std::string name = "random:" + std::to_string(seed);
  // Now and then nothing is left to start from.
  constexpr int kMaxDraws = 100;
  for (int i = 0; i < kMaxDraws; ++i) {
    const std::string draw = "random_world " + std::to_string(i);
    if (auto world = Maker(SeedFor(seed, draw)).Make(name)) return *world;
  }
  WAYMARK_CHECK(false, seed);
  return {};
}

}  // namespace waymark
