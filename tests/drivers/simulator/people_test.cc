#include "drivers/simulator/people.h"

#include "estimation/base/input_error.h"
#include "estimation/base/random.h"
#include "tests/support/test_worlds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace waymark {
namespace {

constexpr double kPi = std::numbers::pi;

World WithPerson(const WorldPerson& person) {
  World world;
  world.rooms = {RectangleRoom("a", 0.0, 0.0, 12.0, 8.0, 2.5)};
  world.people = {person};
  return world;
}

WorldPerson Walker(bool is_closed) {
  WorldPerson person;
  person.motion = PersonMotion::kWalk;
  person.path = {{2.0, 2.0}, {6.0, 2.0}, {6.0, 5.0}};
  person.is_closed = is_closed;
  person.speed = 0.5;
  return person;
}

WorldPerson Companion(double bearing) {
  WorldPerson person;
  person.motion = PersonMotion::kBeside;
  person.bearing = bearing;
  return person;
}

void ExpectAt(const Pose2& pose, double x, double y, double heading) {
  EXPECT_NEAR(pose.x, x, 1e-9);
  EXPECT_NEAR(pose.y, y, 1e-9);
  EXPECT_NEAR(pose.heading, heading, 1e-9);
}

TEST(People, StandWhereTheyAreToldTo) {
  WorldPerson person;
  person.at << 3.0, 4.0;
  person.heading = 1.0;
  const People people(WithPerson(person), {});
  ExpectAt(people.PosesAt(0.0, {})[0], 3.0, 4.0, 1.0);
  ExpectAt(people.PosesAt(100.0, {5.0, 5.0, 1.0})[0], 3.0, 4.0, 1.0);
}

TEST(People, WalkBackAndForth) {
  const People people(WithPerson(Walker(false)), {});
  ExpectAt(people.PosesAt(0.0, {})[0], 2.0, 2.0, 0.0);
  ExpectAt(people.PosesAt(4.0, {})[0], 4.0, 2.0, 0.0);
  ExpectAt(people.PosesAt(10.0, {})[0], 6.0, 3.0, kPi / 2.0);
  ExpectAt(people.PosesAt(16.0, {})[0], 6.0, 4.0, -kPi / 2.0);  // Back.
  ExpectAt(people.PosesAt(28.0, {})[0], 2.0, 2.0, 0.0);         // Again.
}

TEST(People, WalkInARound) {
  const People people(WithPerson(Walker(true)), {});
  // 4 + 3 m, then 5 m straight to the start.
  const Pose2 pose = people.PosesAt(19.0, {})[0];
  ExpectAt(pose, 4.0, 3.5, std::atan2(-3.0, -4.0));
  ExpectAt(people.PosesAt(24.0, {})[0], 2.0, 2.0, 0.0);
}

TEST(People, MoveNoFasterThanTheirSpeed) {
  for (const bool is_closed : {false, true}) {
    const People people(WithPerson(Walker(is_closed)), {});
    for (double t = 0.0; t < 60.0; t += 0.1) {
      const double way = (people.PosesAt(t + 0.1, {})[0].position() -
                          people.PosesAt(t, {})[0].position())
                             .norm();
      EXPECT_LE(way, 0.05 + 1e-9) << t;
    }
  }
}

TEST(People, GoBesideTheRobotAtTheirClearance) {
  WorldPerson person = Companion(kPi / 2.0);
  person.clearance = 0.2;
  PeopleOptions options;
  options.robot_radius = 0.3;
  const People people(WithPerson(person), options);
  // To the left of a robot that looks north: west of it.
  ExpectAt(people.PosesAt(7.0, {6.0, 4.0, kPi / 2.0})[0],
           6.0 - (0.3 + 0.2 + kPersonRadius),
           4.0,
           kPi / 2.0);
}

TEST(People, BesideTheRobotStayOutOfWallsAndOfEachOther) {
  WorldPerson person = Companion(0.0);
  World world = WithPerson(person);
  for (const double bearing : {kPi / 2.0, kPi, -kPi / 2.0}) {
    world.people.push_back(Companion(bearing));
  }
  const WalkArea area(world);
  const People people(world, {});
  const double distance = 0.25 + 0.2 + kPersonRadius;
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const Pose2 X_WR{random.Uniform(0.3, 11.7),
                     random.Uniform(0.3, 7.7),
                     random.Uniform(-kPi, kPi)};
    const auto poses = people.PosesAt(0.0, X_WR);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      EXPECT_NEAR(
          (poses[k].position() - X_WR.position()).norm(), distance, 1e-9);
      // Four discs of 0.5 m fit around the robot even in a corner only where
      // it is some way off; the first always finds its place.
      if (k == 0) {
        EXPECT_GE(area.Clearance(poses[k].position()), kPersonRadius - 1e-9);
      }
      EXPECT_GE(area.Clearance(poses[k].position()), -0.5);
    }
    const bool is_open = area.Clearance(X_WR.position()) > 1.0;
    for (std::size_t a = 0; is_open && a < 4; ++a) {
      EXPECT_GE(area.Clearance(poses[a].position()), kPersonRadius - 1e-9);
      for (std::size_t b = 0; b < a; ++b) {
        EXPECT_GE((poses[a].position() - poses[b].position()).norm(),
                  2.0 * kPersonRadius - 1e-9);
      }
    }
  }
}

TEST(People, BesideTheRobotAreLeastInTheWayWhereNothingIsFree) {
  // A corridor too narrow for two abreast, and no way before or behind.
  World world;
  world.rooms = {RectangleRoom("a", 0.0, 0.0, 1.0, 0.8, 2.5)};
  world.people = {Companion(kPi / 2.0)};
  const People people(world, {});
  const Pose2 pose = people.PosesAt(0.0, {0.5, 0.4, 0.0})[0];
  // 0.7 m ahead or behind is 0.2 m behind a wall, to the side 0.3 m.
  const double outside =
      std::max({-pose.x, pose.x - 1.0, -pose.y, pose.y - 0.8, 0.0});
  EXPECT_LT(outside, 0.21);
}

TEST(People, RefuseAPathWithoutLength) {
  WorldPerson person = Walker(false);
  person.path = {{1.0, 1.0}, {1.0, 1.0}};
  EXPECT_THROW(People(WithPerson(person), {}), InputError);
}

}  // namespace
}  // namespace waymark
