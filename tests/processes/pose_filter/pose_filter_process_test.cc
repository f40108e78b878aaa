#include "processes/pose_filter/pose_filter_process.h"

#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"
#include "tests/processes/pose_filter/pose_filter_world.h"

#include <waymark/bot_pose_t.hpp>
#include <waymark/pose_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(PoseFilterProcess, PublishesEverythingPerReading) {
  const OdometryScene scene = Scene();
  World world(Config());
  world.Publish(scene);
  world.Run();
  const auto poses = world.Messages<pose_t>(kPose);
  const auto settled = world.Messages<pose_t>(kPoseSettled);
  ASSERT_EQ(poses.size(), scene.readings.size());
  ASSERT_EQ(settled.size(), scene.readings.size());
  EXPECT_EQ(world.Messages<pose_t>(kOdometry).size(), scene.readings.size());
  EXPECT_EQ(world.Messages<bot_pose_t>(kPoseBot).size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].utime, Microseconds(scene.readings[i].time));
    EXPECT_EQ(settled[i].utime, poses[i].utime);
    EXPECT_EQ(poses[i].seq, static_cast<int>(i));
    ASSERT_TRUE(poses[i].is_known) << poses[i].reason;
    EXPECT_LT(std::hypot(settled[i].pose_W[0] - scene.truth[i].x,
                         settled[i].pose_W[1] - scene.truth[i].y),
              0.1);
  }
  EXPECT_EQ(settled.back().num_accepted, static_cast<int>(scene.fixes.size()));
  // Once a second of the settled time.
  const auto parameters =
      world.Messages<odometry_parameters_t>(kOdometryParameters);
  ASSERT_EQ(parameters.size(), 21u);
  EXPECT_EQ(parameters.back().source, "online");
  EXPECT_GT(parameters.back().observability[2], 0.1);
  EXPECT_EQ(StatusOf(world.bus).num_bad, 0);
  EXPECT_EQ(StatusOf(world.bus).fault, "");
}

TEST(PoseFilterProcess, SettledBytesDoNotDependOnArrival) {
  const OdometryScene scene = Scene();
  World in_order(Config());
  in_order.Publish(scene);
  in_order.Run();
  World late(Config());
  late.Publish(scene, 1.9);
  late.Run();
  EXPECT_EQ(Bytes(in_order, kPoseSettled), Bytes(late, kPoseSettled));
  EXPECT_EQ(Bytes(in_order, kOdometryParameters),
            Bytes(late, kOdometryParameters));
  EXPECT_NE(Bytes(in_order, kPose), Bytes(late, kPose));
}

TEST(PoseFilterProcess, TooLateIsCountedAndNothingElseIsLost) {
  const OdometryScene scene = Scene();
  World world(Config());
  world.Publish(scene, 3.0);
  world.Run();
  EXPECT_GT(BadOf(world.bus, kPositionFix), 30);
  EXPECT_EQ(world.Messages<pose_t>(kPoseSettled).size(), scene.readings.size());
}

TEST(PoseFilterProcess, ParametersAndStartFromTheLog) {
  const OdometryScene scene = Scene();
  PoseFilterConfig config;
  World world(config);
  OdometryParameters nominal;
  nominal.time = scene.readings[0].time;
  nominal.source = "nominal";
  nominal.parameters = {1e-4, 1e-4, 0.27};
  world.bus.Publish(kOdometryParameters, ToMessage(nominal, 0));
  InitialPose start;
  start.time = scene.readings[0].time;
  start.source = "log";
  world.bus.Publish(kInitialPose, ToMessage(start));
  world.Publish(scene);
  world.Run();
  const auto settled = world.Messages<pose_t>(kPoseSettled);
  ASSERT_EQ(settled.size(), scene.readings.size());
  for (const pose_t& pose : settled) EXPECT_TRUE(pose.is_known) << pose.reason;
}

