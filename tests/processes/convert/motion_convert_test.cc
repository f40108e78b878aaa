#include "processes/convert/motion_convert.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace waymark {
namespace {

TEST(MotionConvert, OnlyPossibleVelocitiesPass) {
  velocity_t good;
  good.utime = 1;
  good.forward = -100.0;
  good.turn_rate = 100.0;
  std::string reason;
  EXPECT_TRUE(CheckVelocity(good, &reason)) << reason;
  velocity_t bad = good;
  bad.utime = 0;
  EXPECT_FALSE(CheckVelocity(bad, &reason));
  EXPECT_EQ(reason, "utime: 0 must be positive");
  bad = good;
  bad.forward = 100.5;
  EXPECT_FALSE(CheckVelocity(bad, &reason));
  EXPECT_EQ(reason, "forward: 100.5 must be within +-100");
  bad = good;
  bad.turn_rate = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(CheckVelocity(bad, &reason));
  EXPECT_EQ(reason, "turn_rate: nan must be within +-100");
}

}  // namespace
}  // namespace waymark
