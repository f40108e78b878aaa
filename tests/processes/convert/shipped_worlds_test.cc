// The worlds that come with Waymark.
#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/walk_area.h"
#include "processes/convert/world_file.h"

#include <gtest/gtest.h>

#include <algorithm>
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
    if (entry.path().extension() == ".yaml" && name != "van_gogh") {
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

TEST_P(ShippedWorld, IsBuilt) {
  const Scene scene = BuildScene(world_);
  EXPECT_GT(scene.mesh.triangles.size(), 50u);
  EXPECT_GT(scene.lamps.size(), 3u);
  EXPECT_EQ(scene.movers.size(), world_.people.size());
}

INSTANTIATE_TEST_SUITE_P(All,
                         ShippedWorld,
                         testing::ValuesIn(WorldNames()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace waymark