TEST(PoseFilterProcess, SaysWhyThereIsNoPose) {
  const OdometryScene scene = Scene(4);
  {
    World world(PoseFilterConfig{});
    world.Publish(scene);
    world.Run();
    for (const pose_t& pose : world.Messages<pose_t>(kPose)) {
      EXPECT_FALSE(pose.is_known);
      EXPECT_THAT(pose.reason, HasSubstr("no wheel parameters"));
      EXPECT_EQ(pose.pose_W[0], 0);
    }
    EXPECT_TRUE(world.Messages<bot_pose_t>(kPoseBot).empty());
  }
  World world(Config());
  world.bus.Publish(kPositionFix, ToMessage(scene.fixes[0]));
  world.bus.Run();
  ASSERT_EQ(world.Messages<pose_t>(kPose).size(), 1u);
  EXPECT_THAT(world.Messages<pose_t>(kPose)[0].reason,
              HasSubstr("no encoder readings"));
}

TEST(PoseFilterProcess, BadMessagesAreCountedAndTheRestIsFused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const OdometryScene scene = Scene();
  World world(Config());
  world.Publish(scene);
  position_fix_t fix = ToMessage(scene.fixes[3]);
  fix.seq = 1000;
  fix.x = nan;
  world.bus.Publish(kPositionFix, fix);
  fix = ToMessage(scene.fixes[3]);
  fix.seq = 1001;
  fix.covariance[0] = -1;
  world.bus.Publish(kPositionFix, fix);
  encoders_t encoders = ToMessage(scene.readings[50], 0, false);
  encoders.seq = 1002;
  encoders.counter_bits = 3;
  world.bus.Publish(kEncoders, encoders);
  initial_pose_t start{};
  start.utime = encoders.utime;
  start.pose_W[2] = nan;
  world.bus.Publish(kInitialPose, start);
  odometry_parameters_t parameters{};
  parameters.utime = encoders.utime;
  parameters.source = "nominal";
  parameters.is_known = 1;
  world.bus.Publish(kOdometryParameters, parameters);
  // Time going backwards, by an hour, once.
  encoders = ToMessage(scene.readings[60], 0, false);
  encoders.utime -= 3'600'000'000;
  world.bus.PublishAt(scene.readings[60].time, kEncoders, encoders);
  // Another type, and half a message.
  const pose_t other{};
  world.bus.PublishAt(scene.readings[70].time, kEncoders, other);
  world.bus.PublishBytesAt(
      scene.readings[71].time, kPositionFix, {1, 2, 3, 4, 5});
  world.Run();
  EXPECT_EQ(BadOf(world.bus, kPositionFix), 3);
  EXPECT_EQ(BadOf(world.bus, kEncoders), 3);
  EXPECT_EQ(BadOf(world.bus, kInitialPose), 1);
  EXPECT_EQ(BadOf(world.bus, kOdometryParameters), 1);
  const auto settled = world.Messages<pose_t>(kPoseSettled);
  ASSERT_EQ(settled.size(), scene.readings.size());
  EXPECT_EQ(settled.back().num_accepted, static_cast<int>(scene.fixes.size()));
  EXPECT_TRUE(settled.back().is_known);
}

TEST(PoseFilterProcess, EncoderJumpIsAFaultWhileItLasts) {
  OdometryScene scene = Scene();
  scene.readings[100].left += 50'000'000;
  World world(Config());
  world.Publish(scene);
  std::string fault_then;
  world.bus.CallAt(scene.readings[100].time + Duration(1000),
                   [&] { fault_then = StatusOf(world.bus).fault; });
  world.Run();
  EXPECT_THAT(fault_then, HasSubstr("encoder jump: left wheel"));
  EXPECT_EQ(StatusOf(world.bus).fault, "");
  EXPECT_EQ(BadOf(world.bus, kEncoders), 1);
  const auto poses = world.Messages<pose_t>(kPose);
  EXPECT_FALSE(poses[100].is_known);
  EXPECT_THAT(poses[100].reason, HasSubstr("encoder jump"));
  EXPECT_TRUE(poses[101].is_known);
}

