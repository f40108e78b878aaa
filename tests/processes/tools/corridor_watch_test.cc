#include "processes/tools/task/corridor_watch.h"

#include "estimation/geometry/angle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::Not;

const Pose2 kCorridor{3.0, -2.0, 2.1};  // X_WL.

corridor_pose_t Answer(const char* status) {
  corridor_pose_t message{};
  message.utime = 1;
  message.status = status;
  message.corridor = "corridor";
  message.corridor_W[0] = kCorridor.x;
  message.corridor_W[1] = kCorridor.y;
  message.corridor_W[2] = kCorridor.heading;
  return message;
}

truth_t Truth(std::int64_t utime, const Pose2& X_LR) {
  const Pose2 X_WR = kCorridor * X_LR;
  truth_t message{};
  message.utime = utime;
  message.x = X_WR.x;
  message.y = X_WR.y;
  message.has_heading = 1;
  message.heading = X_WR.heading;
  return message;
}

pose_t Pose(std::int64_t utime, const Pose2& X_LR) {
  const Pose2 X_WR = kCorridor * X_LR;
  pose_t message{};
  message.utime = utime;
  message.is_known = 1;
  message.pose_W[0] = X_WR.x;
  message.pose_W[1] = X_WR.y;
  message.pose_W[2] = X_WR.heading;
  return message;
}

TEST(CorridorWatchTest, SaysHowManyImagesAndHowFarOff) {
  CorridorWatch watch;
  EXPECT_EQ(watch.News(), "");
  for (int i = 0; i < 7; ++i) watch.OnAnswer(Answer("accepted"));
  watch.OnAnswer(Answer("faulty"));
  watch.OnAnswer(Answer("no_lines"));
  watch.OnAnswer(Answer("no_lines"));
  // 1 m along the corridor does not count, 2 cm across it do; in any order.
  watch.OnTruth(Truth(10, {5.0, 0.1, 0.2}));
  watch.OnPose(Pose(10, {6.0, 0.08, 0.2 + RadiansFromDegrees(1.5)}));
  watch.OnPose(Pose(20, {6.0, 0.1, 0.2}));
  watch.OnTruth(Truth(20, {6.0, 0.1, 0.2}));
  watch.OnTruth(Truth(30, {6.0, 0.9, 0.2}));  // POSE said nothing then.
  EXPECT_EQ(watch.News(), "7 of 10 images (no_lines), off by 2.0 cm, 1.50 deg");
  // Only what is new.
  EXPECT_EQ(watch.News(), "");
  watch.OnAnswer(Answer("accepted"));
  EXPECT_EQ(watch.News(), "1 of 1 images");
}

TEST(CorridorWatchTest, ShowsNothingStrangeFromTheBus) {
  CorridorWatch watch;
  watch.OnAnswer(Answer("\x1b[2J"));
  watch.OnTruth(Truth(10, {5.0, 0.1, std::nan("")}));
  watch.OnPose(Pose(10, {5.0, 0.1, 0.2}));
  EXPECT_EQ(watch.News(), "0 of 1 images (unknown)");
}

}  // namespace
}  // namespace waymark
