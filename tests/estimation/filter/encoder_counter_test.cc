#include "estimation/filter/encoder_counter.h"

#include "estimation/base/random.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

using testing::HasSubstr;

EncoderReading At(double seconds, std::int64_t right, std::int64_t left) {
  return {TimeFromMicroseconds(1'000'000) + DurationFromSeconds(seconds),
          0,
          right,
          left};
}

EncoderCounterOptions Bounded() {
  EncoderCounterOptions options;
  options.max_tick_rate = 10'000;
  return options;
}

// A counter of any width gives the ticks that were turned.
TEST(EncoderCounter, WrapsAreRemoved) {
  Random random(1);
  for (const int bits : {8, 16, 32, 0}) {
    EncoderCounter counter;
    std::int64_t right = 250;
    std::int64_t left = -3;
    const std::int64_t most = bits == 8 ? 100 : 30'000;
    const auto sent = [bits](std::int64_t count) {
      return bits == 0 ? count : count & ((std::int64_t{1} << bits) - 1);
    };
    ASSERT_TRUE(counter.Add(At(0, sent(right), sent(left)), bits).is_first);
    for (int i = 1; i < 2000; ++i) {
      const auto d_right = static_cast<std::int64_t>(random.Index(
                               static_cast<std::uint64_t>(2 * most))) -
                           most;
      const std::int64_t d_left = most - 1 - (d_right + most) / 2;
      right += d_right;
      left += d_left;
      const EncoderStep step =
          counter.Add(At(0.02 * i, sent(right), sent(left)), bits);
      ASSERT_TRUE(step.is_accepted) << step.reason;
      ASSERT_EQ(step.ticks.right, d_right) << bits << " bits, step " << i;
      ASSERT_EQ(step.ticks.left, d_left);
      ASSERT_NEAR(step.seconds, 0.02, 1e-9);
    }
  }
}

// Counters that are sent signed wrap too.
TEST(EncoderCounter, SignedSixteenBits) {
  EncoderCounter counter;
  (void)counter.Add(At(0, 32'767, -32'768), 16);
  const EncoderStep step = counter.Add(At(0.1, -32'766, 32'767), 16);
  EXPECT_EQ(step.ticks.right, 3);
  EXPECT_EQ(step.ticks.left, -1);
}

TEST(EncoderCounter, OneWildReadingIsSkippedWithoutLoss) {
  EncoderCounter counter(Bounded());
  (void)counter.Add(At(0, 0, 0), 0);
  const EncoderStep wild = counter.Add(At(0.02, 900'000, 10), 0);
  EXPECT_FALSE(wild.is_accepted);
  EXPECT_THAT(wild.reason, HasSubstr("right wheel +900000 ticks in 0.020 s"));
  EXPECT_THAT(wild.reason, HasSubstr("at most 1200"));
  const EncoderStep next = counter.Add(At(0.04, 40, 20), 0);
  EXPECT_TRUE(next.is_accepted);
  EXPECT_EQ(next.ticks.right, 40);
  EXPECT_EQ(next.unknown_s, 0);
  EXPECT_NEAR(next.seconds, 0.04, 1e-9);
}

// A counter that was reset is believed after five readings that agree; only
// the one period in which it jumped is unknown.
TEST(EncoderCounter, ResetBecomesTheNewBaseLine) {
  EncoderCounter counter(Bounded());
  (void)counter.Add(At(0, 5'000'000, 5'000'000), 0);
  for (int i = 1; i <= 4; ++i) {
    EXPECT_FALSE(counter.Add(At(0.02 * i, 30 * i, 20 * i), 0).is_accepted);
  }
  const EncoderStep step = counter.Add(At(0.1, 150, 100), 0);
  ASSERT_TRUE(step.is_accepted);
  EXPECT_EQ(step.ticks.right, 120);
  EXPECT_EQ(step.ticks.left, 80);
  EXPECT_NEAR(step.unknown_s, 0.02, 1e-9);
  EXPECT_NEAR(step.seconds, 0.1, 1e-9);
  EXPECT_EQ(counter.Add(At(0.12, 180, 120), 0).ticks.right, 30);
}

// The farthest that is possible grows while readings are refused: whatever was
// counted before, a reset that was refused is never taken for motion later.
TEST(EncoderCounter, ResetOfASmallCountIsNeverTakenForMotion) {
  for (const std::int64_t before : {1250, 1500, 1900, 2500, 10'000}) {
    for (const int sign : {1, -1}) {
      EncoderCounter counter(Bounded());
      (void)counter.Add(At(0, sign * before, sign * before), 0);
      double unknown_s = 0.0;
      for (int i = 1; i <= 10; ++i) {
        const EncoderStep step =
            counter.Add(At(0.02 * i, sign * 30 * i, sign * 20 * i), 0);
        EXPECT_EQ(step.is_accepted, i >= 5) << before << ", reading " << i;
        EXPECT_LE(std::abs(step.ticks.right), 150.0) << before;
        EXPECT_EQ(step.reason.empty(), step.is_accepted && i > 5);
        unknown_s += step.unknown_s;
      }
      EXPECT_NEAR(unknown_s, 0.02, 1e-9);
    }
  }
}

// One wild reading just beyond what is possible, toward which the wheels turn.
TEST(EncoderCounter, ReadingsAfterANearWildOneFollowTheLastGoodOne) {
  EncoderCounter counter(Bounded());
  (void)counter.Add(At(0, 0, 0), 0);
  EXPECT_FALSE(counter.Add(At(0.02, 1210, 0), 0).is_accepted);
  const EncoderStep next = counter.Add(At(0.04, 200, 200), 0);
  ASSERT_TRUE(next.is_accepted) << next.reason;
  EXPECT_EQ(next.ticks.right, 200);
  EXPECT_EQ(next.unknown_s, 0);
}

TEST(EncoderCounter, GarbageIsNeverBelieved) {
  EncoderCounter counter(Bounded());
  (void)counter.Add(At(0, 0, 0), 0);
  Random random(3);
  for (int i = 1; i < 500; ++i) {
    const auto wild = static_cast<std::int64_t>(random.Index(1'000'000'000));
    EXPECT_FALSE(
        counter.Add(At(0.02 * i, 1'000'000 + wild, wild), 0).is_accepted);
  }
  EXPECT_TRUE(counter.Add(At(10, 100, 100), 0).is_accepted);
}

// A wheel that could have turned half the counter's range unseen.
TEST(EncoderCounter, LongGapOfANarrowCounterIsAJump) {
  EncoderCounter counter(Bounded());
  (void)counter.Add(At(0, 0, 0), 16);
  const EncoderStep step = counter.Add(At(60, 100, 100), 16);
  EXPECT_FALSE(step.is_accepted);
  EXPECT_THAT(step.reason, HasSubstr("wrapped unseen"));
  EncoderCounter wide(Bounded());
  (void)wide.Add(At(0, 0, 0), 32);
  EXPECT_TRUE(wide.Add(At(60, 100, 100), 32).is_accepted);
}

TEST(EncoderCounter, TimeMustAdvance) {
  EncoderCounter counter;
  (void)counter.Add(At(1, 0, 0), 0);
  EXPECT_FALSE(counter.Add(At(1, 5, 5), 0).is_accepted);
  EXPECT_FALSE(counter.Add(At(0.5, 5, 5), 0).is_accepted);
  EXPECT_EQ(counter.Add(At(1.1, 7, 7), 0).ticks.right, 7);
}

}  // namespace
}  // namespace waymark
