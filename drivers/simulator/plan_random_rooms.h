// The rooms of a random world and the doors between them, before anything
// stands in them: the first half of RandomWorld().
#pragma once

#include "drivers/simulator/world.h"
#include "estimation/base/random.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace waymark {

// What worlds are drawn from.
class RandomDraws : public Random {
 public:
  using Random::Random;

  bool Maybe(double probability) { return Uniform() < probability; }
  // Ends included.
  int Between(int low, int high) {
    const int num = high - low + 1;
    return low + static_cast<int>(Index(static_cast<std::uint64_t>(num)));
  }
  template <typename T>
  const T& OneOf(const std::vector<T>& all) {
    return all[Index(all.size())];
  }
  // Of what is drawn later: pictures, books, clothes.
  std::uint64_t Seed() { return Bits() >> 33; }
};

struct RandomPassage {
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();  // Its middle.
  double width = 0.0;
};

struct RandomRooms {
  World world;  // Rooms, lamps, rows of pictures, openings, doors.
  // Of each room: the box it was cut from, which `turn` turns into the world.
  std::vector<Eigen::AlignedBox2d> boxes;
  Eigen::Rotation2Dd turn{0.0};
  std::vector<RandomPassage> passages;  // From room to room.
};

[[nodiscard]] RandomRooms PlanRandomRooms(const std::string& name,
                                          RandomDraws* draws);

// "random:7: doors[2]".
[[nodiscard]] std::string WhereIn(const World& world,
                                  const char* list,
                                  std::size_t index);

}  // namespace waymark
