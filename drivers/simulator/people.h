// Where the people of a world are.
#pragma once

#include "drivers/simulator/person_state.h"
#include "drivers/simulator/walk_area.h"
#include "drivers/simulator/world.h"
#include "estimation/geometry/pose2.h"

#include <span>
#include <vector>

namespace waymark {

inline constexpr double kPersonRadius = 0.25;  // Of the cylinder, m.

struct PeopleOptions {
  double robot_radius = 0.25;  // What clearances are measured from, m.

  // Throws std::invalid_argument where it is not in (0, 10].
  void Check() const;
};

// Poses follow from time, the robot's pose, and what people have met with so
// far, which whoever asks remembers for them.
class People {
 public:
  // `area`: of the same world, for a body of kPersonHeight. Throws InputError
  // where a path has no length.
  People(const World& world, WalkArea area, const PeopleOptions& options);
  // Builds the area, and throws as WalkArea(world) does.
  People(const World& world, const PeopleOptions& options);

  // X_WP of each person in the order of World::people.
  //
  //   seconds   since the start of the run
  //   X_WR      the robot's pose
  //   states    as Meet() leaves them; empty: nobody has met a robot
  //
  // Who stands, stands. Who walks is at start + speed * (seconds - waited)
  // along the path, or aside of it, and looks along it. Who goes beside the
  // robot is `clearance` from its cylinder, where Meet() has led them; before
  // that at the wanted bearing or, where walls, furniture or the others beside
  // it are in the way, at the nearest free one; where none is free, at the one
  // that is least in the way. Looks where the robot looks.
  [[nodiscard]] std::vector<Pose2> PosesAt(
      double seconds,
      const Pose2& X_WR,
      std::span<const PersonState> states = {}) const;

  // What who walks makes of a robot at X_WR in the `dt` from `seconds` on:
  // steps aside as far as there is room, stops kWaitGap before a robot that
  // still is less than kPassGap beside its way, after kPatienceS gives way
  // until it is kGiveGap away, and goes on when it is gone. Who goes beside it
  // keeps with it, and goes around it at kBesideSpeed at most: to the wanted
  // bearing as far as that is free, else out of what is in the way; meanwhile,
  // closer to it.
  void Meet(double seconds,
            double dt,
            const Pose2& X_WR,
            std::vector<PersonState>* states) const;

  // Air between person and robot, m.
  static constexpr double kPassGap = 0.25;
  static constexpr double kWaitGap = 0.6;
  static constexpr double kLookGap = 1.5;  // Farther robots are nobody's care.
  static constexpr double kPatienceS = 3.0;
  static constexpr double kGiveGap = 1.0;       // When they have given way.
  static constexpr double kAsideSpeed = 0.4;    // m/s.
  static constexpr double kBesideSpeed = 1.5;   // About the robot, m/s.
  static constexpr double kSqueezeSpeed = 1.0;  // To it and from it, m/s.
  static constexpr double kLeastGap = 0.05;     // m.

 private:
  struct Path {
    std::vector<Eigen::Vector2d> points;  // Closed: the first one again.
    std::vector<double> along;            // m from the start, of each point.
  };

  void MeetAsWalker(const Pose2& X_WP,
                    double dt,
                    const Pose2& X_WR,
                    PersonState* state) const;
  // Where that is free, and not too close to the robot.
  [[nodiscard]] bool Shift(const Pose2& X_WP,
                           const Eigen::Vector2d& step_W,
                           const Pose2& X_WR,
                           PersonState* state) const;
  [[nodiscard]] Pose2 Walk(const WorldPerson& person,
                           const Path& path,
                           const PersonState& state,
                           double seconds) const;
  // At a bearing in W, `squeezed` closer than their clearance.
  [[nodiscard]] Pose2 Beside(const WorldPerson& person,
                             const Pose2& X_WR,
                             double bearing_W,
                             double squeezed = 0.0) const;
  // How far who goes there would be in walls and `others`, m; not positive
  // where that is free.
  [[nodiscard]] double Intrusion(const WorldPerson& person,
                                 const Pose2& X_WR,
                                 double bearing_W,
                                 std::span<const Pose2> others) const;
  // The free one nearest to `bearing_W`, else the one least in the way.
  [[nodiscard]] double FreeBearing(const WorldPerson& person,
                                   const Pose2& X_WR,
                                   double bearing_W,
                                   std::span<const Pose2> others) const;
  // Turn about the robot to the free bearing to which least is in the way.
  [[nodiscard]] double WayOut(const WorldPerson& person,
                              const Pose2& X_WR,
                              double bearing_W,
                              std::span<const Pose2> others) const;
  // The bearing after dt seconds.
  [[nodiscard]] double GoAround(const WorldPerson& person,
                                const Pose2& X_WR,
                                double bearing_W,
                                double dt,
                                std::span<const Pose2> others) const;

  std::vector<WorldPerson> people_;
  std::vector<Path> paths_;  // Of each person; empty where not walking.
  WalkArea area_;
  PeopleOptions options_;
};

}  // namespace waymark
