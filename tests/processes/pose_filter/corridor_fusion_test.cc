// What corridor_tracker says, fused by pose_filter.
#include "estimation/geometry/angle.h"
#include "processes/convert/corridor_convert.h"
#include "processes/pose_filter/pose_filter_process.h"
#include "processes/support/channels.h"
#include "tests/processes/pose_filter/pose_filter_world.h"

#include <waymark/corridor_pose_t.hpp>
#include <waymark/pose_t.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace waymark {
namespace {

// Askew in the world, and seen by a camera that looks aside.
const Pose2 kX_WL{0.4, -0.3, 0.6};
const Pose2 kX_RS{0.1, 0.02, 0.05};

// Its start is wrong by this.
constexpr double kStartY = 0.15;

PoseFilterConfig WrongStart(const OdometryScene& scene) {
  PoseFilterConfig config = Config();
  const Pose2& X_WR = scene.truth.front();
  config.start_position = {X_WR.x, X_WR.y + kStartY};
  config.start_heading = X_WR.heading + 0.05;
  config.start_position_sigma = 0.2;
  config.start_heading_sigma = 0.1;
  return config;
}

corridor_pose_t AnswerAt(const OdometryScene& scene, std::size_t i) {
  const Pose2 X_LR = Between(kX_WL, scene.truth[i]);
  CorridorAnswer answer;
  answer.time = scene.readings[i].time;
  answer.seq = static_cast<std::int64_t>(i);
  answer.source = "FRONT";
  answer.X_RS = kX_RS;
  answer.corridor.emplace();
  answer.corridor->name = "corridor";
  answer.corridor->width = 2.0;
  answer.corridor->X_WL = kX_WL;
  answer.estimate.status = CorridorStatus::kAccepted;
  answer.estimate.y = X_LR.y;
  answer.estimate.heading = X_LR.heading;
  answer.estimate.covariance = Eigen::Vector2d(1e-4, 4e-6).asDiagonal();
  answer.estimate.p_regular = 1.0;
  return ToMessage(answer);
}

void PublishAnswers(const OdometryScene& scene, double delay_s, World* world) {
  for (std::size_t i = 0; i < scene.readings.size(); i += 2) {
    world->bus.PublishAt(scene.readings[i].time + DurationFromSeconds(delay_s),
                         kCorridorPose,
                         AnswerAt(scene, i));
  }
}

OdometryScene SceneWithoutFixes() {
  OdometryScene scene = Scene(10);
  scene.fixes.clear();
  return scene;
}

TEST(CorridorFusion, LateralPositionAndHeadingComeRight) {
  const OdometryScene scene = SceneWithoutFixes();
  World world(WrongStart(scene));
  world.Publish(scene);
  PublishAnswers(scene, 0.0, &world);
  world.Run();
  const auto poses = world.Messages<pose_t>(kPose);
  ASSERT_FALSE(poses.empty());
  const pose_t& last = poses.back();
  const Pose2 believed{last.pose_W[0], last.pose_W[1], last.pose_W[2]};
  const Pose2 X_LR = Between(kX_WL, scene.truth.back());
  const Pose2 believed_LR = Between(kX_WL, believed);
  EXPECT_NEAR(believed_LR.y, X_LR.y, 0.01);
  EXPECT_NEAR(WrapAngle(believed_LR.heading - X_LR.heading), 0.0, 0.005);
  // Along the corridor nothing was measured: a part of the start's error stays.
  EXPECT_GT(std::abs(believed_LR.x - X_LR.x), 0.02);
  EXPECT_GT(last.num_accepted, 80);
  EXPECT_EQ(StatusOf(world.bus).num_bad, 0);
}

TEST(CorridorFusion, LateAnswersAreFusedAtTheirImagesTime) {
  const OdometryScene scene = SceneWithoutFixes();
  World in_time(WrongStart(scene));
  World late(WrongStart(scene));
  for (World* world : {&in_time, &late}) {
    world->Publish(scene);
    PublishAnswers(scene, world == &late ? 0.7 : 0.0, world);
    world->Run();
  }
  EXPECT_EQ(Bytes(in_time, kPoseSettled), Bytes(late, kPoseSettled));
  EXPECT_NE(Bytes(in_time, kPose), Bytes(late, kPose));
}

TEST(CorridorFusion, AnswersWithoutAHeadingAreNoMeasurement) {
  const OdometryScene scene = SceneWithoutFixes();
  World world(WrongStart(scene));
  world.Publish(scene);
  for (std::size_t i = 0; i < scene.readings.size(); i += 2) {
    CorridorAnswer answer;
    answer.time = scene.readings[i].time;
    answer.source = "FRONT";
    answer.estimate.status = CorridorStatus::kNoLines;
    answer.estimate.reason = "no lines in the image";
    world.bus.PublishAt(answer.time, kCorridorPose, ToMessage(answer));
  }
  world.Run();
  EXPECT_EQ(world.Messages<pose_t>(kPose).back().num_accepted, 0);
  EXPECT_EQ(StatusOf(world.bus).num_bad, 0);
}

}  // namespace
}  // namespace waymark
