#include "processes/teleop/teleop_keys.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

Time At(double s) {
  return TimeFromMicroseconds(1) + DurationFromSeconds(s);
}

TEST(TeleopKeys, LettersAndArrowsDrive) {
  const TeleopConfig config;  // Half of 0.4 m/s and 60 deg/s at first.
  const double v = 0.2;
  const double w = RadiansFromDegrees(30.0);
  const auto typed = [&](std::string_view bytes) {
    TeleopKeys keys(config);
    EXPECT_FALSE(keys.Type(At(0), bytes).has_value());
    return keys.At(At(0.1));
  };
  EXPECT_EQ(typed("w"), (Velocity{v, 0}));
  EXPECT_EQ(typed("S"), (Velocity{-v, 0}));
  EXPECT_EQ(typed("a"), (Velocity{0, w})) << "left is positive";
  EXPECT_EQ(typed("d"), (Velocity{0, -w}));
  EXPECT_EQ(typed("q"), (Velocity{v, w / 2}));
  EXPECT_EQ(typed("e"), (Velocity{v, -w / 2}));
  EXPECT_EQ(typed("\x1b[A"), (Velocity{v, 0}));
  EXPECT_EQ(typed("\x1b[B"), (Velocity{-v, 0}));
  EXPECT_EQ(typed("\x1bOD"), (Velocity{0, w})) << "keypad mode";
  EXPECT_EQ(typed("\x1b[1;2C"), (Velocity{0, -w})) << "with shift";
  EXPECT_EQ(typed("wd"), (Velocity{0, -w})) << "the last one counts";
  EXPECT_EQ(typed("wx"), Velocity{}) << "any other key stands";
  EXPECT_EQ(typed("w\x1b[5~"), Velocity{}) << "page up, too";
  EXPECT_EQ(typed("w\x1bx"), Velocity{});
}

TEST(TeleopKeys, AnArrowMayComeInParts) {
  TeleopKeys keys({});
  (void)keys.Type(At(0), "\x1b");
  (void)keys.Type(At(0.01), "[");
  (void)keys.Type(At(0.02), "A");
  EXPECT_GT(keys.At(At(0.1)).forward, 0.0);
}

TEST(TeleopKeys, WhoLetsGoStops) {
  TeleopKeys keys({});
  (void)keys.Type(At(1.0), "w");
  EXPECT_GT(keys.At(At(1.25)).forward, 0.0);
  EXPECT_EQ(keys.At(At(1.26)), Velocity{});
  (void)keys.Type(At(1.2), "w");
  EXPECT_GT(keys.At(At(1.4)).forward, 0.0) << "repetition goes on";
  EXPECT_EQ(keys.At(At(0.5)), Velocity{}) << "time that goes back";
}

TEST(TeleopKeys, SpeedStaysInItsRange) {
  TeleopKeys keys({});
  for (int i = 0; i < 20; ++i) (void)keys.Type(At(0), "+");
  EXPECT_EQ(keys.share(), 1.0);
  (void)keys.Type(At(0), "w");
  EXPECT_NEAR(keys.At(At(0)).forward, 0.4, 1e-12);
  for (int i = 0; i < 20; ++i) (void)keys.Type(At(0), "-");
  EXPECT_NEAR(keys.share(), 0.1, 1e-12);
}

TEST(TeleopKeys, StopWinsOverWhatIsTypedWithIt) {
  TeleopKeys keys({});
  EXPECT_EQ(keys.Type(At(0), "ww w"), KeyEvent::kStop);
  EXPECT_EQ(keys.Type(At(0), " g"), KeyEvent::kStop);
  EXPECT_EQ(keys.Type(At(0), "g"), KeyEvent::kGo);
  (void)keys.Type(At(0), "w ");
  EXPECT_EQ(keys.At(At(0)), Velocity{});
}

}  // namespace
}  // namespace waymark
