// Where the people of a world are.
#pragma once

#include "drivers/simulator/walk_area.h"
#include "drivers/simulator/world.h"
#include "estimation/geometry/pose2.h"

#include <vector>

namespace waymark {

inline constexpr double kPersonRadius = 0.25;  // Of the cylinder, m.

struct PeopleOptions {
  double robot_radius = 0.25;  // What clearances are measured from, m.

  // Throws std::invalid_argument where it is not in (0, 10].
  void Check() const;
};

// Poses follow from time and the robot's pose alone: nobody remembers.
class People {
 public:
  // Throws InputError where a path has no length, or the world is none.
  People(const World& world, const PeopleOptions& options);

  // X_WP of each person in the order of World::people.
  //
  //   seconds   since the start of the run
  //   X_WR      the robot's pose
  //
  // Who stands, stands. Who walks is at start + speed * seconds along the path
  // and looks along it. Who goes beside the robot is `clearance` from its
  // cylinder, at the wanted bearing or, where walls, furniture or the others
  // beside it are in the way, at the nearest free one; where none is free, at
  // the one that is least in the way. Looks where the robot looks.
  [[nodiscard]] std::vector<Pose2> PosesAt(double seconds,
                                           const Pose2& X_WR) const;

 private:
  struct Path {
    std::vector<Eigen::Vector2d> points;  // Closed: the first one again.
    std::vector<double> along;            // m from the start, of each point.
  };

  [[nodiscard]] Pose2 Walk(const WorldPerson& person,
                           const Path& path,
                           double seconds) const;
  [[nodiscard]] Pose2 Beside(const WorldPerson& person,
                             const Pose2& X_WR,
                             const std::vector<Pose2>& others) const;

  std::vector<WorldPerson> people_;
  std::vector<Path> paths_;  // Of each person; empty where not walking.
  WalkArea area_;
  PeopleOptions options_;
};

}  // namespace waymark
