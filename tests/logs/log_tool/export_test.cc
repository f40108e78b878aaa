#include "logs/log_tool/csv_export.h"
#include "logs/log_tool/tum_export.h"
#include "tests/logs/log_tool/log_maker.h"

#include <waymark/bot_pose_t.hpp>
#include <waymark/config_t.hpp>
#include <waymark/status_t.hpp>
#include <waymark/truth_t.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class ExportTest : public LogToolTest {
 protected:
  static std::vector<std::string> Lines(const std::string& path) {
    const auto bytes = ReadBytes(path);
    std::istringstream in(std::string(bytes.begin(), bytes.end()));
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  TumReport Tum(const std::string& channel) {
    return ExportTum(log_, channel, tum_, false, &types_);
  }

  TypeTable types_{""};
  std::string csv_ = directory_ / "csv";
  std::string tum_ = directory_ / "a.tum";
};

TEST_F(ExportTest, CsvHasOneRowPerMessage) {
  WriteDrive();
  const CsvReport report = ExportCsv(log_, csv_, &types_);
  ASSERT_EQ(report.files.size(), 2U);
  EXPECT_EQ(report.files[0].path, csv_ + "/ENCODERS.csv");
  EXPECT_EQ(report.files[0].num_rows, 20);
  EXPECT_TRUE(report.left_out.empty());
  const auto lines = Lines(csv_ + "/ENCODERS.csv");
  ASSERT_EQ(lines.size(), 21U);
  EXPECT_EQ(lines[0],
            "event_utime,utime,seq,left_ticks,right_ticks,counter_bits,"
            "is_virtual");
  EXPECT_EQ(lines[3], "1700000000200000,1700000000200000,2,20,-20,0,0");
  EXPECT_THAT(Lines(csv_ + "/POSE.csv").at(1), HasSubstr(",0,1,,0,0,0,"));
}

// Arrays of different lengths share the columns of the longest, and text may
// hold anything.
TEST_F(ExportTest, CsvOfArraysAndText) {
  {
    LogWriter writer(log_);
    for (int n = 0; n < 3; ++n) {
      status_t status{};
      status.utime = kLogStart + n;
      status.num_channels = n;
      status.channels.resize(static_cast<std::size_t>(n));
      writer.Write("STATUS", status);
    }
    config_t config{};
    config.utime = kLogStart;
    config.yaml = "a: \"1\"\nb: 2,3";
    writer.Write("CONFIG", config);
    writer.Close();
  }
  ExportCsv(log_, csv_, &types_);
  const auto lines = Lines(csv_ + "/STATUS.csv");
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_THAT(lines[0], HasSubstr("channels[1].num_lost"));
  const auto num_commas = [](const std::string& line) {
    return std::count(line.begin(), line.end(), ',');
  };
  EXPECT_EQ(num_commas(lines[1]), num_commas(lines[0]));
  EXPECT_THAT(
      Lines(csv_ + "/CONFIG.csv"),
      ElementsAre(
          StartsWith("event_utime"), HasSubstr(",\"a: \"\"1\"\""), "b: 2,3\""));
}

TEST_F(ExportTest, CsvKeepsAllDigits) {
  {
    LogWriter writer(log_);
    pose_t pose = MakePose(kLogStart, 0);
    pose.pose_W[0] = 0.1 + 0.2;
    pose.pose_W[1] = 1e-300;
    writer.Write("POSE", pose);
    writer.Close();
  }
  ExportCsv(log_, csv_, &types_);
  EXPECT_THAT(Lines(csv_ + "/POSE.csv").at(1),
              HasSubstr("0.30000000000000004,1e-300,"));
}

TEST_F(ExportTest, CsvSaysWhatItLeavesOut) {
  {
    LogWriter writer(log_);
    const Time time = TimeFromMicroseconds(kLogStart);
    writer.Write(time, "THEIRS", std::vector<std::uint8_t>(8, 1));
    writer.Write("A/B", MakePose(kLogStart, 0));
    writer.Write("A/B", MakeEncoders(kLogStart, 0));
    writer.Close();
  }
  const CsvReport report = ExportCsv(log_, csv_, &types_);
  EXPECT_THAT(report.left_out, ElementsAre(StartsWith("THEIRS: its type")));
  ASSERT_EQ(report.files.size(), 2U);  // Two types on one channel.
  EXPECT_EQ(report.files[0].path, csv_ + "/A_B.waymark.encoders_t.csv");
  EXPECT_THAT(ErrorOf([&] { ExportCsv(log_, csv_, &types_); }),
              HasSubstr("exists"));
}

TEST_F(ExportTest, TumOfPoses) {
  WriteDrive();
  EXPECT_EQ(Tum("POSE").num_poses, 10);
  const auto lines = Lines(tum_);
  ASSERT_EQ(lines.size(), 10U);
  std::istringstream third(lines[2]);
  std::string time;
  std::array<double, 7> values{};
  third >> time;
  for (double& value : values) third >> value;
  EXPECT_EQ(time, "1700000000.400000");
  // Nine digits are written.
  EXPECT_NEAR(values[0], 1.0, 1e-8);
  EXPECT_NEAR(values[5], std::sin(0.1), 1e-8);
  EXPECT_NEAR(values[6], std::cos(0.1), 1e-8);
}

TEST_F(ExportTest, TumOfOtherTypes) {
  {
    LogWriter writer(log_);
    truth_t truth{};
    truth.utime = kLogStart;
    truth.x = 3.0;
    truth.heading = 1.0;
    writer.Write("TRUTH", truth);
    bot_pose_t pose{};
    pose.utime = kLogStart;
    pose.pos[1] = 4.0;
    pose.orientation[0] = 0.6;
    pose.orientation[3] = -0.8;
    writer.Write("POSE_BOT", pose);
    pose_t unknown = MakePose(kLogStart, 0);
    unknown.is_known = 0;
    writer.Write("POSE", unknown);
    writer.Close();
  }
  EXPECT_EQ(Tum("TRUTH").num_no_heading, 1);
  EXPECT_THAT(Lines(tum_), ElementsAre("1700000000.000000 3 0 0 0 0 0 1"));
  std::filesystem::remove(tum_);
  Tum("POSE_BOT");
  EXPECT_THAT(Lines(tum_), ElementsAre("1700000000.000000 0 4 0 0 0 -0.8 0.6"));
  std::filesystem::remove(tum_);
  EXPECT_EQ(Tum("POSE").num_unknown, 1);
}

TEST_F(ExportTest, TumErrorsAreOneClearLine) {
  WriteDrive();
  EXPECT_THAT(ErrorOf([&] { Tum("NONE"); }),
              HasSubstr("has no channel NONE, but ENCODERS, POSE"));
  EXPECT_THAT(ErrorOf([&] { Tum("ENCODERS"); }), HasSubstr("holds no pose"));
  Tum("POSE");
  EXPECT_THAT(ErrorOf([&] { Tum("POSE"); }), HasSubstr("exists"));
}

}  // namespace
}  // namespace waymark
