#include "estimation/base/time.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(Time, MicrosecondsRoundTripBeyondTheDigitsOfADouble) {
  constexpr std::int64_t kUtime = 1'795'312'345'678'901;
  EXPECT_EQ(Microseconds(TimeFromMicroseconds(kUtime)), kUtime);
  EXPECT_EQ(Microseconds(TimeFromMicroseconds(kUtime) + Duration(1)),
            kUtime + 1);
}

TEST(Time, SecondsRoundToTheNearestMicrosecondOnBothSidesOfZero) {
  EXPECT_EQ(DurationFromSeconds(0.1), Duration(100000));
  EXPECT_EQ(DurationFromSeconds(-0.1), Duration(-100000));
  EXPECT_EQ(DurationFromSeconds(1.4e-6), Duration(1));
  EXPECT_EQ(DurationFromSeconds(-1.6e-6), Duration(-2));
  EXPECT_DOUBLE_EQ(Seconds(Duration(2'500'000)), 2.5);
}

}  // namespace
}  // namespace waymark
