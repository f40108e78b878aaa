#include "drivers/simulator/people.h"

#include "estimation/base/input_error.h"
#include "estimation/base/random.h"
#include "tests/support/test_worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

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

// Someone walks for 40 s, the first `num_s` of them with a robot at X_WR:
// where they are every 10 ms.
std::vector<Pose2> WalkedPast(const People& people,
                              const Pose2& X_WR,
                              double num_s) {
  constexpr double kStep = 0.01;
  std::vector<PersonState> states;
  std::vector<Pose2> poses;
  for (int i = 0; i < 4000; ++i) {
    const double t = i * kStep;
    const Pose2 X_now = t < num_s ? X_WR : Pose2{100.0, 100.0, 0.0};
    poses.push_back(people.PosesAt(t, X_now, states)[0]);
    people.Meet(t, kStep, X_now, &states);
  }
  return poses;
}

double LeastGap(const std::vector<Pose2>& poses, const Pose2& X_WR) {
  double least = 100.0;
  for (const Pose2& pose : poses) {
    least = std::min(least, (pose.position() - X_WR.position()).norm());
  }
  return least - kPersonRadius - PeopleOptions().robot_radius;
}

TEST(People, StepAsideForARobotInTheirWay) {
  const People people(WithPerson(Walker(false)), {});
  const Pose2 X_WR{4.0, 2.0, 0.0};
  const auto poses = WalkedPast(people, X_WR, 100.0);
  // Steps of 5 mm.
  EXPECT_GT(LeastGap(poses, X_WR), People::kPassGap - 0.006);
  // Past it at the usual pace, and on the path again.
  ExpectAt(poses[1000], 6.0, 3.0, kPi / 2.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double way = (poses[i].position() - poses[i - 1].position()).norm();
    EXPECT_LE(way, 0.01 * (0.5 + People::kAsideSpeed) + 1e-9);
  }
}

TEST(People, WhereThereIsNoRoomStopGiveWayAndGoOnWhenItIsGone) {
  World world = WithPerson(Walker(false));
  // Fits one person.
  world.rooms = {RectangleRoom("a", 0.0, 1.73, 12.0, 2.27, 2.5)};
  world.people[0].path = {{2.0, 2.0}, {10.0, 2.0}};
  const People people(world, {});
  const Pose2 X_WR{5.0, 2.0, 0.0};
  const double stop =
      5.0 - kPersonRadius - PeopleOptions().robot_radius - People::kWaitGap;
  const auto poses = WalkedPast(people, X_WR, 20.0);
  const std::vector<Pose2> with_robot(poses.begin(), poses.begin() + 2000);
  EXPECT_GT(LeastGap(with_robot, X_WR), People::kWaitGap - 0.006);
  EXPECT_NEAR(poses[500].x, stop, 0.006);  // Waits.
  EXPECT_NEAR(poses[650].x, stop, 0.006);
  EXPECT_LT(poses[800].x, stop - 0.3);            // Has given way.
  EXPECT_GT(poses[2900].x, poses[2000].x + 4.4);  // Walks on.
}

// A robot that stays before them until their patience is over, and then there:
// they go off their path, away from it, and back when it is gone.
TEST(People, InTheOpenGiveWayOffTheirPath) {
  const People people(WithPerson(Walker(false)), {});
  constexpr double kStep = 0.01;
  std::vector<PersonState> states(1);
  Pose2 X_WR{4.0, 2.0, 0.0};
  double t = 0.0;
  for (; states[0].patience_s < People::kPatienceS; t += kStep) {
    ASSERT_LT(t, 10.0);
    X_WR.y = people.PosesAt(t, X_WR, states)[0].y;
    people.Meet(t, kStep, X_WR, &states);
  }
  const Eigen::Vector2d from = people.PosesAt(t, X_WR, states)[0].position();
  for (int i = 0; i < 300; ++i, t += kStep) {
    people.Meet(t, kStep, X_WR, &states);
  }
  const Eigen::Vector2d to = people.PosesAt(t, X_WR, states)[0].position();
  EXPECT_NEAR((to - X_WR.position()).norm(),
              kPersonRadius + PeopleOptions().robot_radius + People::kGiveGap,
              People::kAsideSpeed * kStep);
  const Eigen::Vector2d away = (from - X_WR.position()).normalized();
  EXPECT_NEAR((to - from).dot(away), (to - from).norm(), 1e-6);
  EXPECT_GT(states[0].aside_W.norm(), 1.0);
  for (int i = 0; i < 1000; ++i, t += kStep) {
    people.Meet(t, kStep, {100.0, 100.0, 0.0}, &states);
  }
  EXPECT_LT(states[0].aside_W.norm(), 1e-9);
}

