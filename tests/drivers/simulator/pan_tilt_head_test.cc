#include "drivers/simulator/pan_tilt_head.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace waymark {
namespace {

Time At(double seconds) {
  return Time(DurationFromSeconds(seconds));
}

TEST(PanTiltHead, TurnsAtItsRateAndRests) {
  PanTiltHead head({2.0, 1.0, 0.5});
  EXPECT_TRUE(head.RestsAt(At(0.0)));
  head.Command(At(10.0), {0.8, -0.2});
  EXPECT_DOUBLE_EQ(head.AnglesAt(At(10.3)).pan, 0.6);
  EXPECT_DOUBLE_EQ(head.AnglesAt(At(10.3)).tilt, -0.2);
  EXPECT_FALSE(head.RestsAt(At(10.3)));
  EXPECT_TRUE(head.RestsAt(At(10.41)));
  // Turned back half-way.
  head.Command(At(10.5), {-0.8, 0.0});
  head.Command(At(10.6), {0.6, 0.0});
  EXPECT_DOUBLE_EQ(head.AnglesAt(At(10.6)).pan, 0.6);
  EXPECT_TRUE(head.RestsAt(At(10.601)));
}

TEST(PanTiltHead, StopsAtItsEnds) {
  PanTiltHead head({2.0, 1.0, 0.5});
  head.Command(At(0.0), {7.0, -7.0});
  EXPECT_EQ(head.AnglesAt(At(9.0)).pan, 1.0);
  EXPECT_EQ(head.AnglesAt(At(9.0)).tilt, -0.5);
  EXPECT_THROW(head.Command(At(-1.0), {}), std::logic_error);
}

}  // namespace
}  // namespace waymark
