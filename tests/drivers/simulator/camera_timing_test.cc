#include "drivers/simulator/camera_timing.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace waymark {
namespace {

constexpr Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

TEST(CameraTiming, FramesKeepTheirRateForHours) {
  CameraTimingOptions options;
  options.rate_hz = 30.0;
  CameraTimer timer(options, kStart, 1, "front");
  CameraFrame frame;
  for (int i = 0; i <= 108000; ++i) frame = timer.Next();
  EXPECT_EQ(frame.number, 108000);
  EXPECT_EQ(frame.exposure_start, kStart + std::chrono::hours(1));
  EXPECT_EQ(frame.exposure_end - frame.exposure_start, Duration(5000));
  EXPECT_EQ(frame.stamp - frame.exposure_start, Duration(2500));
  EXPECT_EQ(frame.arrival - frame.exposure_end, Duration(50000));
}

TEST(CameraTiming, DropsAndDelaysAsStatedWithoutOvertaking) {
  CameraTimingOptions options;
  options.rate_hz = 100.0;
  options.jitter_s = 0.2;
  options.drop_share = 0.25;
  CameraTimer timer(options, kStart, 2, "front");
  constexpr int kFrames = 20000;
  CameraFrame last;
  double late = 0.0;
  for (int i = 0; i < kFrames; ++i) {
    const CameraFrame frame = timer.Next();
    ASSERT_GE(frame.arrival, last.arrival);
    ASSERT_GE(frame.arrival - frame.exposure_end, Duration(50000));
    ASSERT_LE(frame.arrival - frame.exposure_end, Duration(250000));
    late += Seconds(frame.arrival - frame.exposure_end) / kFrames;
    last = frame;
  }
  // kFrames of about kFrames / 0.75; four sigma of a negative binomial.
  EXPECT_NEAR(static_cast<double>(last.number), kFrames / 0.75, 4.0 * 95.0);
  EXPECT_GT(late, 0.05 + 0.1);  // Waiting for frames before adds to the mean.
}

TEST(CameraTiming, EachNameHasItsOwnNumbers) {
  CameraTimingOptions options;
  options.jitter_s = 0.02;
  CameraTimer a(options, kStart, 3, "left"), b(options, kStart, 3, "left"),
      c(options, kStart, 3, "right");
  bool differs = false;
  for (int i = 0; i < 10; ++i) {
    const CameraFrame frame = a.Next();
    EXPECT_EQ(frame.arrival, b.Next().arrival);
    differs |= frame.arrival != c.Next().arrival;
  }
  EXPECT_TRUE(differs);
}

TEST(CameraTiming, OptionsOutOfRangeAreNamed) {
  CameraTimingOptions options;
  options.exposure_s = 0.1;  // Longer than a period.
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.drop_share = 1.0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace waymark
