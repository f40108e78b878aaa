// Closed loops of the experiments in a small world.
#include "processes/support/configuration.h"
#include "processes/support/log_file.h"
#include "processes/tools/experiment/drive_experiment.h"
#include "processes/tools/experiment/drive_task.h"
#include "processes/tools/experiment/experiment_world.h"
#include "processes/tools/experiment/ram_experiment.h"
#include "tests/support/temporary_directory.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>
#include <vector>

namespace waymark {
namespace {

// Two rooms with a door between them, a pillar and furniture.
constexpr const char* kWorld = R"(
rooms:
  - {name: west, rectangle: [0, 0, 5, 4], height: 2.5}
  - {name: east, rectangle: [5.1, 0, 10.1, 4], height: 2.5}
openings:
  - {room: west, wall: east, at: 2, width: 0.9}
pillars:
  - {at: [2.5, 2.2], shape: square, size: 0.4}
furniture:
  - {kind: desk, at: [8.5, 3.3]}
starts: [[1, 1, 0]]
)";

class ExperimentsTest : public testing::Test {
 protected:
  ExperimentsTest() { std::ofstream(folder_ / "rooms.yaml") << kWorld; }

  void Prepare(Experiment* experiment,
               const std::vector<std::string>& settings = {}) {
    const DescribeFunction describe = [&](Describer& d) {
      experiment->Describe(d);
    };
    ApplySetting("simulator.world=" + (folder_ / "rooms.yaml"), describe);
    for (const std::string& setting : settings) {
      ApplySetting(setting, describe);
    }
    experiment->Prepare();
  }

  TemporaryDirectory folder_;
};

TEST_F(ExperimentsTest, DrivesThroughTheDoorToItsGoals) {
  DriveExperiment drive;
  Prepare(&drive);
  for (const std::uint64_t seed : {1u, 2u}) {
    const RunResult result = drive.Run(seed, "");
    EXPECT_TRUE(result.is_success) << result.reason;
    EXPECT_EQ(result.num_touches, 0);
    EXPECT_GE(result.way_m, result.shortest_m);
    EXPECT_LT(result.way_m, 1.4 * result.shortest_m);
  }
}

TEST_F(ExperimentsTest, DrivesThroughTheDoorBySonar) {
  DriveExperiment drive;
  Prepare(&drive, {"simulator.ranges.kind=sonar"});
  for (const std::uint64_t seed : {1u, 2u}) {
    const RunResult result = drive.Run(seed, "");
    EXPECT_TRUE(result.is_success) << result.reason;
    EXPECT_EQ(result.num_touches, 0);
  }
}

TEST_F(ExperimentsTest, TheSameRunWithALogAndWithout) {
  DriveExperiment drive;
  Prepare(&drive, {"task.num_goals=1"});
  const RunResult without = drive.Run(3, "");
  const RunResult with = drive.Run(3, folder_ / "a.lcm");
  EXPECT_EQ(with, without);
  EXPECT_EQ(drive.Run(3, folder_ / "b.lcm"), without);
  EXPECT_EQ(ReadBytes(folder_ / "a.lcm"), ReadBytes(folder_ / "b.lcm"));
  std::set<std::string> channels;
  LogReader reader(folder_ / "a.lcm");
  while (const auto event = reader.Next()) channels.insert(event->channel);
  for (const char* channel : {"ENCODERS",
                              "TRUTH",
                              "POSE",
                              "RANGES",
                              "TASK",
                              "TASK_STATUS",
                              "MOTION_COMMAND"}) {
    EXPECT_TRUE(channels.contains(channel)) << channel;
  }
}

TEST_F(ExperimentsTest, StartsAreFreeOfPeopleWhoWalk) {
  std::ofstream(folder_ / "rooms.yaml", std::ios::app)
      << "people: [{motion: walk, path: [[1, 1], [4, 1]], start: 1}]\n";
  SimulatorConfig config = SimulatorWithoutVision();
  config.world = folder_ / "rooms.yaml";
  DriveTaskOptions options;
  options.num_goals = 1;
  options.min_way = 0.0;
  const ExperimentTasks tasks(config, options);
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Eigen::Vector2d p = tasks.Make(seed).X_WR.position();
    EXPECT_GT((p - Eigen::Vector2d(2.0, 1.0)).norm(), 0.6) << seed;
  }
}

// What one run leaves behind must not reach the next one.
TEST_F(ExperimentsTest, RefusesWhatRunsWouldShare) {
  for (const char* setting : {"simulator.state_file=a",
                              "path_follower.task_file=a",
                              "collision_guard.stop_file=a",
                              "simulator.time.pace=stepped",
                              "simulator.time.speed=4"}) {
    DriveExperiment drive;
    EXPECT_THROW(Prepare(&drive, {setting}), std::invalid_argument) << setting;
  }
}

TEST_F(ExperimentsTest, AnotherWorldIsAnotherSubject) {
  DriveExperiment first;
  Prepare(&first);
  DriveExperiment again;
  Prepare(&again);
  EXPECT_EQ(first.Subject(), again.Subject());
  std::ofstream(folder_ / "rooms.yaml", std::ios::app)
      << "people: [{motion: stand, at: [4, 1]}]\n";
  DriveExperiment other;
  Prepare(&other);
  EXPECT_NE(first.Subject(), other.Subject());
}

TEST_F(ExperimentsTest, TheShortestWayComesAsNearAsItMust) {
  DriveTask task;
  task.goals = {{1.0, 0.0}, {3.0, 0.0}};
  task.shortest_m = 3.0;
  EXPECT_NEAR(ShortestPast(task, 0.25), 2.25, 1e-12);
  EXPECT_EQ(ShortestPast(task, 2.0), 0.0);
}

