#include "drivers/simulator/plan_random_rooms.h"

#include "drivers/simulator/world_layout.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <array>
#include <cmath>
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

class RoomPlanner {
 public:
  explicit RoomPlanner(RandomDraws* draws) : draws_(*draws) {}

  RandomRooms Make(const std::string& name) {
    world_.name = world_.source = name;
    world_.seed = draws_.Seed();
    turn_ =
        Eigen::Rotation2Dd(draws_.Maybe(0.5) ? draws_.Uniform(-kPi, kPi) : 0.0);
    PlanRooms();
    for (Plan& plan : plans_) CutCorners(&plan);
    AddRooms();
    for (const Join& join : joins_) AddPassage(join);
    AddShutDoors();
    RandomRooms rooms;
    rooms.turn = turn_;
    for (const Plan& plan : plans_) rooms.boxes.push_back(plan.box);
    for (const Join& join : joins_) rooms.passages.push_back(PassageOf(join));
    rooms.world = std::move(world_);
    return rooms;
  }

 private:
  // ---- rooms ---------------------------------------------------------------

  Point RandomSize() {
    if (draws_.Maybe(0.4)) {
      const double width = draws_.Uniform(1.3, 2.6);
      const Point corridor(draws_.Uniform(4.0, 12.0), width);
      return draws_.Maybe(0.5) ? corridor : Point(corridor.y(), corridor.x());
    }
    return {draws_.Uniform(2.5, 7.0), draws_.Uniform(2.5, 7.0)};
  }

  void PlanRooms() {
    const int num_rooms = draws_.Between(1, 5);
    plans_.push_back({{Point::Zero(), RandomSize()}, {}, {}, {}});
    constexpr int kMaxDraws = 100;
    for (int i = 0; i < kMaxDraws; ++i) {
      if (static_cast<int>(plans_.size()) == num_rooms) return;
      Attach();
    }
  }

  // A room behind a side of one that there is; none where it does not fit.
  void Attach() {
    const auto from = static_cast<std::size_t>(draws_.Index(plans_.size()));
    const int side = draws_.Between(0, 3);
    const int x = IsAlongX(side) ? 0 : 1;  // Along the wall,
    const int y = 1 - x;                   // and across.
    const Eigen::AlignedBox2d& old = plans_[from].box;
    const Point size = RandomSize();
    const double wall = draws_.Uniform(0.08, 0.35);
    const double widest =
        std::min(1.6, std::min(size[x], old.sizes()[x]) - 2.0 * kBesideDoor);
    const double width = draws_.Maybe(0.5) ? 0.9 : draws_.Uniform(0.8, widest);
    // At least the passage is in common.
    const double least = width + 2.0 * kBesideDoor;
    const double begin =
        draws_.Uniform(old.min()[x] + least - size[x], old.max()[x] - least);
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
    const double middle = draws_.Uniform(low_end, high_end);
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
      const double back = draws_.Uniform(0.1, 1.0) * reach(before);
      const double on = draws_.Uniform(0.1, 1.0) * reach(i);
      const double kind = draws_.Uniform();
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
      room.where = WhereIn(world_, "rooms", i);
      room.name = "room " + std::to_string(i + 1);
      for (const Point& p : plan.outline) room.outline.push_back(turn_ * p);
      room.height = draws_.Uniform(2.4, 3.2);
      room.floor = draws_.OneOf(kFloors);
      room.walls.assign(room.outline.size(), draws_.OneOf(kWalls));
      AddLamps(plan, room);
      WorldPictureRow row;
      row.where = WhereIn(world_, "picture_rows", i);
      row.room = room.name;
      row.spacing = draws_.Uniform(1.2, 2.5);
      row.seed = draws_.Seed();
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
        lamp.where = WhereIn(world_, "lamps", world_.lamps.size());
        const Point at =
            turn_ *
            (plan.box.min() +
             Point(i, k).cwiseQuotient(num).cwiseProduct(plan.box.sizes()));
        lamp.at << at, room.height;
        if (!IsInside(room.outline, at) ||
            DistanceToOutline(room.outline, at) < lamp.size.norm() / 2.0) {
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
    if (draws_.Maybe(0.4) || join.width > kWidestLeaf) {
      opening.where = WhereIn(world_, "openings", world_.openings.size());
      world_.openings.push_back(opening);
      return;
    }
    WorldDoor door;
    door.opening = opening;
    const double angle = RadiansFromDegrees(draws_.Uniform(15.0, 95.0));
    door.angle = draws_.Maybe(0.5) ? angle : -angle;
    AddDoor(door, draws_.Maybe(0.1));
  }

  void AddDoor(WorldDoor door, bool is_shut) {
    door.opening.where = WhereIn(world_, "doors", world_.doors.size());
    door.opening.height = 2.05;
    door.hinge = draws_.Maybe(0.5) ? Hinge::kLeft : Hinge::kRight;
    if (is_shut) door.angle = 0.0;
    world_.doors.push_back(door);
  }

  // Into the walls that no room is behind.
  void AddShutDoors() {
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      for (int side = 0; side < 4; ++side) {
        const Plan& plan = plans_[i];
        if (!plan.used[static_cast<std::size_t>(side)].empty() ||
            draws_.Maybe(0.6)) {
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

  RandomPassage PassageOf(const Join& join) const {
    const Eigen::AlignedBox2d& box =
        plans_[static_cast<std::size_t>(join.room)].box;
    const int x = IsAlongX(join.side) ? 0 : 1;
    Point p;
    p[x] = join.middle;
    p[1 - x] =
        (join.side == 1 || join.side == 2 ? box.max() : box.min())[1 - x];
    return {turn_ * p, join.width};
  }

  RandomDraws& draws_;
  World world_;
  Eigen::Rotation2Dd turn_{0.0};
  std::vector<Plan> plans_;
  std::vector<Join> joins_;
};

}  // namespace

RandomRooms PlanRandomRooms(const std::string& name, RandomDraws* draws) {
  return RoomPlanner(draws).Make(name);
}

std::string WhereIn(const World& world, const char* list, std::size_t index) {
  return world.source + ": " + list + "[" + std::to_string(index) + "]";
}

}  // namespace waymark
