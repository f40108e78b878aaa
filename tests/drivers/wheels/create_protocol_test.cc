#include "drivers/wheels/create_protocol.h"

#include "estimation/base/random.h"
#include "tests/support/create_emulator.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

// A robot that streams.
CreateEmulator Streaming() {
  CreateEmulator robot;
  robot.Receive(EncodeStart());
  robot.Receive(EncodeMode(CreateMode::kSafe));
  robot.Receive(EncodeStream());
  return robot;
}

Bytes Frames(int num) {
  CreateEmulator robot = Streaming();
  return robot.Step(0.015 * num);
}

TEST(CreateProtocol, CommandsAreTheSpecifications) {
  EXPECT_EQ(EncodeStart(), Bytes({128}));
  EXPECT_EQ(EncodeMode(CreateMode::kSafe), Bytes({131}));
  EXPECT_EQ(EncodeMode(CreateMode::kFull), Bytes({132}));
  EXPECT_THROW((void)EncodeMode(CreateMode::kPassive), std::logic_error);
  // -200 mm/s is 0xff38, 500 mm/s 0x01f4: right first.
  EXPECT_EQ(EncodeDriveDirect(-200, 500), Bytes({145, 0xff, 0x38, 0x01, 0xf4}));
  EXPECT_THROW((void)EncodeDriveDirect(501, 0), std::logic_error);
  EXPECT_THROW((void)EncodeDriveDirect(0, -501), std::logic_error);
  EXPECT_EQ(EncodeStreamPause(), Bytes({150, 0}));
}

TEST(CreateProtocol, FrameSaysWhatTheRobotSenses) {
  CreateEmulator robot = Streaming();
  robot.SetTicks(40000.0, -3.0);
  robot.SetCharge(1234, 2696);
  robot.SetBumpers(true, false);
  CreateStreamParser parser;
  std::vector<CreateSensors> frames = parser.Add(robot.Step(0.015));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(frames[0].is_bumper_left);
  EXPECT_FALSE(frames[0].is_bumper_right);
  EXPECT_FALSE(frames[0].is_wheel_dropped);
  EXPECT_EQ(frames[0].mode, static_cast<std::uint8_t>(CreateMode::kSafe));
  EXPECT_EQ(frames[0].charge, 1234);
  EXPECT_EQ(frames[0].capacity, 2696);
  EXPECT_EQ(frames[0].left_ticks, 40000);
  EXPECT_EQ(frames[0].right_ticks, 65533);
  robot.SetBumpers(false, true);
  robot.SetWheelDrop(true);
  robot.SetCliff(true);
  frames = parser.Add(robot.Step(0.015));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(frames[0].is_bumper_right && !frames[0].is_bumper_left);
  EXPECT_TRUE(frames[0].is_wheel_dropped && frames[0].is_cliff);
  EXPECT_EQ(frames[0].mode, static_cast<std::uint8_t>(CreateMode::kPassive));
  EXPECT_EQ(parser.num_skipped(), 0);
}

TEST(CreateProtocol, FramesArriveInPortionsOfAnySize) {
  const Bytes bytes = Frames(20);
  for (const std::size_t portion : {1u, 2u, 7u, 33u, 200u}) {
    CreateStreamParser parser;
    std::size_t num = 0;
    for (std::size_t at = 0; at < bytes.size(); at += portion) {
      num += parser
                 .Add(std::span(bytes).subspan(
                     at, std::min(portion, bytes.size() - at)))
                 .size();
    }
    EXPECT_EQ(num, 20u);
    EXPECT_EQ(parser.num_skipped(), 0);
  }
}

TEST(CreateProtocol, OneLostByteCostsOneFrame) {
  const Bytes bytes = Frames(3);
  const std::size_t size = bytes.size() / 3;
  for (std::size_t lost = 0; lost < size; ++lost) {
    Bytes damaged = bytes;
    damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(size + lost));
    CreateStreamParser parser;
    EXPECT_EQ(parser.Add(damaged).size(), 2u) << lost;
    EXPECT_EQ(parser.num_skipped(), static_cast<std::int64_t>(size) - 1);
  }
}

TEST(CreateProtocol, OneWrongByteCostsOneFrame) {
  const Bytes bytes = Frames(3);
  const std::size_t size = bytes.size() / 3;
  for (std::size_t at = 0; at < size; ++at) {
    for (const int change : {1, 0x80, 0xff}) {
      Bytes damaged = bytes;
      damaged[size + at] =
          static_cast<std::uint8_t>(damaged[size + at] ^ change);
      CreateStreamParser parser;
      EXPECT_EQ(parser.Add(damaged).size(), 2u) << at;
      EXPECT_EQ(parser.num_skipped(), static_cast<std::int64_t>(size));
    }
  }
}

TEST(CreateProtocol, StatedLengthsAreNotTrusted) {
  // A header that announces 255 bytes costs itself only.
  Bytes bytes{19, 255};
  const Bytes frames = Frames(4);
  bytes.insert(bytes.end(), frames.begin(), frames.end());
  CreateStreamParser parser;
  EXPECT_EQ(parser.Add(bytes).size(), 4u);
  EXPECT_EQ(parser.num_skipped(), 2);
}

TEST(CreateProtocol, NoiseIsSkippedAndCounted) {
  Random random(3);
  CreateStreamParser parser;
  std::int64_t num_bytes = 0;
  for (int i = 0; i < 1000; ++i) {
    Bytes noise(random.Index(200));
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(random.Bits());
    num_bytes += static_cast<std::int64_t>(noise.size());
    EXPECT_TRUE(parser.Add(noise).empty());
  }
  // All but what may still become a frame.
  EXPECT_GT(parser.num_skipped(), num_bytes - 40);
  EXPECT_EQ(parser.Add(Frames(2)).size(), 2u);
}

TEST(CreateProtocol, StopWorksWithinAnyCommandThatWasCutShort) {
  for (const Bytes& whole :
       {EncodeDriveDirect(300, 300), EncodeStreamPause()}) {
    for (std::size_t cut = 0; cut <= whole.size(); ++cut) {
      CreateEmulator robot = Streaming();
      robot.Receive(EncodeDriveDirect(200, 200));
      ASSERT_TRUE(robot.is_moving());
      robot.Receive(std::span(whole).first(cut));
      robot.Receive(EncodeStop());
      EXPECT_FALSE(robot.is_moving()) << cut;
      EXPECT_EQ(robot.mode(), CreateEmulator::kPassive) << cut;
    }
  }
}

}  // namespace
}  // namespace waymark
