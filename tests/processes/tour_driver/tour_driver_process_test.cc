#include "processes/tour_driver/tour_driver_process.h"

#include "estimation/geometry/angle.h"
#include "planner/control/drive_model.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"

#include <waymark/task_status_t.hpp>
#include <waymark/task_t.hpp>

#include <gtest/gtest.h>

namespace waymark {
namespace {

constexpr std::int64_t kStart = 1'000'000'000;

truth_t Truth(double s, const Pose2& X_WR) {
  // The reference point is a marker behind and beside R.
  const Eigen::Vector2d p_RS(-0.1, 0.05);
  const Eigen::Vector2d p_WS = X_WR * p_RS;
  truth_t truth;
  truth.utime = kStart + static_cast<std::int64_t>(s * 1e6 + 0.5);
  truth.has_heading = 1;
  truth.x = p_WS.x();
  truth.y = p_WS.y();
  truth.heading = X_WR.heading;
  truth.sensor_R[0] = p_RS.x();
  truth.sensor_R[1] = p_RS.y();
  return truth;
}

TEST(TourDriverProcess, DrivesToursByTheTruth) {
  LocalBus world;
  TourDriverProcess process({}, world.AddProcess("tour_driver"));
  task_t task;
  task.utime = kStart;
  task.source = "test";
  task.kind = "waypoints";  // Not its own: it stays idle.
  task.num_waypoints = 1;
  task.waypoints.resize(1);
  task.waypoints[0].x = 1.5;
  task.waypoints[0].y = 1.0;
  world.Publish(kTask, task);
  world.Publish(kTruth, Truth(0.05, {}));
  world.RunUntil(TimeFromMicroseconds(kStart + 60'000));
  EXPECT_EQ(world.Messages<task_status_t>(kTaskStatus).back().state, "idle");
  task.kind = "tour";
  task.utime = kStart + 70'000;
  world.Publish(kTask, task);
  truth_t without = Truth(0.08, {});
  without.has_heading = 0;
  world.Publish(kTruth, without);
  world.RunUntil(TimeFromMicroseconds(kStart + 80'000));
  EXPECT_EQ(world.Messages<velocity_t>(kMotionRequest).back().reason,
            "TRUTH has no heading");
  DriveState state;
  state.pose.heading = -2.0;
  for (int i = 1; i < 400; ++i) {
    const truth_t truth = Truth(0.1 * i, state.pose);
    world.Publish(kTruth, truth);
    world.RunUntil(TimeFromMicroseconds(truth.utime));
    const velocity_t request =
        world.Messages<velocity_t>(kMotionRequest).back();
    EXPECT_EQ(request.source, "tour_driver");
    state =
        Advance(state, {request.forward, request.turn_rate}, DriveRates{}, 0.1);
  }
  EXPECT_EQ(world.Messages<task_status_t>(kTaskStatus).back().state, "done");
  EXPECT_LT((state.pose.position() - Eigen::Vector2d(1.5, 1.0)).norm(), 0.06);
}

}  // namespace
}  // namespace waymark
