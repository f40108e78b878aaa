#include "logs/import/write_imported_log.h"

#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"
#include "tests/logs/import/import_test_tools.h"
#include "tests/support/temporary_directory.h"

#include <waymark/config_t.hpp>
#include <waymark/planar_lidar_t.hpp>
#include <waymark/truth_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A drive of 10 s with everything that a recording can hold.
Recording FullRecording() {
  const WheelParameters wheels{1e-4, 1.1e-4, 0.2};
  Recording recording;
  recording.format = "made";
  recording.name = "full \"run\"";
  recording.reference.source = "overhead camera";
  recording.reference.p_RS = {0.03, 0.0};
  recording.reference.sigma = {0.006, 0.006, 0.1};
  recording.notes = {"first", "second: \\ \"quoted\""};
  for (const SimulatedReading& reading : NoiselessDrive(wheels, 10.0, 10.0)) {
    EncoderReading encoders;
    encoders.time = reading.time;
    encoders.seq = static_cast<std::int64_t>(recording.encoders.size());
    encoders.right = static_cast<std::int64_t>(reading.right_ticks);
    encoders.left = static_cast<std::int64_t>(reading.left_ticks);
    recording.encoders.push_back(encoders);
    TruthSample sample;
    sample.time = reading.time;
    sample.p_RS = recording.reference.p_RS;
    sample.p_WS = reading.X_WR * sample.p_RS;
    sample.heading = reading.X_WR.heading;
    recording.reference.samples.push_back(sample);
  }
  const Time first = recording.encoders[0].time;
  recording.nominal = NominalParameters(first, wheels, {1e-6, 2e-6, 0.01});
  recording.start = StatedStart(first, {0.3, -0.2, 0.7}, {0.01, 0.02, 0.03});
  RelativeMotion motion;
  motion.from = first;
  motion.time = recording.encoders[5].time;
  motion.source = "scan matching";
  motion.X_S0S1 = {0.1, 0.01, -0.1};
  motion.X_RS = {0.0, 0.0, -1.5};
  recording.motions.push_back(motion);
  RangeScan scan;
  scan.time = recording.encoders[7].time + Duration(5);
  scan.first_angle = -1.0;
  scan.step = 0.5;
  scan.ranges = {1.0f, 2.0f, 3.0f};
  recording.scans.push_back(scan);
  return recording;
}

std::vector<LogEvent> ReadEvents(const std::string& path) {
  std::vector<LogEvent> events;
  LogReader reader(path);
  while (auto event = reader.Next()) events.push_back(std::move(*event));
  EXPECT_TRUE(reader.report().is_sound());
  return events;
}

TEST(WriteImportedLogTest, EverythingComesBackInOrder) {
  const TemporaryDirectory folder;
  const Recording recording = FullRecording();
  const std::string path = folder / "out.log";
  const ImportSummary summary =
      WriteImportedLog(recording, {}, path, IfExists::kFail);
  const auto events = ReadEvents(path);
  EXPECT_EQ(summary.num_events, static_cast<std::int64_t>(events.size()));
  std::map<std::string, int> counts;
  std::vector<std::string> first_channels;
  for (std::size_t i = 0; i < events.size(); ++i) {
    ++counts[events[i].channel];
    EXPECT_GE(events[i].time, events[i == 0 ? 0 : i - 1].time);
    if (i < 5) first_channels.push_back(events[i].channel);
  }
  EXPECT_THAT(first_channels,
              ElementsAre("CONFIG",
                          "ODOMETRY_PARAMETERS",
                          "INITIAL_POSE",
                          "ENCODERS",
                          "POSITION_FIX"));
  EXPECT_THAT(counts,
              ElementsAre(testing::Pair("CONFIG", 1),
                          testing::Pair("ENCODERS", 101),
                          testing::Pair("INITIAL_POSE", 1),
                          testing::Pair("ODOMETRY_PARAMETERS", 1),
                          testing::Pair("POSITION_FIX", 11),
                          testing::Pair("RANGES", 1),
                          testing::Pair("RELATIVE_MOTION", 1),
                          testing::Pair("TRUTH", 90)));
  EXPECT_EQ(summary.num_encoders, 101);
  EXPECT_EQ(summary.num_fixes, 11);
  EXPECT_EQ(summary.num_truth, 90);
  EXPECT_DOUBLE_EQ(summary.duration_s, 10.0);
  EXPECT_NEAR(summary.path_m, 2.0, 0.1);
}

