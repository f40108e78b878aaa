#include "logs/log_tool/log_summary.h"

#include "tests/logs/log_tool/log_maker.h"

#include <waymark/image_t.hpp>
#include <waymark/relative_motion_t.hpp>

#include <gmock/gmock.h>

#include <limits>

namespace waymark {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using LogSummaryTest = LogToolTest;

TEST_F(LogSummaryTest, CountsRatesAndTypes) {
  WriteDrive();
  TypeTable types("");
  const LogSummary summary = SummariseLog(log_, &types);
  EXPECT_EQ(summary.report.num_events, 30);
  EXPECT_EQ(Microseconds(summary.first), kLogStart);
  EXPECT_EQ(Microseconds(summary.last), kLogStart + 1'900'000);
  ASSERT_EQ(summary.channels.size(), 2U);
  const auto& encoders = summary.channels[0];
  EXPECT_EQ(encoders.channel, "ENCODERS");
  EXPECT_THAT(encoders.types, ElementsAre("waymark.encoders_t"));
  EXPECT_EQ(encoders.num_events, 20);
  EXPECT_EQ(encoders.num_bytes, 20 * 38);
  // Exact stamps: only rounding of doubles is left.
  EXPECT_NEAR(encoders.rate_hz, 10.0, 1e-9);
  EXPECT_NEAR(encoders.jitter_s, 0.0, 1e-9);
  EXPECT_EQ(encoders.longest_gap, Duration(100'000));
  EXPECT_EQ(encoders.num_lost, 0);
  EXPECT_NEAR(summary.channels[1].rate_hz, 5.0, 1e-9);
}

TEST_F(LogSummaryTest, JitterLongestGapAndLoss) {
  {
    LogWriter writer(log_);
    // Intervals 0.1, 0.3, 0.1, 0.3 s: mean 0.2, standard deviation 0.1.
    std::int64_t utime = kLogStart;
    for (const int seq : {0, 1, 4, 5, 0}) {
      writer.Write("ENCODERS", MakeEncoders(utime, seq));
      utime += seq % 4 == 0 ? 100'000 : 300'000;
    }
    writer.Close();
  }
  TypeTable types("");
  const ChannelSummary channel = SummariseLog(log_, &types).channels.at(0);
  EXPECT_NEAR(channel.rate_hz, 5.0, 1e-9);
  EXPECT_NEAR(channel.jitter_s, 0.1, 1e-9);
  EXPECT_EQ(channel.longest_gap, Duration(300'000));
  EXPECT_EQ(Microseconds(channel.longest_gap_start), kLogStart + 100'000);
  EXPECT_EQ(channel.num_lost, 2);  // 2 and 3; the last 0 is a restart.
}

// Two logs in one file, as lcm-logger -a leaves them.
TEST_F(LogSummaryTest, AppendedLogsKeepTheirRates) {
  WriteDrive();
  auto bytes = ReadBytes(log_);
  const auto once = bytes;
  bytes.insert(bytes.end(), once.begin(), once.end());
  WriteBytes(log_, bytes);
  TypeTable types("");
  const LogSummary summary = SummariseLog(log_, &types);
  EXPECT_TRUE(summary.report.is_sound());
  EXPECT_EQ(summary.channels.at(0).num_events, 40);
  EXPECT_NEAR(summary.channels.at(0).rate_hz, 10.0, 1e-9);
}

TEST_F(LogSummaryTest, SendersCountForThemselves) {
  {
    LogWriter writer(log_);
    for (int i = 0; i < 10; ++i) {
      relative_motion_t motion{};
      motion.utime = kLogStart + i;
      motion.seq = i / 2;
      motion.source = i % 2 == 0 ? "laser" : "camera";
      writer.Write("RELATIVE_MOTION", motion);
    }
    writer.Close();
  }
  TypeTable types("");
  EXPECT_EQ(SummariseLog(log_, &types).channels.at(0).num_lost, 0);
}

TEST_F(LogSummaryTest, ImagesCarryTheirNumberInTheMetadata) {
  {
    LogWriter writer(log_);
    for (const int seq : {1, 2, 5}) {
      image_t image{};
      image.utime = kLogStart + seq;
      image.nmetadata = 2;
      image.metadata.resize(2);
      image.metadata[0].key = "pan";
      image.metadata[0].n = 8;
      image.metadata[0].value = {9, 9, 9, 9, 9, 9, 9, 9};
      image.metadata[1].key = "seq";
      image.metadata[1].n = 8;
      image.metadata[1].value = {
          0, 0, 0, 0, 0, 0, 0, static_cast<std::uint8_t>(seq)};
      writer.Write("IMAGE_FRONT", image);
    }
    writer.Close();
  }
  TypeTable types("");
  const ChannelSummary channel = SummariseLog(log_, &types).channels.at(0);
  EXPECT_THAT(channel.types, ElementsAre("waymark.image_t = bot_core.image_t"));
  EXPECT_EQ(channel.num_lost, 2);
}

TEST_F(LogSummaryTest, StrangersAreShownByFingerprint) {
  const std::vector<std::uint8_t> unknown = {1, 2, 3, 4, 5, 6, 7, 0xAF, 0};
  const std::string self_test = "lcm self test";
  {
    LogWriter writer(log_);
    const Time time = TimeFromMicroseconds(kLogStart);
    writer.Write(time, "A", unknown);
    writer.Write(time, "A", std::vector<std::uint8_t>(3));
    writer.Write(time,
                 "LCM_SELF_TEST",
                 {reinterpret_cast<const std::uint8_t*>(self_test.data()),
                  self_test.size()});
    writer.Close();
  }
  TypeTable types("");
  const LogSummary summary = SummariseLog(log_, &types);
  EXPECT_THAT(summary.channels.at(0).types,
              ElementsAre("? 01020304050607af", "no fingerprint"));
  EXPECT_THAT(summary.channels.at(1).types, ElementsAre("LCM self test"));
  // Both at one moment.
  EXPECT_EQ(summary.channels.at(0).rate_hz, 0.0);
  EXPECT_EQ(Microseconds(summary.channels.at(0).longest_gap_start), kLogStart);
}

TEST_F(LogSummaryTest, UsersTypesComeFirst) {
  const std::string text =
      "package theirs; struct encoders_t { int64_t utime; "
      "int32_t left_ticks_total; int32_t right_ticks_total; }";
  WriteBytes(directory_ / "encoders.lcm",
             {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  TypeTable types(directory_ / "");
  const std::vector<std::uint8_t> data = {
      0x7d, 0x09, 0x0b, 0xfb, 0x22, 0x1d, 0x74, 0xf9};
  EXPECT_EQ(types.Find(data).name, "theirs.encoders_t = maebot.encoders_t");
  EXPECT_FALSE(types.Find(data).is_ours);
}

// Damaged stamps must not overflow anything (checked under UBSan).
TEST_F(LogSummaryTest, ExtremeTimes) {
  {
    LogWriter writer(log_);
    constexpr auto kLeast = std::numeric_limits<std::int64_t>::min();
    constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
    for (const std::int64_t utime : {kLeast, kMost, kLeast, std::int64_t{0}}) {
      writer.Write("ENCODERS", MakeEncoders(utime, 0));
    }
    writer.Close();
  }
  TypeTable types("");
  const LogSummary summary = SummariseLog(log_, &types);
  EXPECT_GT(SecondsBetween(summary.first, summary.last), 1e13);
  EXPECT_FALSE(DateText(summary.first).empty());
  EXPECT_FALSE(DateText(summary.last).empty());
}

TEST_F(LogSummaryTest, DamageIsListedUpToALimit) {
  WriteDrive();
  auto bytes = ReadBytes(log_);
  bytes.insert(bytes.begin(), 5, 0xAA);
  bytes.insert(bytes.end(), 7, 0xAA);
  WriteBytes(log_, bytes);
  TypeTable types("");
  const LogReadReport report = SummariseLog(log_, &types).report;
  const std::string text = DamageText("x.log", report, 10);
  EXPECT_THAT(text,
              AllOf(HasSubstr("12 bytes in 2 places"),
                    HasSubstr("byte 0 to 4: 5 bytes after 0 events\n"),
                    HasSubstr("7 bytes after 30 events (torn end)"),
                    HasSubstr("waymark-log repair x.log OUT")));
  EXPECT_THAT(DamageText("x.log", report, 1), HasSubstr("and 1 more"));
  EXPECT_EQ(DamageText("x.log", LogReadReport{}, 10), "");
}

TEST(DateTextTest, RoundsDown) {
  EXPECT_EQ(DateText(TimeFromMicroseconds(0)), "1970-01-01 00:00:00.000 UTC");
  EXPECT_EQ(DateText(TimeFromMicroseconds(1'413'123'456'789'999)),
            "2014-10-12 14:17:36.789 UTC");
  EXPECT_EQ(DateText(TimeFromMicroseconds(-1)), "1969-12-31 23:59:59.999 UTC");
}

}  // namespace
}  // namespace waymark