TEST(PoseFilterProcess, SixteenBitCountersWrap) {
  const OdometryScene scene = Scene();
  World plain(Config());
  plain.Publish(scene);
  plain.Run();
  World wrapped(Config());
  for (EncoderReading reading : scene.readings) {
    reading.right &= 0xffff;
    reading.left &= 0xffff;
    wrapped.bus.Publish(kEncoders, ToMessage(reading, 16, false));
  }
  for (const AbsoluteFix& fix : scene.fixes) {
    wrapped.bus.Publish(kPositionFix, ToMessage(fix));
  }
  wrapped.Run();
  EXPECT_GT(scene.readings.back().right, 65536);
  EXPECT_EQ(Bytes(plain, kPoseSettled), Bytes(wrapped, kPoseSettled));
}

PoseFilterConfig BatchConfig() {
  PoseFilterConfig config = Config();
  config.use = ParameterUse::kBatch;
  return config;
}

// As batch_refiner sends them: both wheels `scale` times their true size.
OdometryParameters BatchParameters(Time time, double scale) {
  OdometryParameters batch;
  batch.time = time;
  batch.source = "batch";
  batch.parameters = {scale * 1e-4, scale * 1e-4, 0.27};
  batch.covariance = Eigen::Vector3d(1e-14, 1e-14, 1e-8).asDiagonal();
  return batch;
}

TEST(PoseFilterProcess, BatchParametersTakeEffectOneWindowLater) {
  const OdometryScene scene = Scene();
  const OdometryParameters batch =
      BatchParameters(scene.readings[100].time, 1.02);
  std::vector<std::vector<std::uint8_t>> first;
  for (const double delay_s : {0.1, 1.7}) {
    World world(BatchConfig());
    world.Publish(scene);
    world.bus.PublishAt(batch.time + DurationFromSeconds(delay_s),
                        kOdometryParameters,
                        ToMessage(batch, 0));
    world.Run();
    // Speed by the parameters in force: two seconds are forty readings.
    const auto settled = world.Messages<pose_t>(kPoseSettled);
    EXPECT_NEAR(settled[139].velocity_R[0], 0.4, 0.003);
    EXPECT_NEAR(settled[142].velocity_R[0], 0.408, 0.003);
    if (first.empty()) first = Bytes(world, kPoseSettled);
    EXPECT_EQ(Bytes(world, kPoseSettled), first);
    // Nothing is estimated online, so nothing is said.
    EXPECT_EQ(world.Messages<odometry_parameters_t>(kOdometryParameters).size(),
              1u);
  }
}

