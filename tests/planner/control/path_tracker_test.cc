#include "planner/control/path_tracker.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <functional>

namespace waymark {
namespace {

using testing::HasSubstr;

Time At(double s) {
  return TimeFromMicroseconds(1'000'000) + DurationFromSeconds(s);
}

// A robot driven by a tracker: poses at 20 Hz, as late and as noisy as stated.
struct Loop {
  explicit Loop(const PathTrackerOptions& options = {}) : tracker(options) {}

  // Steps until the tracker is done, failed, or `seconds` have passed.
  void Run(double seconds) {
    for (const double end = t + seconds; t < end && tracker_is_running();) {
      Step();
    }
  }
  [[nodiscard]] bool tracker_is_running() const {
    return report.state != TrackState::kDone &&
           report.state != TrackState::kFailed;
  }
  void Step() {
    late.push_back(state.pose);
    if (late.size() > 1 + static_cast<std::size_t>(pose_delay)) {
      late.pop_front();
    }
    Pose2 seen = late.front();
    seen.x += random.Normal(sigma);
    seen.y += random.Normal(sigma);
    seen.heading = WrapAngle(seen.heading + random.Normal(sigma_heading));
    report = tracker.Update(At(t), seen);
    const double before = last.turn_rate;
    last = report.velocity;
    // Changes of side that anyone would see.
    if (last.turn_rate * before < 0.0 && std::abs(last.turn_rate) > 0.02) {
      ++num_swings;
    }
    largest_step =
        std::max(largest_step, last.forward - state.velocity.forward);
    if (report.state == TrackState::kDriving && last.forward > 0.05) {
      worst_offset = std::max(worst_offset, std::abs(report.cross_track));
    }
    commands.push_back(limit(last));
    if (commands.size() > 1 + static_cast<std::size_t>(command_delay)) {
      commands.pop_front();
    }
    state = Advance(state, commands.front(), DriveRates{}, 0.05);
    t += 0.05;
  }

  PathTracker tracker;
  DriveState state;
  double t = 0.0;
  int pose_delay = 1;     // Steps.
  int command_delay = 1;  // Steps.
  double sigma = 0.0;
  double sigma_heading = 0.0;
  std::function<Velocity(const Velocity&)> limit = [](const Velocity& v) {
    return v;
  };
  Random random{7};

  TrackReport report;
  Velocity last;
  int num_swings = 0;
  double largest_step = 0.0;
  double worst_offset = 0.0;

