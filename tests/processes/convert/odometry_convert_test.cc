#include "processes/convert/odometry_convert.h"

#include "estimation/geometry/angle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Eigen::Matrix3d Covariance() {
  Eigen::Matrix3d P;
  P << 4e-4, 1e-4, 0, 1e-4, 9e-4, 2e-5, 0, 2e-5, 1e-4;
  return P;
}

AbsoluteFix Fix() {
  AbsoluteFix fix;
  fix.time = TimeFromMicroseconds(5'000'000);
  fix.seq = 7;
  fix.source = "camera";
  fix.has = {true, true, true};
  fix.value = {1, -2, 3};
  fix.covariance = Covariance();
  fix.X_WF = {1, 2, 0.5};
  fix.X_RS = {0.1, 0, -0.2};
  return fix;
}

OdometryParameters Parameters() {
  OdometryParameters p;
  p.time = TimeFromMicroseconds(5);
  p.source = "batch";
  p.parameters = {1e-4, 1.1e-4, 0.3};
  p.covariance = 1e-6 * Covariance();
  p.observability = {0.1, 0.2, 0.3};
  p.num_measurements = 12;
  p.sensor = SensorCalibration{
      "laser", {0.1, 0.2, 0.3}, 0.01, Eigen::Matrix4d::Identity()};
  return p;
}

TEST(OdometryConvert, FixSurvivesTheRoundTrip) {
  std::string reason;
  for (int mask = 1; mask < 8; ++mask) {
    AbsoluteFix fix = Fix();
    for (int i = 0; i < 3; ++i) {
      fix.has[static_cast<std::size_t>(i)] = (mask >> i & 1) != 0;
    }
    const auto back = AbsoluteFixFromMessage(ToMessage(fix), &reason);
    ASSERT_TRUE(back) << reason;
    EXPECT_EQ(back->has, fix.has);
    EXPECT_EQ(back->time, fix.time);
    EXPECT_EQ(back->seq, fix.seq);
    EXPECT_EQ(back->source, fix.source);
    EXPECT_EQ(back->X_WF, fix.X_WF);
    EXPECT_EQ(back->X_RS, fix.X_RS);
    for (int i = 0; i < 3; ++i) {
      if (!fix.has[static_cast<std::size_t>(i)]) continue;
      EXPECT_EQ(back->value(i), fix.value(i));
      for (int j = 0; j < 3; ++j) {
        if (fix.has[static_cast<std::size_t>(j)]) {
          EXPECT_EQ(back->covariance(i, j), fix.covariance(i, j));
        }
      }
    }
  }
}

TEST(OdometryConvert, AbsentComponentsAreNotRead) {
  position_fix_t message = ToMessage(Fix());
  message.has_x = 0;
  message.x = kNan;
  message.covariance[0] = kNan;
  message.covariance[1] = kNan;
  message.covariance[3] = kInfinity;
  std::string reason;
  const auto fix = AbsoluteFixFromMessage(message, &reason);
  ASSERT_TRUE(fix) << reason;
  EXPECT_EQ(fix->covariance(0, 0), 0);
  EXPECT_EQ(fix->value(0), 0);
}

TEST(OdometryConvert, BadFixIsRefusedWithItsField) {
  struct Case {
    const char* expected;
    std::function<void(position_fix_t*)> spoil;
  };
  const std::vector<Case> cases = {
      {"x: nan", [](auto* m) { m->x = kNan; }},
      {"heading: inf", [](auto* m) { m->heading = kInfinity; }},
      {"y: 1e+300", [](auto* m) { m->y = 1e300; }},
      {"has_x", [](auto* m) { m->has_x = m->has_y = m->has_heading = 0; }},
      {"utime: 0", [](auto* m) { m->utime = 0; }},
      {"utime: -4", [](auto* m) { m->utime = -4; }},
      {"covariance", [](auto* m) { m->covariance[4] = kNan; }},
      {"variance 0", [](auto* m) { m->covariance[4] = 0; }},
      {"variance -1", [](auto* m) { m->covariance[8] = -1; }},
      {"symmetric", [](auto* m) { m->covariance[1] = 2e-4; }},
      {"positive definite",
       [](auto* m) { m->covariance[1] = m->covariance[3] = 1; }},
      {"frame_W: nan", [](auto* m) { m->frame_W[2] = kNan; }},
      {"sensor_R: -inf", [](auto* m) { m->sensor_R[0] = -kInfinity; }}};
  for (const Case& c : cases) {
    position_fix_t message = ToMessage(Fix());
    c.spoil(&message);
    std::string reason;
    EXPECT_FALSE(AbsoluteFixFromMessage(message, &reason)) << c.expected;
    EXPECT_THAT(reason, HasSubstr(c.expected));
  }
}

TEST(OdometryConvert, HeadingIsWrapped) {
  position_fix_t message = ToMessage(Fix());
  message.heading = 3 + 4 * kPi;
  std::string reason;
  EXPECT_NEAR(AbsoluteFixFromMessage(message, &reason)->value(2), 3, 1e-12);
}