// Wheels that are 4 % off, and no fix at all.
TEST(PoseFilterProcess, RelativeMotionsTeachTheWheels) {
  const OdometryScene scene = Scene(60);
  PoseFilterConfig config = Config();
  config.nominal = {1.04e-4, 1e-4, 0.26};
  const Pose2 X_RS{0.1, 0.0, 0.5};
  std::vector<relative_motion_t> motions;
  for (std::size_t i = 8; i < scene.readings.size(); i += 8) {
    RelativeMotion motion;
    motion.source = "scan";
    motion.seq = static_cast<std::int64_t>(motions.size());
    motion.from = scene.readings[i - 8].time;
    motion.time = scene.readings[i].time;
    motion.X_RS = X_RS;
    motion.X_S0S1 = Between(scene.truth[i - 8] * X_RS, scene.truth[i] * X_RS);
    motion.covariance = Eigen::Vector3d(1e-6, 1e-6, 4e-6).asDiagonal();
    motions.push_back(ToMessage(motion));
  }
  std::vector<std::vector<std::uint8_t>> first;
  for (const double delay_s : {0.0, 1.5}) {
    World world(config);
    for (const EncoderReading& reading : scene.readings) {
      world.bus.Publish(kEncoders, ToMessage(reading, 0, false));
    }
    for (const relative_motion_t& motion : motions) {
      world.bus.PublishAt(
          TimeFromMicroseconds(motion.utime) + DurationFromSeconds(delay_s),
          kRelativeMotion,
          motion);
    }
    // Too long for the window, and no motion at all.
    relative_motion_t bad = motions[100];
    bad.seq = 1000;
    bad.utime_from = bad.utime - 2'100'000;
    world.bus.Publish(kRelativeMotion, bad);
    bad.utime_from = bad.utime;
    world.bus.Publish(kRelativeMotion, bad);
    world.Run();
    EXPECT_EQ(BadOf(world.bus, kRelativeMotion), 2);
    const auto settled = world.Messages<pose_t>(kPoseSettled);
    EXPECT_EQ(settled.back().num_accepted, static_cast<int>(motions.size()));
    EXPECT_LT(std::hypot(settled.back().pose_W[0] - scene.truth.back().x,
                         settled.back().pose_W[1] - scene.truth.back().y),
              0.3);
    const auto learned =
        world.Messages<odometry_parameters_t>(kOdometryParameters).back();
    EXPECT_NEAR(learned.k_right, 1e-4, 4.0 * std::sqrt(learned.covariance[0]));
    EXPECT_NEAR(
        learned.wheel_base, 0.27, 4.0 * std::sqrt(learned.covariance[8]));
    EXPECT_GT(learned.observability[0], 0.8);
    if (first.empty()) first = Bytes(world, kPoseSettled);
    EXPECT_EQ(Bytes(world, kPoseSettled), first);
  }
}

// What batch_refiner says while it has no answer yet.
TEST(PoseFilterProcess, BatchThatHasNoAnswerIsNotAdopted) {
  const OdometryScene scene = Scene();
  OdometryParameters none = BatchParameters(scene.readings[100].time, 2.0);
  none.is_known = false;
  none.reason = "the wheels travelled 0 m, less than 0.2 m";
  World plain(BatchConfig());
  plain.Publish(scene);
  plain.Run();
  World world(BatchConfig());
  world.Publish(scene);
  world.bus.Publish(kOdometryParameters, ToMessage(none, 0));
  world.Run();
  EXPECT_EQ(Bytes(world, kPoseSettled), Bytes(plain, kPoseSettled));
  EXPECT_EQ(StatusOf(world.bus).num_bad, 0);
}

TEST(PoseFilterProcess, SaysWhyThereAreNoParametersUntilThereAre) {
  const OdometryScene scene = Scene();
  World world(PoseFilterConfig{});
  world.Publish(scene);
  OdometryParameters nominal;
  nominal.time = scene.readings[50].time;
  nominal.source = "nominal";
  nominal.parameters = {1e-4, 1e-4, 0.27};
  world.bus.Publish(kOdometryParameters, ToMessage(nominal, 0));
  world.Run();
  std::vector<odometry_parameters_t> online;
  for (const auto& m :
       world.Messages<odometry_parameters_t>(kOdometryParameters)) {
    if (m.source == "online") online.push_back(m);
  }
  // At 0, 1 and 2 s, and at once when they are there: at 2.5 s.
  ASSERT_GT(online.size(), 4u);
  for (std::size_t i = 0; i < online.size(); ++i) {
    EXPECT_EQ(online[i].seq, static_cast<int>(i));
    EXPECT_EQ(online[i].is_known, i < 3 ? 0 : 1);
    EXPECT_EQ(
        online[i].reason,
        i < 3 ? "no wheel parameters: none configured, none received" : "");
  }
  EXPECT_EQ(online[0].wheel_base, 0.0);
  EXPECT_EQ(online[3].utime, Microseconds(nominal.time));
  EXPECT_EQ(online[3].wheel_base, 0.27);
}

}  // namespace
}  // namespace waymark