 private:
  std::deque<Pose2> late;
  std::deque<Velocity> commands;
};

TEST(PathTracker, DrivesStraightToTheGoalAndSwingsNowhere) {
  Loop loop;
  loop.tracker.Start({{{3.0, 0.0}, {}}}, 0.0);
  loop.Run(30.0);
  EXPECT_EQ(loop.report.state, TrackState::kDone);
  EXPECT_EQ(loop.report.num_reached, 1);
  EXPECT_EQ(loop.report.distance_left, 0.0);
  EXPECT_NEAR(loop.state.pose.x, 3.0, 0.05);
  EXPECT_NEAR(loop.state.pose.y, 0.0, 1e-9);
  EXPECT_EQ(loop.num_swings, 0);
  // 3 m at 0.4 m/s, both ramps, and the slow end.
  EXPECT_LT(loop.t, 13.0);
  EXPECT_TRUE(loop.report.velocity.is_zero());
}

// What was reported before there was a pose leaves no trace in the motion.
TEST(PathTracker, WaitingForTheFirstPoseChangesNothing) {
  PathTracker alone{PathTrackerOptions{}};
  PathTracker waited{PathTrackerOptions{}};
  alone.Start({{{3.0, 0.0}, {}}}, 0.0);
  waited.Start({{{3.0, 0.0}, {}}}, 0.0);
  EXPECT_EQ(waited.Hold(std::nullopt, "no pose yet").state,
            TrackState::kWaiting);
  for (const double s : {0.0, 0.1, 0.2}) {
    const Velocity a = alone.Update(At(s), Pose2{}).velocity;
    const Velocity b = waited.Update(At(s), Pose2{}).velocity;
    EXPECT_EQ(a.forward, b.forward) << s;
    EXPECT_EQ(a.turn_rate, b.turn_rate) << s;
  }
}

TEST(PathTracker, TurnsOnTheSpotFirstWhereItIsBadlyAligned) {
  for (const double heading : {kPi, 3.0, -3.0, 2.0, -1.6, 1.2}) {
    Loop loop;
    loop.state.pose.heading = heading;
    loop.tracker.Start({{{2.0, 0.0}, {}}}, 0.0);
    bool has_driven = false;
    while (loop.tracker_is_running() && loop.t < 40.0) {
      loop.Step();
      if (loop.last.forward > 0.0) has_driven = true;
      if (!has_driven) {
        EXPECT_LT(loop.state.pose.position().norm(), 0.01) << heading;
      }
    }
    EXPECT_EQ(loop.report.state, TrackState::kDone) << heading;
    EXPECT_LT(loop.worst_offset, 0.03) << heading;
    EXPECT_LE(loop.num_swings, 2) << heading;
  }
}

TEST(PathTracker, StopsAtSharpCornersAndTurnsToHeadings) {
  Loop loop;
  loop.tracker.Start({{{2.0, 0.0}, {}},
                      {{2.0, 2.0}, kPi},
                      {{1.0, 2.0}, {}},
                      {{1.0, 0.5}, 0.0}},
                     0.0);
  bool has_looked = false;
  while (loop.tracker_is_running() && loop.t < 80.0) {
    loop.Step();
    if (loop.report.num_reached == 2 && !has_looked) {
      has_looked = true;
      EXPECT_NEAR(std::abs(loop.state.pose.heading), kPi, 0.1);
      EXPECT_LT((loop.state.pose.position() - Eigen::Vector2d(2, 2)).norm(),
                0.07);
    }
  }
  EXPECT_TRUE(has_looked);
  EXPECT_EQ(loop.report.state, TrackState::kDone);
  EXPECT_EQ(loop.report.num_reached, 4);
  EXPECT_LT((loop.state.pose.position() - Eigen::Vector2d(1, 0.5)).norm(),
            0.06);
  EXPECT_NEAR(loop.state.pose.heading, 0.0, 0.06);
  EXPECT_LT(loop.worst_offset, 0.06);
}

TEST(PathTracker, DrivesThroughShallowCornersWithoutStopping) {
  Loop loop;
  loop.tracker.Start({{{1.5, 0.0}, {}}, {{3.0, 0.6}, {}}, {{4.5, 0.6}, {}}},
                     0.0);
  double slowest = 1.0;
  while (loop.tracker_is_running() && loop.t < 40.0) {
    loop.Step();
    if (loop.state.pose.x > 0.6 && loop.state.pose.x < 4.0) {
      slowest = std::min(slowest, loop.last.forward);
    }
  }
  EXPECT_EQ(loop.report.state, TrackState::kDone);
  EXPECT_GT(slowest, 0.15);
  EXPECT_LT(loop.worst_offset, 0.06);
  EXPECT_EQ(loop.report.num_reached, 3);
}

TEST(PathTracker, KeepsItsOwnAccelerationAndSpeed) {
  Loop loop;
  loop.pose_delay = loop.command_delay = 0;
  loop.tracker.Start({{{3.0, 0.0}, {}}}, 0.25);
  double fastest = 0.0;
  while (loop.tracker_is_running() && loop.t < 40.0) {
    loop.Step();
    fastest = std::max(fastest, loop.last.forward);
  }
  EXPECT_NEAR(fastest, 0.25, 1e-9);
  EXPECT_LE(loop.largest_step, 0.4 * 0.05 + 1e-9);
}

TEST(PathTracker, ReturnsToTheWayFromBeside) {
  Loop loop;
  loop.tracker.Start({{{5.0, 0.0}, {}}}, 0.0);
  loop.Step();
  loop.state.pose.y = 0.6;  // Pushed.
  loop.Run(40.0);
  EXPECT_EQ(loop.report.state, TrackState::kDone);
  EXPECT_LT((loop.state.pose.position() - Eigen::Vector2d(5, 0)).norm(), 0.06);
  EXPECT_LE(loop.num_swings, 4);
}

TEST(PathTracker, ReportsABlockedWayAndGoesOnWhenFree) {
  Loop loop;
  loop.tracker.Start({{{3.0, 0.0}, {}}}, 0.0);
  loop.Run(4.0);
  EXPECT_EQ(loop.report.state, TrackState::kDriving);
  loop.limit = [](const Velocity&) { return Velocity{}; };
  loop.Run(4.5);
  EXPECT_EQ(loop.report.state, TrackState::kDriving);
  loop.Run(2.0);
  EXPECT_EQ(loop.report.state, TrackState::kWaiting);
  EXPECT_THAT(loop.report.reason, HasSubstr("no progress for"));
  EXPECT_GT(loop.report.velocity.forward, 0.0) << "it goes on asking";
  loop.limit = [](const Velocity& v) { return v; };
  loop.Run(1.0);
  EXPECT_EQ(loop.report.state, TrackState::kDriving);
  EXPECT_EQ(loop.report.reason, "");
  loop.Run(30.0);
  EXPECT_EQ(loop.report.state, TrackState::kDone);
}

TEST(PathTracker, WaitsAlsoWhereOnlyTurningIsAllowed) {
  Loop loop;
  loop.state.pose.heading = 0.2;
  loop.tracker.Start({{{3.0, 0.0}, {}}}, 0.0);
  loop.limit = [](const Velocity& v) { return Velocity{0.0, v.turn_rate}; };
  loop.Run(20.0);
  EXPECT_EQ(loop.report.state, TrackState::kWaiting);
}

TEST(PathTracker, StandsWhereThePoseIsUnknownAndGoesOn) {
  Loop loop;
  loop.tracker.Start({{{2.0, 0.0}, {}}}, 0.0);
  loop.Run(3.0);
  const TrackReport held = loop.tracker.Hold(At(loop.t), "no pose");
  EXPECT_TRUE(held.velocity.is_zero());
  EXPECT_EQ(held.state, TrackState::kWaiting);
  EXPECT_EQ(held.reason, "no pose");
  loop.Step();
  EXPECT_LT(loop.last.forward, 0.05) << "from rest";
  loop.Run(20.0);
  EXPECT_EQ(loop.report.state, TrackState::kDone);
}

TEST(PathTracker, IdleDoneAndClearedStand) {
  PathTracker tracker({});
  EXPECT_EQ(tracker.Update(At(0), {}).state, TrackState::kIdle);
  EXPECT_EQ(tracker.Hold(At(0), "x").state, TrackState::kIdle);
  tracker.Start({{{2.0, 0.0}, {}}}, 0.0, 1);
  EXPECT_EQ(tracker.Update(At(0), {}).state, TrackState::kDone)
      << "all reached";
  tracker.Start({{{0.0, 0.0}, {}}}, 0.0);
  EXPECT_EQ(tracker.Update(At(0.1), {}).state, TrackState::kDone) << "is there";
  tracker.Start({{{2.0, 0.0}, {}}}, 0.0);
  EXPECT_EQ(tracker.Update(At(0.2), {}).state, TrackState::kDriving);
  EXPECT_GT(tracker.Update(At(0.3), {}).velocity.forward, 0.0);
  tracker.Clear();
  const TrackReport report = tracker.Update(At(0.4), {});
  EXPECT_EQ(report.state, TrackState::kIdle);
  EXPECT_TRUE(report.velocity.is_zero());
}

TEST(PathTracker, GoesOnFromTheWayPointsThatAreReached) {
  Loop loop;
  loop.state.pose.x = 1.0;
  loop.tracker.Start({{{-5.0, 0.0}, {}}, {{2.0, 0.0}, {}}}, 0.0, 1);
  loop.Run(20.0);
  EXPECT_EQ(loop.report.state, TrackState::kDone);
  EXPECT_NEAR(loop.state.pose.x, 2.0, 0.05);
  EXPECT_EQ(loop.report.num_reached, 2);
}

TEST(PathTracker, FailsWhereItMissesAWayPointAgainAndAgain) {
  Loop loop;
  // Where it believes to be jumps aside at the end of each attempt.
  loop.tracker.Start({{{1.0, 0.0}, {}}}, 0.0);
  while (loop.tracker_is_running() && loop.t < 300.0) {
    loop.Step();
    if ((loop.state.pose.position() - Eigen::Vector2d(1, 0)).norm() < 0.1) {
      loop.state.pose.y += 0.3;
    }
  }
  EXPECT_NE(loop.report.state, TrackState::kDone);
}

TEST(PathTracker, TimeThatJumpsIsNoTime) {
  PathTracker tracker({});
  tracker.Start({{{2.0, 0.0}, {}}}, 0.0);
  EXPECT_EQ(tracker.Update(At(0), {}).velocity.forward, 0.0);
  EXPECT_EQ(tracker.Update(At(1000), {}).velocity.forward, 0.0);
  EXPECT_EQ(tracker.Update(At(3), {}).velocity.forward, 0.0);
  EXPECT_NEAR(tracker.Update(At(3.1), {}).velocity.forward, 0.04, 1e-9);
}

TEST(PathTracker, RefusesOptionsThatMakeNoSense) {
  PathTrackerOptions options;
  options.lookahead = 0.0;
  EXPECT_THROW(PathTracker{options}, std::invalid_argument);
  options = {};
  options.align_start = 2.0;
  EXPECT_THROW(PathTracker{options}, std::invalid_argument);
}

// Any polyline, with late and noisy poses: the goal, its heading, and near the
// way in between.
TEST(PathTracker, ReachesTheGoalOfRandomPolylines) {
  constexpr int kPaths = 1000;
  double worst_goal = 0.0;
  double worst_heading = 0.0;
  double worst_offset = 0.0;
  double swings = 0.0;
  for (int seed = 0; seed < kPaths; ++seed) {
    Loop loop;
    loop.random = Random(static_cast<std::uint64_t>(seed) + 31);
    Random& random = loop.random;
    loop.pose_delay = static_cast<int>(random.Index(3));
    loop.command_delay = static_cast<int>(random.Index(3));
    const bool is_noisy = seed % 2 == 1;
    if (is_noisy) {
      loop.sigma = 0.01;
      loop.sigma_heading = 0.01;
    }
    loop.state.pose.heading = random.Uniform(-kPi, kPi);
    std::vector<Waypoint> path;
    Eigen::Vector2d p(0, 0);
    const int num = 1 + static_cast<int>(random.Index(5));
    double length = 0.0;
    for (int i = 0; i < num; ++i) {
      const double way = random.Uniform(0.1, 2.0);
      const double a = random.Uniform(-kPi, kPi);
      p += way * Eigen::Vector2d(std::cos(a), std::sin(a));
      length += way;
      path.push_back({p, {}});
      if (random.Uniform() < 0.3) path[i].heading = random.Uniform(-kPi, kPi);
    }
    path.back().heading = random.Uniform(-kPi, kPi);
    loop.tracker.Start(path, 0.0);
    loop.Run(30.0 + 20.0 * num + 10.0 * length);
    ASSERT_EQ(loop.report.state, TrackState::kDone)
        << "seed " << seed << ": " << loop.report.reason;
    ASSERT_EQ(loop.report.num_reached, num);
    for (int i = 0; i < 20; ++i) loop.Step();  // Comes to rest.
    const double goal = (loop.state.pose.position() - p).norm();
    const double heading =
        std::abs(WrapAngle(loop.state.pose.heading - *path.back().heading));
    worst_goal = std::max(worst_goal, goal);
    worst_heading = std::max(worst_heading, heading);
    worst_offset = std::max(worst_offset, loop.worst_offset);
    if (!is_noisy) swings += loop.num_swings;
    // The tolerances, three sigma of what the poses lacked, and the way of one
    // delay at creeping speed.
    EXPECT_LT(goal, 0.05 + (is_noisy ? 0.03 : 0.0) + 0.015) << "seed " << seed;
    EXPECT_LT(heading, 0.035 + (is_noisy ? 0.03 : 0.0) + 0.03)
        << "seed " << seed;
    EXPECT_LT(loop.worst_offset, 0.15) << "seed " << seed;
  }
  std::printf(
      "worst goal %.3f m, heading %.3f rad, offset %.3f m, %.2f swings\n",
      worst_goal,
      worst_heading,
      worst_offset,
      swings / (kPaths / 2));
}

}  // namespace
}  // namespace waymark
