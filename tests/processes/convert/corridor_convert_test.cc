#include "processes/convert/corridor_convert.h"

#include "estimation/filter/fix_model.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>

namespace waymark {
namespace {

CorridorAnswer Answer() {
  CorridorAnswer answer;
  answer.time = TimeFromMicroseconds(1'700'000'000'000'000);
  answer.seq = 7;
  answer.source = "FRONT";
  answer.X_RS = {0.12, -0.03, 0.2};
  CorridorGeometry& corridor = answer.corridor.emplace();
  corridor.name = "long one";
  corridor.width = 2.0;
  corridor.skirting_height = 0.08;
  corridor.skirting_depth = 0.012;
  corridor.X_WL = {5.0, -2.0, 0.7};
  answer.lines_took = std::chrono::microseconds(2100);
  answer.pose_took = std::chrono::microseconds(900);
  answer.estimate.status = CorridorStatus::kAccepted;
  answer.estimate.heading = -0.3;
  answer.estimate.y = 0.4;
  answer.estimate.covariance << 4e-4, -3e-5, -3e-5, 1e-4;
  answer.estimate.p_regular = 0.99;
  answer.estimate.vanishing_point = Eigen::Vector2d(300.5, 200.25);
  CorridorLine line;
  line.line.a = {1, 2};
  line.line.b = {3, 4};
  answer.estimate.lines.push_back(line);
  line.edge = CorridorEdge::kFloorRight;
  line.is_used = true;
  answer.estimate.lines.push_back(line);
  return answer;
}

// The robot's own pose satisfies the fix exactly, wherever along the axis.
TEST(CorridorConvert, FixIsWhereTheCameraIs) {
  const CorridorAnswer answer = Answer();
  std::string reason;
  const auto fix = CorridorFixFromMessage(ToMessage(answer), &reason);
  ASSERT_TRUE(fix) << reason;
  EXPECT_EQ(fix->source, "corridor FRONT");
  EXPECT_FALSE(fix->has[0]);
  for (const double x : {-3.0, 0.0, 11.0}) {
    const Pose2 X_LR{x, *answer.estimate.y, *answer.estimate.heading};
    const FixPrediction predicted =
        PredictFix(*fix, answer.corridor->X_WL * X_LR);
    ASSERT_EQ(predicted.residual.size(), 2);
    EXPECT_NEAR(predicted.residual.norm(), 0.0, 1e-12);
    // The other way round the mounting would leave some 6 cm.
    const FixPrediction turned =
        PredictFix(*fix, answer.corridor->X_WL * Pose2{x, 0.4, 0.3});
    EXPECT_GT(turned.residual.norm(), 0.1);
  }
}

// A shift of the robot's y or heading by one sigma is one sigma of the fix.
TEST(CorridorConvert, CovarianceFollowsTheMounting) {
  CorridorAnswer answer = Answer();
  std::string reason;
  const auto fix = CorridorFixFromMessage(ToMessage(answer), &reason);
  ASSERT_TRUE(fix) << reason;
  const Eigen::Vector2d shift(0.7e-3, -1.1e-3);
  const double expected =
      shift.dot(answer.estimate.covariance.inverse() * shift);
  answer.estimate.y = *answer.estimate.y + shift(0);
  answer.estimate.heading = *answer.estimate.heading + shift(1);
  const auto moved = CorridorFixFromMessage(ToMessage(answer), &reason);
  ASSERT_TRUE(moved) << reason;
  const Eigen::Vector2d d = (moved->value - fix->value).tail<2>();
  const Eigen::Matrix2d P = fix->covariance.bottomRightCorner<2, 2>();
  // Linear but for the lever arm's curvature, 0.12 m * (1e-3)^2.
  EXPECT_NEAR(d.dot(P.inverse() * d), expected, 1e-3 * expected);
}

TEST(CorridorConvert, HeadingAlone) {
  CorridorAnswer answer = Answer();
  answer.estimate.status = CorridorStatus::kUnknownSize;
  answer.estimate.y.reset();
  answer.estimate.covariance << 0, 0, 0, 1e-4;
  std::string reason;
  const auto fix = CorridorFixFromMessage(ToMessage(answer), &reason);
  ASSERT_TRUE(fix) << reason;
  EXPECT_FALSE(fix->has[1]);
  EXPECT_TRUE(fix->has[2]);
  EXPECT_NEAR(fix->value(2), -0.1, 1e-12);
  EXPECT_DOUBLE_EQ(fix->covariance(2, 2), 1e-4);
  EXPECT_EQ(fix->covariance(1, 1), 0.0);
}

TEST(CorridorConvert, NoneIsNoMeasurement) {
  CorridorAnswer answer = Answer();
  answer.estimate = CorridorEstimate();
  answer.estimate.reason = "no lines";
  const corridor_pose_t message = ToMessage(answer);
  EXPECT_EQ(message.status, "no_lines");
  std::string reason;
  const auto fix = CorridorFixFromMessage(message, &reason);
  ASSERT_TRUE(fix) << reason;
  EXPECT_FALSE(fix->has_any());
}

TEST(CorridorConvert, LinesAlongTheCorridorComeFirst) {
  CorridorAnswer answer = Answer();
  const CorridorLine other = answer.estimate.lines[0];
  for (int i = 0; i < 700; ++i) answer.estimate.lines.push_back(other);
  const corridor_pose_t message = ToMessage(answer);
  ASSERT_EQ(message.num_lines, 500);
  EXPECT_EQ(message.lines[0].edge, 2);
  EXPECT_EQ(message.lines[0].is_used, 1);
  EXPECT_EQ(message.lines[1].edge, 0);
  EXPECT_LT(message.getEncodedSize(), 60000);
}

TEST(CorridorConvert, AnswersComeBack) {
  const CorridorAnswer answer = Answer();
  std::string reason;
  const auto back = CorridorAnswerFromMessage(ToMessage(answer), &reason);
  ASSERT_TRUE(back) << reason;
  EXPECT_EQ(back->time, answer.time);
  EXPECT_EQ(back->source, answer.source);
  ASSERT_TRUE(back->corridor);
  EXPECT_EQ(back->corridor->name, answer.corridor->name);
  EXPECT_EQ(back->corridor->X_WL, answer.corridor->X_WL);
  EXPECT_EQ(back->corridor->width, 2.0);
  EXPECT_EQ(back->corridor->height, std::nullopt);
  EXPECT_EQ(back->corridor->skirting_height, 0.08);
  EXPECT_EQ(back->corridor->skirting_depth, 0.012);
  EXPECT_EQ(back->lines_took, answer.lines_took);
  EXPECT_EQ(back->pose_took, answer.pose_took);
  EXPECT_EQ(back->X_RS, answer.X_RS);
  EXPECT_EQ(back->estimate.status, answer.estimate.status);
  EXPECT_EQ(back->estimate.y, answer.estimate.y);
  EXPECT_EQ(back->estimate.heading, answer.estimate.heading);
  EXPECT_EQ(back->estimate.covariance, answer.estimate.covariance);
  EXPECT_EQ(back->estimate.vanishing_point, answer.estimate.vanishing_point);
  ASSERT_EQ(back->estimate.lines.size(), 2u);
  EXPECT_EQ(back->estimate.lines[0].edge, CorridorEdge::kFloorRight);
  EXPECT_TRUE(back->estimate.lines[0].is_used);
  corridor_pose_t message = ToMessage(answer);
  message.status = "fine";
  EXPECT_FALSE(CorridorAnswerFromMessage(message, &reason));
  message = ToMessage(answer);
  message.lines[0].edge = 8;
  EXPECT_FALSE(CorridorAnswerFromMessage(message, &reason));
  for (const double width : {-2.0, 1e9, std::nan("")}) {
    message = ToMessage(answer);
    message.width = width;
    EXPECT_FALSE(CorridorAnswerFromMessage(message, &reason)) << width;
  }
  message = ToMessage(answer);
  message.corridor.clear();
  EXPECT_FALSE(CorridorAnswerFromMessage(message, &reason)->corridor);
}

TEST(CorridorConvert, RefusesWhatCannotBe) {
  const auto refused = [](auto change) {
    corridor_pose_t message = ToMessage(Answer());
    change(&message);
    std::string reason;
    const bool is_refused = !CorridorFixFromMessage(message, &reason);
    EXPECT_EQ(is_refused, !reason.empty());
    return is_refused;
  };
  using M = corridor_pose_t;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(refused([](M*) {}));
  EXPECT_TRUE(refused([](M* m) { m->utime = 0; }));
  EXPECT_TRUE(refused([](M* m) { m->y_L = kNan; }));
  EXPECT_TRUE(refused([](M* m) { m->heading_L = kNan; }));
  EXPECT_TRUE(refused([](M* m) { m->covariance[0] = -1.0; }));
  EXPECT_TRUE(refused([](M* m) { m->covariance[1] = 1.0; }));
  EXPECT_TRUE(refused([](M* m) { m->corridor_W[2] = kNan; }));
  EXPECT_TRUE(refused([](M* m) { m->sensor_R[0] = kNan; }));
  EXPECT_TRUE(refused([](M* m) { m->has_heading = 0; }));
}

TEST(CorridorConvert, RefusesAnswersThatNobodyCanDraw) {
  const auto refused = [](auto change) {
    corridor_pose_t message = ToMessage(Answer());
    message.has_vanishing_point = 1;
    change(&message);
    std::string reason;
    const bool is_refused = !CorridorAnswerFromMessage(message, &reason);
    EXPECT_EQ(is_refused, !reason.empty());
    return is_refused;
  };
  using M = corridor_pose_t;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(refused([](M*) {}));
  EXPECT_TRUE(refused([](M* m) { m->vanishing_point[0] = kNan; }));
  EXPECT_TRUE(refused([](M* m) { m->vanishing_point[1] = 1e300; }));
  EXPECT_TRUE(refused([](M* m) { m->p_regular = 1.5; }));
  EXPECT_TRUE(refused([](M* m) { m->p_regular = kNan; }));
  EXPECT_TRUE(refused([](M* m) {
    m->has_heading = 0;
    m->has_y = 0;
    m->sensor_R[2] = kNan;
  }));
}

}  // namespace
}  // namespace waymark
