#include "drivers/simulator/random_world.h"

#include "drivers/simulator/build_furniture.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/plan_random_rooms.h"
#include "drivers/simulator/walk_area.h"
#include "drivers/simulator/world_layout.h"
#include "estimation/base/check.h"
#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using Point = Eigen::Vector2d;
using Box = Eigen::AlignedBox2d;

// Something that stands, or is to stay free.
struct Spot {
  Point p;
  double radius = 0.0;
};

// Where the robot starts, and what stands there.
class Furnisher {
 public:
  Furnisher(RandomRooms rooms, RandomDraws* draws)
      : draws_(*draws),
        world_(std::move(rooms.world)),
        boxes_(std::move(rooms.boxes)),
        turn_(rooms.turn) {
    // So that what stands there keeps doors free, and their leaves.
    for (const RandomPassage& passage : rooms.passages) {
      spots_.push_back({passage.p_W, 0.3 + passage.width});
    }
  }

  // nullopt where nothing is left to start from.
  std::optional<World> Make() {
    if (!ChooseStart()) return std::nullopt;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      Furnish(world_.rooms[i], boxes_[i]);
    }
    return std::move(world_);
  }

 private:
  Point PointIn(const Box& box) {
    const double y = draws_.Uniform();
    const Point share(draws_.Uniform(), y);
    return turn_ * (box.min() + share.cwiseProduct(box.sizes()));
  }

  bool ChooseStart() {
    const WalkArea walls(world_);
    constexpr int kMaxDraws = 300;
    for (int i = 0; i < kMaxDraws; ++i) {
      const Point p = PointIn(draws_.OneOf(boxes_));
      if (walls.Clearance(p) < kStartClearance) continue;
      world_.starts.push_back({WhereIn(world_, "starts", 0),
                               "start 0",
                               {p.x(), p.y(), draws_.Uniform(-kPi, kPi)}});
      spots_.push_back({p, kStartClearance});
      return true;
    }
    return false;
  }

  // A place in a room for something within `radius`, which it is from then on.
  std::optional<Point> Place(const WorldRoom& room,
                             const Box& box,
                             double radius) {
    constexpr int kMaxDraws = 20;
    for (int i = 0; i < kMaxDraws; ++i) {
      const Point p = PointIn(box);
      if (!IsInside(room.outline, p) ||
          DistanceToOutline(room.outline, p) < radius ||
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

  void Furnish(const WorldRoom& room, const Box& box) {
    for (int i = draws_.Between(0, 2); i > 0; --i) AddPillar(room, box);
    const int most = std::clamp(static_cast<int>(box.volume() / 3.0), 1, 8);
    for (int i = draws_.Between(0, most); i > 0; --i) AddFurniture(room, box);
    for (int i = draws_.Between(0, 2); i > 0; --i) AddPerson(room, box);
  }

  void AddPillar(const WorldRoom& room, const Box& box) {
    WorldPillar pillar;
    pillar.where = WhereIn(world_, "pillars", world_.pillars.size());
    pillar.shape =
        draws_.Maybe(0.5) ? PillarShape::kRound : PillarShape::kSquare;
    pillar.size = draws_.Uniform(0.05, 0.6);
    pillar.heading = draws_.Uniform(-kPi, kPi);
    const auto at = Place(room, box, pillar.size * std::sqrt(0.5));
    if (!at) return;
    pillar.at = *at;
    world_.pillars.push_back(pillar);
  }

  void AddFurniture(const WorldRoom& room, const Box& box) {
    WorldFurniture piece;
    piece.where = WhereIn(world_, "furniture", world_.furniture.size());
    piece.kind = static_cast<FurnitureKind>(
        draws_.Between(0, static_cast<int>(FurnitureKind::kBox)));
    piece.size = draws_.Uniform(0.8, 1.2) * UsualSize(piece.kind);
    piece.heading = draws_.Uniform(-kPi, kPi);
    piece.seed = draws_.Seed();
    const auto at = Place(room, box, piece.size.head<2>().norm() / 2.0);
    if (!at) return;
    piece.at = *at;
    world_.furniture.push_back(piece);
  }

  void AddPerson(const WorldRoom& room, const Box& box) {
    WorldPerson person;
    person.where = WhereIn(world_, "people", world_.people.size());
    person.name = "person " + std::to_string(world_.people.size() + 1);
    person.height = draws_.Uniform(1.5, 1.95);
    person.heading = draws_.Uniform(-kPi, kPi);
    person.seed = draws_.Seed();
    const auto at = Place(room, box, kPersonRadius);
    if (!at) return;
    person.at = *at;
    world_.people.push_back(person);
  }

  RandomDraws& draws_;
  World world_;
  std::vector<Box> boxes_;
  Eigen::Rotation2Dd turn_;
  std::vector<Spot> spots_;
};

}  // namespace

World RandomWorld(std::uint64_t seed) {
  const std::string name = "random:" + std::to_string(seed);
  // Now and then nothing is left to start from.
  constexpr int kMaxDraws = 100;
  for (int i = 0; i < kMaxDraws; ++i) {
    RandomDraws draws(SeedFor(seed, "random_world " + std::to_string(i)));
    RandomRooms rooms = PlanRandomRooms(name, &draws);
    if (auto world = Furnisher(std::move(rooms), &draws).Make()) return *world;
  }
  WAYMARK_CHECK(false, seed);
  return {};
}

}  // namespace waymark