TEST(People, WalkOnPastARobotBesideOrBehindThem) {
  const People people(WithPerson(Walker(false)), {});
  const double beside =
      kPersonRadius + PeopleOptions().robot_radius + People::kPassGap + 0.001;
  for (const Pose2& X_WR : {Pose2{4.0, 2.0 + beside, 0.0},
                            Pose2{4.0, 2.0 - beside, 0.0},
                            Pose2{1.4, 2.0, 0.0}}) {
    EXPECT_EQ(WalkedPast(people, X_WR, 6.0)[600], people.PosesAt(6.0, {})[0]);
  }
}

TEST(People, WhoStandsMindsNoRobot) {
  World world = WithPerson({});
  world.people.push_back({});
  const People people(world, {});
  std::vector<PersonState> states;
  people.Meet(1.0, 0.1, {0.1, 0.0, 0.0}, &states);
  ASSERT_EQ(states.size(), 2u);
  for (const PersonState& state : states) {
    EXPECT_EQ(state.waited_s, 0.0);
    EXPECT_EQ(state.aside_W.norm(), 0.0);
  }
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
  World world = WithPerson(Companion(0.0));
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

// A robot along a wall that comes near, into a doorway, back, and turning.
TEST(People, BesideTheRobotDoNotJumpAndComeBackToTheirSide) {
  World world = WithPerson(Companion(kPi / 2.0));
  WorldFurniture piece;
  piece.at << 6.0, 4.9;
  piece.size << 2.0, 1.0, 1.9;
  piece.kind = FurnitureKind::kCabinet;
  world.furniture = {piece};
  const WalkArea area(world);
  const People people(world, {});
  std::vector<PersonState> states;
  constexpr double kStep = 0.005;
  Pose2 X_WR{2.0, 4.0, 0.0};
  Pose2 last = people.PosesAt(0.0, X_WR, states)[0];
  double most_in = 0.0;
  for (int i = 0; i < 5000; ++i) {
    // 0.5 m/s ahead, then on the spot.
    const double heading = i < 3200 ? 0.0 : X_WR.heading + 0.6 * kStep;
    const double way = i < 3200 ? 0.5 * kStep : 0.0;
    people.Meet(i * kStep, kStep, X_WR, &states);
    X_WR = {X_WR.x + way, X_WR.y, heading};
    const Pose2 pose = people.PosesAt((i + 1) * kStep, X_WR, states)[0];
    const Eigen::Vector2d p = pose.position();
    EXPECT_LE(
        (p - last.position()).norm(),
        way + std::hypot(People::kBesideSpeed, People::kSqueezeSpeed) * kStep +
            1e-9);
    EXPECT_LE((p - X_WR.position()).norm(), 0.7 + 1e-9);
    EXPECT_GE((p - X_WR.position()).norm(), 0.55 - 1e-9);
    most_in = std::max(most_in, kPersonRadius - area.Clearance(p));
    last = pose;
    if (i == 3199) {
      ExpectAt(pose, X_WR.x, 4.7, 0.0);
    }
  }
  // What one sees of the cabinet before stepping aside.
  EXPECT_LT(most_in, 0.02);
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
