#include "logs/evaluation/sight_health.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>

namespace waymark {
namespace {

using std::chrono::microseconds;

constexpr char kChannel[] = "IMAGE_FRONT";

// The log's clock is `offset` ahead of the robot's.
Time Logged(std::int64_t utime, std::int64_t offset) {
  return Time(microseconds(utime + offset));
}

// ENCODERS each 20 ms, images each 60 ms from 1 s on; each is answered 50 ms
// after its time, and the next POSE comes 10 ms later.
SightClock TenImages(std::int64_t offset, std::int64_t without_answer) {
  SightClock clock;
  for (std::int64_t t = 900'000; t < 2'000'000; t += 20'000) {
    clock.OnEncoders(t, Logged(t, offset));
  }
  for (std::int64_t i = 0; i < 10; ++i) {
    const std::int64_t utime = 1'000'000 + 60'000 * i;
    clock.OnImage(kChannel, utime, i);
    if (i == without_answer) continue;
    clock.OnAnswer(kChannel, utime, true, Logged(utime + 50'000, offset));
    clock.OnPose(Logged(utime + 60'000, offset));
  }
  return clock;
}

TEST(SightHealthTest, MeasuresFromTheImagesTimeWhateverTheLogsClock) {
  for (const std::int64_t offset : {0LL, 3'000LL, 86'400'000'000LL}) {
    const auto health = TenImages(offset, -1).Finish(true);
    ASSERT_TRUE(health);
    EXPECT_EQ(health->channel, kChannel);
    EXPECT_EQ(health->num_images, 10);
    EXPECT_EQ(health->num_unanswered, 0);
    EXPECT_EQ(health->num_lost, 0);
    ASSERT_TRUE(health->to_answer && health->to_pose);
    EXPECT_EQ(health->to_answer->num, 10);
    EXPECT_NEAR(health->to_answer->median_ms, 50.0, 1e-9);
    EXPECT_NEAR(health->to_answer->max_ms, 50.0, 1e-9);
    EXPECT_NEAR(health->to_pose->p95_ms, 60.0, 1e-9);
  }
}

TEST(SightHealthTest, CountsWhatWasNotAnswered) {
  EXPECT_EQ(TenImages(0, 4).Finish(true)->num_unanswered, 1);
  // Before the first answer, and behind the last, nobody need listen.
  const auto first = TenImages(0, 0).Finish(true);
  EXPECT_EQ(first->num_images, 9);
  EXPECT_EQ(first->num_unanswered, 0);
  EXPECT_EQ(TenImages(0, 9).Finish(true)->num_unanswered, 0);
}

TEST(SightHealthTest, CountsGapsInTheNumbersOfImages) {
  SightClock clock;
  // 2 and 3 are missing, then the camera starts again.
  std::int64_t utime = 1'000'000;
  for (const std::int64_t seq : {0, 1, 4, 5, 0, 1}) {
    clock.OnImage(kChannel, utime, seq);
    clock.OnAnswer(kChannel, utime, false, Time(microseconds(utime)));
    utime += 60'000;
  }
  const auto health = clock.Finish(true);
  EXPECT_EQ(health->num_lost, 2);
  // Without ENCODERS nothing says when an image was taken; without a heading
  // there is nothing for POSE to know.
  EXPECT_FALSE(health->to_answer);
  EXPECT_FALSE(health->to_pose);
}

TEST(SightHealthTest, HasNoLatencyOffline) {
  const auto health = TenImages(0, -1).Finish(false);
  ASSERT_TRUE(health);
  EXPECT_EQ(health->num_images, 10);
  EXPECT_FALSE(health->to_answer);
}

TEST(SightHealthTest, IsNothingWithoutAnswers) {
  SightClock clock;
  EXPECT_FALSE(clock.Finish(true));
  clock.OnImage(kChannel, 1'000'000, 0);
  EXPECT_FALSE(clock.Finish(true));
}

}  // namespace
}  // namespace waymark