TEST_F(ExperimentsTest, WithoutTimeItFailsAndSaysWhy) {
  DriveExperiment drive;
  Prepare(&drive, {"max_duration_s=2"});
  const RunResult result = drive.Run(1, "");
  EXPECT_FALSE(result.is_success);
  EXPECT_EQ(result.reason, "out of time");
  EXPECT_NEAR(result.duration_s, 2.0, 1e-9);
}

TEST_F(ExperimentsTest, BehindTheGuardNothingIsTouched) {
  RamExperiment ram;
  Prepare(&ram, {"duration_s=30"});
  double way = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const RunResult result = ram.Run(seed, "");
    EXPECT_EQ(result.num_touches, 0) << seed;
    way += result.way_m;
  }
  EXPECT_GT(way, 4.0);  // It does move.
}

TEST_F(ExperimentsTest, WithoutTheGuardItTouchesAndNeverPassesThrough) {
  RamExperiment ram;
  Prepare(&ram,
          {"simulator.world=random",
           "collision_guard.ranges.use=none",
           "collision_guard.contact_hold_s=0",
           "duration_s=20"});
  std::int64_t num_touches = 0;
  for (std::uint64_t seed = 1001; seed <= 1020; ++seed) {
    const RunResult result = ram.Run(seed, "");
    ASSERT_EQ(result.figures[0].first, "into_walls_m");
    EXPECT_LE(result.figures[0].second, 0.0) << "world random:" << seed;
    num_touches += result.num_touches;
  }
  EXPECT_GT(num_touches, 20);
}

// The thousands of the README, in small.
TEST_F(ExperimentsTest, InRandomWorldsNothingIsTouched) {
  for (const char* kind : {"sonar", "lidar"}) {
    RamExperiment ram;
    Prepare(&ram,
            {"simulator.world=random",
             std::string("simulator.ranges.kind=") + kind,
             "duration_s=20"});
    double way = 0.0;
    for (std::uint64_t seed = 1001; seed <= 1040; ++seed) {
      const RunResult result = ram.Run(seed, "");
      EXPECT_EQ(result.num_touches, 0) << kind << ", world random:" << seed;
      way += result.way_m;
    }
    EXPECT_GT(way, 40.0) << kind;
  }
}

// They walk, wait and step aside.
TEST_F(ExperimentsTest, AmongPeopleWhoWalkNothingIsTouched) {
  RamExperiment ram;
  Prepare(&ram, {"simulator.world=corridor_office"});
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_EQ(ram.Run(seed, "").num_touches, 0) << seed;
  }
}

TEST(DriveTask, GoalsAreReachableAndTheirWaysAsLongAsAskedFor) {
  const ObstacleMap map({{{0.0, 0.0}, {8.0, 0.0}},
                         {{8.0, 0.0}, {8.0, 4.0}},
                         {{8.0, 4.0}, {0.0, 4.0}},
                         {{0.0, 4.0}, {0.0, 0.0}},
                         {{4.0, 0.0}, {4.0, 2.8}}});
  DriveTaskOptions options;
  options.min_way = 3.0;
  options.max_way = 9.0;
  const DriveTaskMaker maker(map, options, {1.0, 1.0});
  const Geodesic shortest(map, options.radius);
  std::set<double> starts;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const DriveTask task = maker.Make(seed);
    starts.insert(task.X_WR.x);
    ASSERT_EQ(task.goals.size(), 3u);
    EXPECT_EQ(task.waypoints.back(), task.goals.back());
    Eigen::Vector2d from = task.X_WR.position();
    double sum = 0.0;
    for (const Eigen::Vector2d& goal : task.goals) {
      const auto path = shortest.Shortest(from, goal);
      ASSERT_TRUE(path.has_value());
      EXPECT_GE(path->length, 3.0);
      EXPECT_LE(path->length, 9.0);
      sum += path->length;
      from = goal;
    }
    EXPECT_DOUBLE_EQ(task.shortest_m, sum);
    // What joins the way-points keeps the clearance, but for what simplifying
    // the way took.
    Eigen::Vector2d last = task.X_WR.position();
    for (const Eigen::Vector2d& p : task.waypoints) {
      const Eigen::Vector2d way = p - last;
      const Pose2 X_WR{last.x(), last.y(), std::atan2(way.y(), way.x())};
      EXPECT_FALSE(map.FirstContact(
          X_WR, {way.norm(), 0.0}, options.radius + options.clearance - 0.031));
      last = p;
    }
    EXPECT_EQ(maker.Make(seed).waypoints, task.waypoints);
  }
  EXPECT_EQ(starts.size(), 5u);
  EXPECT_THROW(DriveTaskMaker(map, options, {-5.0, 1.0}),
               std::invalid_argument);
  options.min_way = 50.0;
  options.max_way = 60.0;
  const DriveTaskMaker far(map, options, {1.0, 1.0});
  EXPECT_THROW((void)far.Make(1), std::invalid_argument);
}

TEST(DriveTask, SimplifiedKeepsCornersAndTolerance) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= 100; ++i) points.emplace_back(0.01 * i, 0.0);
  for (int i = 1; i <= 100; ++i) points.emplace_back(1.0, 0.01 * i);
  const auto simple = Simplified(points, 0.01);
  ASSERT_EQ(simple.size(), 3u);
  EXPECT_EQ(simple[1], Eigen::Vector2d(1.0, 0.0));
  EXPECT_EQ(Simplified({{1.0, 2.0}}, 0.1).size(), 1u);
}

}  // namespace
}  // namespace waymark
