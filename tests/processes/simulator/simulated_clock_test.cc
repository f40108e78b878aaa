#include "processes/simulator/simulated_clock.h"

#include <gtest/gtest.h>

#include <chrono>

namespace waymark {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Time kNow = TimeFromMicroseconds(1'700'000'000'000'000);
constexpr Duration kTick = milliseconds(7);
constexpr Time kStart = kNow + hours(3);

TEST(SimulatedClockTest, GoesAsFastAsItsSpeed) {
  for (const double speed : {0.05, 1.0, 7.3, 20.0}) {
    SimulatedClock clock(speed, kTick, kNow, kStart);
    EXPECT_EQ(clock.At(kNow), kStart);
    Time now = kNow;
    for (int i = 0; i < 100'000; ++i) {
      now += kTick;
      (void)clock.At(now);
    }
    // Rounded once, to a microsecond.
    EXPECT_NEAR(Seconds(clock.At(now) - kStart), 700.0 * speed, 1e-6) << speed;
    EXPECT_EQ(clock.lost(), Duration(0)) << speed;
  }
}

TEST(SimulatedClockTest, MakesUpForATenthOfASecondAndLosesTheRest) {
  SimulatedClock clock(2.0, kTick, kNow, kStart);
  EXPECT_EQ(clock.At(kNow + milliseconds(100)), kStart + milliseconds(200));
  EXPECT_EQ(clock.lost(), Duration(0));
  // An hour's sleep, then it goes on as before.
  const Time woken = kNow + milliseconds(100) + hours(1);
  EXPECT_EQ(clock.At(woken), kStart + milliseconds(400));
  EXPECT_EQ(clock.lost(), hours(2) - milliseconds(200));
  EXPECT_EQ(clock.At(woken + milliseconds(20)), kStart + milliseconds(440));
  EXPECT_EQ(clock.lost(), hours(2) - milliseconds(200));
  (void)clock.At(woken + milliseconds(20) + seconds(2));
  EXPECT_EQ(clock.lost(), hours(2) - milliseconds(200) + milliseconds(3800));
}

TEST(SimulatedClockTest, LosesNothingBetweenTicksHoweverLong) {
  for (const double speed : {0.001, 1.0, 10.0}) {
    for (const Duration tick : {Duration(milliseconds(100)),
                                Duration(seconds(2)),
                                Duration(seconds(1000))}) {
      SimulatedClock clock(speed, tick, kNow, kStart);
      Time now = kNow;
      for (int i = 0; i < 1000; ++i) {
        now = kNow + (i + 1) * tick + tick * (i % 5) / 7;  // With jitter.
        (void)clock.At(now);
      }
      EXPECT_NEAR(
          Seconds(clock.At(now) - kStart), speed * Seconds(now - kNow), 1e-6);
      EXPECT_EQ(clock.lost(), Duration(0)) << speed << " " << Seconds(tick);
    }
  }
}

TEST(SimulatedClockTest, DoesNotGoBack) {
  SimulatedClock clock(1.0, kTick, kNow, kStart);
  const Time shown = clock.At(kNow + milliseconds(90));
  EXPECT_EQ(clock.At(kNow + milliseconds(50)), shown);
}

}  // namespace
}  // namespace waymark
