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
  EXPECT_GT(keys.At(At(1.6)).forward, 0.0);
  EXPECT_EQ(keys.At(At(1.61)), Velocity{});
  EXPECT_EQ(keys.At(At(0.5)), Velocity{}) << "time that goes back";
}

// Most keyboards wait for half a second before they repeat; then they are fast.
TEST(TeleopKeys, AKeyThatIsHeldDrivesWithoutPause) {
  TeleopKeys keys({});
  (void)keys.Type(At(1.0), "w");
  for (double t = 1.0; t < 1.5; t += 0.02) {
    EXPECT_GT(keys.At(At(t)).forward, 0.0) << t;
  }
  // The first of the repetition looks like another stroke.
  for (double t = 1.5; t < 2.0; t += 0.03) {
    (void)keys.Type(At(t), "w");
    EXPECT_GT(keys.At(At(t + 0.03)).forward, 0.0) << t;
  }
  (void)keys.Type(At(2.0), "w");
  EXPECT_GT(keys.At(At(2.25)).forward, 0.0);
  EXPECT_EQ(keys.At(At(2.26)), Velocity{}) << "soon after it was let go";
}

TEST(TeleopKeys, AnotherKeyOrALaterStrokeIsAFirstOne) {
  TeleopKeys keys({});
  (void)keys.Type(At(1.0), "w");
  (void)keys.Type(At(1.1), "a");
  EXPECT_GT(keys.At(At(1.6)).turn_rate, 0.0);
  (void)keys.Type(At(1.65), "a");
  EXPECT_GT(keys.At(At(2.2)).turn_rate, 0.0);
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
