// The worlds that come with Waymark.
#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/walk_area.h"
#include "estimation/geometry/angle.h"
#include "processes/convert/world_file.h"
#include "tests/support/real_data.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace waymark {
namespace {

std::vector<std::string> WorldNames() {
  std::vector<std::string> names;
  const std::filesystem::path folder =
      std::filesystem::path(std::getenv("WAYMARK_SOURCE")) /
      "drivers/simulator/worlds";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().stem().string();
    // Its model does not come with Waymark.
    const bool has_files =
        name != "van_gogh" || (std::getenv("WAYMARK_DATA") != nullptr &&
                               !RealDataFolder("van_gogh_room_gltf").empty());
    if (entry.path().extension() == ".yaml" && has_files) {
      names.push_back(name);
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

class ShippedWorld : public testing::TestWithParam<std::string> {
 protected:
  World world_ = LoadWorldFile(FindWorldFile(GetParam()));
};

// A robot of this size, m, is free at starts and places and on routes.
constexpr double kRobotRadius = 0.25;
constexpr double kRobotHeight = 1.1;

TEST_P(ShippedWorld, HasRoomForARobotWhereItIsToBe) {
  const WalkArea area(world_, kRobotHeight);
  EXPECT_FALSE(world_.starts.empty());
  for (const auto* poses : {&world_.starts, &world_.places}) {
    for (const WorldPose& pose : *poses) {
      EXPECT_GT(area.Clearance(pose.X_WR.position()), kRobotRadius)
          << pose.name;
    }
  }
  for (const WorldRoute& route : world_.routes) {
    for (std::size_t i = 1; i < route.points.size(); ++i) {
      const Eigen::Vector2d way = route.points[i] - route.points[i - 1];
      for (double s = 0.0; s < way.norm(); s += 0.05) {
        const Eigen::Vector2d p = route.points[i - 1] + s * way.normalized();
        EXPECT_GT(area.Clearance(p), kRobotRadius)
            << route.name << " at " << p.transpose();
      }
    }
  }
}

TEST_P(ShippedWorld, PeopleWalkThroughNothing) {
  const WalkArea area(world_);
  const People people(world_, {});
  for (double t = 0.0; t < 60.0; t += 0.5) {
    const auto poses = people.PosesAt(t, world_.starts[0].X_WR);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (world_.people[i].motion == PersonMotion::kBeside) continue;
      EXPECT_GT(area.Clearance(poses[i].position()), 0.2)
          << world_.people[i].name << " at " << t << " s";
    }
  }
}

// Turns a pose toward a point at 1 rad/s, then goes there at 0.5 m/s; false
// there.
bool StepToward(const Eigen::Vector2d& goal, double dt, Pose2* X_WR) {
  const Eigen::Vector2d way = goal - X_WR->position();
  if (way.norm() < 1e-9) return false;
  const double turn = WrapAngle(std::atan2(way.y(), way.x()) - X_WR->heading);
  X_WR->heading += std::clamp(turn, -dt, dt);
  if (std::abs(turn) > dt) return true;
  const Eigen::Vector2d step = std::min(1.0, 0.5 * dt / way.norm()) * way;
  X_WR->x += step.x();
  X_WR->y += step.y();
  return true;
}

TEST_P(ShippedWorld, WhoGoesBesideTheRobotWalksAsPeopleDo) {
  const bool has_companion = std::any_of(
      world_.people.begin(), world_.people.end(), [](const auto& p) {
        return p.motion == PersonMotion::kBeside;
      });
  if (!has_companion) return;
  constexpr double kStep = 0.02;
  const PeopleOptions options;
  const People people(world_, options);
  const WalkArea area(world_);
  for (const WorldRoute& route : world_.routes) {
    std::vector<PersonState> states;
    Pose2 X_WR{route.points[0].x(), route.points[0].y(), 0.0};
    auto last = people.PosesAt(0.0, X_WR, states);
    double seconds = 0.0;
    int num_inside = 0;
    int num_close = 0;
    int num_steps = 0;
    for (const Eigen::Vector2d& goal : route.points) {
      for (Pose2 before = X_WR; StepToward(goal, kStep, &X_WR); before = X_WR) {
        people.Meet(seconds, kStep, before, &states);
        seconds += kStep;
        const auto poses = people.PosesAt(seconds, X_WR, states);
        const double robot_way = (X_WR.position() - before.position()).norm();
        for (std::size_t i = 0; i < poses.size(); ++i) {
          const WorldPerson& person = world_.people[i];
          if (person.motion != PersonMotion::kBeside) continue;
          const Eigen::Vector2d p = poses[i].position();
          ASSERT_LE(
              (p - last[i].position()).norm(),
              robot_way +
                  std::hypot(People::kBesideSpeed, People::kSqueezeSpeed) *
                      kStep +
                  1e-9)
              << person.name << " at " << p.transpose();
          const double gap = (p - X_WR.position()).norm() -
                             options.robot_radius - kPersonRadius;
          ASSERT_GE(gap, People::kLeastGap - 1e-9);
          ASSERT_LE(gap, person.clearance + 1e-9);
          if (gap < person.clearance - 1e-9) ++num_close;
          ++num_steps;
          if (area.Clearance(p) < kPersonRadius - 0.1) ++num_inside;
        }
        last = poses;
      }
    }
    // In doorways and corners, in the way of the robot and of each other, they
    // are closer than they wish for a moment, or brush through a door frame.
    EXPECT_LT(num_close, 0.06 * num_steps) << route.name;
    EXPECT_LT(num_inside, 0.03 * num_steps) << route.name;
  }
}

TEST_P(ShippedWorld, IsBuilt) {
  const Scene scene = BuildScene(world_);
  EXPECT_GT(scene.mesh.triangles.size(), 50u);
  // Where a model brings its light, no more than its surroundings need.
  const bool has_baked_light = std::any_of(
      world_.models.begin(), world_.models.end(), [](const auto& m) {
        return m.has_baked_light;
      });
  EXPECT_GT(scene.lamps.size(), has_baked_light ? 0u : 3u);
  EXPECT_EQ(scene.movers.size(), world_.people.size());
}

INSTANTIATE_TEST_SUITE_P(All,
                         ShippedWorld,
                         testing::ValuesIn(WorldNames()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace waymark