TEST(OdometryConvert, EncodersAreChecked) {
  const EncoderReading reading{TimeFromMicroseconds(9), 3, -70000, 12};
  std::string reason;
  encoders_t message = ToMessage(reading, 16, true);
  EXPECT_EQ(message.counter_bits, 16);
  EXPECT_TRUE(message.is_virtual);
  const auto back = EncoderReadingFromMessage(message, &reason);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->left, 12);
  EXPECT_EQ(back->right, -70000);
  message.counter_bits = 7;
  EXPECT_FALSE(EncoderReadingFromMessage(message, &reason));
  EXPECT_THAT(reason, HasSubstr("counter_bits: 7"));
  message.counter_bits = 0;
  message.left_ticks = std::numeric_limits<std::int64_t>::min();
  EXPECT_FALSE(EncoderReadingFromMessage(message, &reason));
  EXPECT_THAT(reason, HasSubstr("ticks"));
}

TEST(OdometryConvert, RelativeMotionIsChecked) {
  RelativeMotion motion;
  motion.from = TimeFromMicroseconds(3);
  motion.time = TimeFromMicroseconds(8);
  motion.X_S0S1 = {1, 2, 3};
  motion.covariance = Covariance();
  std::string reason;
  const auto back = RelativeMotionFromMessage(ToMessage(motion), &reason);
  ASSERT_TRUE(back) << reason;
  EXPECT_EQ(back->from, motion.from);
  EXPECT_EQ(back->X_S0S1, motion.X_S0S1);
  EXPECT_EQ(back->covariance, motion.covariance);
  relative_motion_t message = ToMessage(motion);
  message.utime_from = message.utime;
  EXPECT_FALSE(RelativeMotionFromMessage(message, &reason));
  EXPECT_THAT(reason, HasSubstr("utime_from: 8"));
}

TEST(OdometryConvert, ExactInitialPoseIsAllowed) {
  InitialPose pose;
  pose.time = TimeFromMicroseconds(3);
  pose.X_WR = {1, 2, 3};
  std::string reason;
  ASSERT_TRUE(InitialPoseFromMessage(ToMessage(pose), &reason)) << reason;
  initial_pose_t message = ToMessage(pose);
  message.covariance[0] = -1e-3;
  EXPECT_FALSE(InitialPoseFromMessage(message, &reason));
  EXPECT_THAT(reason, HasSubstr("variance -0.001"));
}

TEST(OdometryConvert, ParametersSurviveTheRoundTrip) {
  std::string reason;
  const OdometryParameters p = Parameters();
  const auto back = OdometryParametersFromMessage(ToMessage(p, 4), &reason);
  ASSERT_TRUE(back) << reason;
  EXPECT_TRUE(back->is_known);
  EXPECT_EQ(back->reason, p.reason);
  EXPECT_EQ(back->parameters, p.parameters);
  EXPECT_EQ(back->covariance, p.covariance);
  EXPECT_EQ(back->observability, p.observability);
  EXPECT_EQ(back->num_measurements, 12);
  ASSERT_TRUE(back->sensor);
  EXPECT_EQ(back->sensor->X_RS, p.sensor->X_RS);
  EXPECT_EQ(back->sensor->covariance, p.sensor->covariance);
  odometry_parameters_t message = ToMessage(p, 4);
  message.wheel_base = 0;
  EXPECT_FALSE(OdometryParametersFromMessage(message, &reason));
  EXPECT_THAT(reason, HasSubstr("wheel_base: 0 must be positive"));
  // The smallest positive numbers made the dead-reckoned covariance infinite.
  message.wheel_base = 4e-315;
  EXPECT_FALSE(OdometryParametersFromMessage(message, &reason));
  EXPECT_THAT(reason, HasSubstr("must be >= 0.001"));
  // 'None, because ...' has no numbers to check.
  message.is_known = 0;
  message.reason = "stands still";
  const auto none = OdometryParametersFromMessage(message, &reason);
  ASSERT_TRUE(none) << reason;
  EXPECT_FALSE(none->is_known);
  EXPECT_EQ(none->reason, "stands still");
  EXPECT_EQ(none->source, p.source);
  message.utime = 0;
  EXPECT_FALSE(OdometryParametersFromMessage(message, &reason));
}

TEST(OdometryConvert, UnknownPoseCarriesItsReasonAndNoNumbers) {
  PoseEstimate estimate;
  estimate.reason = "no first pose";
  estimate.X_WR = {1, 2, 3};
  const pose_t message = ToMessage(estimate, 3);
  EXPECT_FALSE(message.is_known);
  EXPECT_EQ(message.reason, "no first pose");
  EXPECT_EQ(message.pose_W[0], 0);
}

TEST(OdometryConvert, BotPoseTurnsAboutZ) {
  PoseEstimate estimate;
  estimate.is_known = true;
  estimate.X_WR = {1, 2, kPi / 2};
  estimate.forward_speed = 2;
  const bot_pose_t message = ToBotMessage(estimate);
  EXPECT_NEAR(message.vel[0], 0, 1e-15);
  EXPECT_NEAR(message.vel[1], 2, 1e-15);
  EXPECT_NEAR(message.orientation[0], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(message.orientation[3], std::sqrt(0.5), 1e-15);
}

}  // namespace
}  // namespace waymark