TEST(WriteImportedLogTest, MessagesSayWhatTheRecordingSays) {
  const TemporaryDirectory folder;
  Recording recording = FullRecording();
  recording.has_virtual_ticks = true;
  recording.virtual_resolution = "1e-06 m of wheel travel";
  const std::string path = folder / "out.log";
  WriteImportedLog(recording, {}, path, IfExists::kFail);
  std::size_t num_encoders = 0;
  std::size_t num_truth = 0;
  std::string reason;
  for (const LogEvent& event : ReadEvents(path)) {
    if (const auto m = DecodeAs<encoders_t>(event)) {
      const auto reading = EncoderReadingFromMessage(*m, &reason);
      ASSERT_TRUE(reading) << reason;
      EXPECT_EQ(reading->time, recording.encoders[num_encoders].time);
      EXPECT_EQ(reading->right, recording.encoders[num_encoders].right);
      EXPECT_EQ(reading->left, recording.encoders[num_encoders].left);
      EXPECT_TRUE(m->is_virtual);
      EXPECT_EQ(m->counter_bits, 0);
      EXPECT_EQ(m->seq, static_cast<std::int32_t>(num_encoders++));
    } else if (const auto fix = DecodeAs<position_fix_t>(event)) {
      EXPECT_TRUE(AbsoluteFixFromMessage(*fix, &reason)) << reason;
      EXPECT_EQ(fix->sensor_R[0], 0.03);
    } else if (const auto truth = DecodeAs<truth_t>(event)) {
      EXPECT_EQ(truth->source, "overhead camera");
      EXPECT_EQ(truth->sensor_R[0], 0.03);
      EXPECT_TRUE(truth->has_heading);
      EXPECT_EQ(truth->seq, static_cast<std::int32_t>(num_truth++));
    } else if (const auto motion = DecodeAs<relative_motion_t>(event)) {
      const auto value = RelativeMotionFromMessage(*motion, &reason);
      ASSERT_TRUE(value) << reason;
      EXPECT_EQ(value->from, recording.motions[0].from);
      EXPECT_EQ(value->X_S0S1, recording.motions[0].X_S0S1);
      EXPECT_EQ(value->X_RS, recording.motions[0].X_RS);
    } else if (const auto pose = DecodeAs<initial_pose_t>(event)) {
      const auto value = InitialPoseFromMessage(*pose, &reason);
      ASSERT_TRUE(value) << reason;
      EXPECT_EQ(value->X_WR, recording.start->X_WR);
      EXPECT_EQ(value->covariance, recording.start->covariance);
    } else if (const auto p = DecodeAs<odometry_parameters_t>(event)) {
      const auto value = OdometryParametersFromMessage(*p, &reason);
      ASSERT_TRUE(value) << reason;
      EXPECT_EQ(value->source, "nominal");
      EXPECT_EQ(value->parameters, recording.nominal.parameters);
      EXPECT_EQ(value->covariance, recording.nominal.covariance);
    } else if (const auto scan = DecodeAs<planar_lidar_t>(event)) {
      EXPECT_EQ(scan->ranges, recording.scans[0].ranges);
      EXPECT_EQ(scan->radstep, 0.5f);
    } else {
      const auto config = DecodeAs<config_t>(event);
      ASSERT_TRUE(config) << event.channel;
      EXPECT_EQ(config->process, "waymark-log import");
      EXPECT_THAT(config->yaml, HasSubstr("recording: \"full \\\"run\\\"\"\n"));
      EXPECT_THAT(config->yaml,
                  HasSubstr("virtual_tick: \"1e-06 m of wheel travel\"\n"));
      EXPECT_THAT(config->yaml, HasSubstr("every: 10\nnoise_m: 0.02\n"));
      EXPECT_THAT(
          config->yaml,
          HasSubstr("  - \"first\"\n  - \"second: \\\\ \\\"quoted\\\"\"\n"));
    }
  }
  EXPECT_EQ(num_encoders, 101u);
  EXPECT_EQ(num_truth, 90u);
}

TEST(WriteImportedLogTest, CalibrationHasNoTruth) {
  const TemporaryDirectory folder;
  ReferenceSplitOptions options;
  options.use = ReferenceUse::kCalibration;
  const ImportSummary summary = WriteImportedLog(
      FullRecording(), options, folder / "out.log", IfExists::kFail);
  EXPECT_EQ(summary.num_fixes, 101);
  EXPECT_EQ(summary.num_truth, 0);
}

TEST(WriteImportedLogTest, SameInputSameBytes) {
  const TemporaryDirectory folder;
  WriteImportedLog(FullRecording(), {}, folder / "a.log", IfExists::kFail);
  WriteImportedLog(FullRecording(), {}, folder / "b.log", IfExists::kFail);
  EXPECT_EQ(ReadBytes(folder / "a.log"), ReadBytes(folder / "b.log"));
}

TEST(WriteImportedLogTest, ExistingLogsStayUnlessReplaced) {
  const TemporaryDirectory folder;
  const std::string path = folder / "out.log";
  WriteText(path, "precious");
  EXPECT_THAT(InputErrorOf([&] {
                WriteImportedLog(FullRecording(), {}, path, IfExists::kFail);
              }),
              HasSubstr("out.log: exists already"));
  EXPECT_EQ(ReadBytes(path).size(), 8u);
  WriteImportedLog(FullRecording(), {}, path, IfExists::kReplace);
  EXPECT_GT(ReadEvents(path).size(), 200u);
}

TEST(WriteImportedLogTest, NothingIsLeftWhereWritingFails) {
  const TemporaryDirectory folder;
  const std::string path = folder / "none/out.log";
  EXPECT_NE(InputErrorOf([&] {
              WriteImportedLog(FullRecording(), {}, path, IfExists::kFail);
            }),
            "no error");
  // A folder of that name cannot be replaced by a file.
  std::filesystem::create_directory(folder / "folder.log");
  WriteText(folder / "folder.log/x", "x");
  EXPECT_THAT(
      InputErrorOf([&] {
        WriteImportedLog(
            FullRecording(), {}, folder / "folder.log", IfExists::kReplace);
      }),
      HasSubstr("folder.log: "));
  EXPECT_FALSE(std::filesystem::exists(folder / "folder.log.part"));
}

}  // namespace
}  // namespace waymark
