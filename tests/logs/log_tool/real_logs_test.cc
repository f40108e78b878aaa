// Recordings made by others with lcm-logger.
#include "logs/log_tool/log_check.h"
#include "logs/log_tool/log_summary.h"
#include "tests/support/real_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace waymark {
namespace {

LogSummary Summarise(const std::string& path) {
  TypeTable types("");
  return SummariseLog(path, &types);
}

std::map<std::string, std::int64_t> CountsOf(const LogSummary& summary) {
  std::map<std::string, std::int64_t> counts;
  for (const auto& channel : summary.channels) {
    counts[channel.channel] = channel.num_events;
  }
  return counts;
}

TEST(RealLogsTest, CountsEqualThoseFoundIndependently) {
  const std::string folder = RealDataFolder("lcm_maebot_logs");
  if (folder.empty()) GTEST_SKIP() << "no real recordings";
  const LogSummary convex = Summarise(folder + "/rob550_convex.log");
  EXPECT_EQ(convex.report.num_events, 5714);
  EXPECT_TRUE(convex.report.is_sound());
  EXPECT_NEAR(SecondsBetween(convex.first, convex.last), 69.1, 0.05);
  EXPECT_EQ(CountsOf(convex),
            (std::map<std::string, std::int64_t>{{"MAEBOT_ENCODERS", 3422},
                                                 {"MAEBOT_IMU", 1376},
                                                 {"RPLIDAR_LASER", 459},
                                                 {"SLAM_POSE", 457}}));
  const LogSummary a0 = Summarise(folder + "/eecs467_a0.log");
  EXPECT_EQ(a0.report.num_events, 5069);
  EXPECT_NEAR(SecondsBetween(a0.first, a0.last), 81.9, 0.05);
  const LogSummary square =
      Summarise(folder + "/eecs467_square_laser_file.log");
  EXPECT_EQ(square.report.num_events, 4299);
  EXPECT_NEAR(SecondsBetween(square.first, square.last), 67.0, 0.05);
}

TEST(RealLogsTest, KnownTypesDecodeThroughout) {
  const std::string folder = RealDataFolder("lcm_maebot_logs");
  if (folder.empty()) GTEST_SKIP() << "no real recordings";
  TypeTable types("");
  for (const char* name : {"rob550_convex.log",
                           "eecs467_a0.log",
                           "eecs467_square_laser_file.log"}) {
    for (const auto& finding : CheckLog(folder + "/" + name, &types).findings) {
      EXPECT_NE(finding.kind, FindingKind::kNotDecodable)
          << name << " " << finding.channel << " " << finding.detail;
    }
  }
  const LogSummary convex = Summarise(folder + "/rob550_convex.log");
  std::map<std::string, std::string> type_of;
  for (const auto& channel : convex.channels) {
    type_of[channel.channel] = channel.types.at(0);
  }
  EXPECT_EQ(type_of["MAEBOT_ENCODERS"], "maebot.encoders_t");
  EXPECT_EQ(type_of["RPLIDAR_LASER"], "maebot.laser_t");
  EXPECT_EQ(type_of["SLAM_POSE"], "maebot.pose_t");
}

}  // namespace
}  // namespace waymark
