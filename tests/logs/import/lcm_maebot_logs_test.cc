#include "logs/import/lcm_maebot_logs.h"

#include "processes/support/log_file.h"
#include "tests/logs/import/import_test_tools.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

namespace waymark {
namespace {

using testing::Contains;
using testing::EndsWith;
using testing::HasSubstr;

constexpr std::uint64_t kEncodersType = 0x7d090bfb221d74f9;
constexpr std::uint64_t kMotorFeedbackType = 0x8dc5a028fca42ff9;
constexpr std::uint64_t kPoseType = 0x1f317af1246276ac;
constexpr std::uint64_t kLaserType = 0x89dc5b879a5056cf;
// A date, as the robots' clocks have it.
constexpr std::int64_t kDate = 1'447'367'745'000'000;

// The bytes of a message, member by member.
class Bytes {
 public:
  explicit Bytes(std::uint64_t type) { Put(type, 8); }
  Bytes& Int64(std::int64_t value) {
    return Put(static_cast<std::uint64_t>(value), 8);
  }
  Bytes& Int32(std::int32_t value) {
    return Put(static_cast<std::uint32_t>(value), 4);
  }
  Bytes& Float(double value) {
    return Put(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
  }
  [[nodiscard]] const std::vector<std::uint8_t>& data() const { return data_; }

 private:
  Bytes& Put(std::uint64_t value, int num_bytes) {
    for (int i = num_bytes - 1; i >= 0; --i) {
      data_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    return *this;
  }
  std::vector<std::uint8_t> data_;
};

Bytes Encoders(std::int64_t utime, std::int32_t left, std::int32_t right) {
  return Bytes(kEncodersType).Int64(utime).Int32(left).Int32(right);
}
Bytes MotorFeedback(std::int64_t utime, std::int32_t left, std::int32_t right) {
  Bytes bytes(kMotorFeedbackType);
  bytes.Int64(utime).Int32(left).Int32(right).Int32(7).Int32(7);
  for (int i = 0; i < 4; ++i) bytes.Float(0.25);
  return bytes;
}
Bytes PoseBytes(std::int64_t utime, const Pose2& X_WR) {
  return Bytes(kPoseType).Int64(utime).Float(X_WR.x).Float(X_WR.y).Float(
      X_WR.heading);
}
Bytes Laser(std::int64_t utime, const std::vector<double>& angles) {
  Bytes bytes(kLaserType);
  bytes.Int64(utime).Int32(static_cast<std::int32_t>(angles.size()));
  for (std::size_t i = 0; i < angles.size(); ++i) {
    bytes.Float(1.0 + static_cast<double>(i));
  }
  for (const double angle : angles) bytes.Float(angle);
  for (std::size_t i = 0; i < angles.size(); ++i) bytes.Int64(utime);
  for (std::size_t i = 0; i < angles.size(); ++i) bytes.Float(9.0);
  return bytes;
}

class MaebotTest : public testing::Test {
 protected:
  void Add(std::int64_t event_utime,
           const std::string& channel,
           const Bytes& bytes) {
    writer_.Write(TimeFromMicroseconds(event_utime), channel, bytes.data());
  }
  Recording Read() {
    writer_.Close();
    return ReadMaebotLog(path_);
  }
  TemporaryDirectory folder_;
  std::string path_ = folder_ / "bot.log";
  LogWriter writer_{path_};
};

// The log's host runs a year ahead of the robot, whose clocks agree.
TEST_F(MaebotTest, DriveComesBackOnTheRobotsClock) {
  const double k = kPi * 0.032 / 1200.0;
  const auto drive = NoiselessDrive({k, k, 0.080}, 50.0, 40.0);
  const std::int64_t year = 31'000'000'000'000;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    const std::int64_t utime = kDate + (drive[i].time - drive[0].time).count();
    // Events are late by up to 40 ms.
    const std::int64_t event = utime + year + 10'000 * static_cast<int>(i % 5);
    Add(event,
        "MAEBOT_ENCODERS",
        Encoders(utime,
                 static_cast<std::int32_t>(drive[i].left_ticks) + 344092,
                 static_cast<std::int32_t>(drive[i].right_ticks) + 475427));
    if (i % 7 == 0) Add(event, "SLAM_POSE", PoseBytes(utime, drive[i].X_WR));
  }
  const Recording recording = Read();
  ASSERT_EQ(recording.encoders.size(), drive.size());
  EXPECT_EQ(recording.encoders[0].left, 344092);
  EXPECT_EQ(recording.encoders[0].right, 475427);
  EXPECT_EQ(Microseconds(recording.encoders[0].time), kDate);
  EXPECT_EQ(recording.reference.samples.size(), (drive.size() + 6) / 7);
  EXPECT_EQ(recording.start->time, recording.reference.samples[0].time);
  // Poses are floats: some 1e-7 m and rad.
  EXPECT_LT(NominalRmse(recording), 1e-5);
}

TEST_F(MaebotTest, EventTimesWhereTheClockCountsFromBoot) {
  for (int i = 0; i < 10; ++i) {
    const std::int64_t event = kDate + 50'000 * i;
    Add(event,
        "MAEBOT_MOTOR_FEEDBACK",
        MotorFeedback(2'265'000'000 + 50'000 * i, 10 * i, 20 * i));
    // Dates, 130 ms old on arrival: kept.
    Add(event, "MAEBOT_LASER_SCAN", Laser(event - 130'000, {0.1, 0.2, 0.3}));
    // Stuck: replaced by event times.
    Add(event + 5, "SLAM_POSE", PoseBytes(7'363'956'200, {0.1, 0.2, 0.3}));
  }
  const Recording recording = Read();
  ASSERT_EQ(recording.encoders.size(), 10u);
  ASSERT_EQ(recording.scans.size(), 10u);
  ASSERT_EQ(recording.reference.samples.size(), 10u);
  for (int i = 0; i < 10; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const std::int64_t event = kDate + 50'000 * i;
    EXPECT_EQ(Microseconds(recording.encoders[n].time), event);
    EXPECT_EQ(recording.encoders[n].left, 10 * i);
    EXPECT_EQ(recording.encoders[n].right, 20 * i);
    EXPECT_EQ(Microseconds(recording.scans[n].time), event - 130'000);
    EXPECT_EQ(Microseconds(recording.reference.samples[n].time), event + 5);
  }
  // 480 ticks a turn in these logs.
  EXPECT_DOUBLE_EQ(recording.nominal.parameters.k_left, kPi * 0.032 / 480.0);
  EXPECT_THAT(recording.notes, Contains(HasSubstr("pose: event times")));
}

TEST_F(MaebotTest, OtherMessagesAreCountedNotLost) {
  Add(kDate, "MAEBOT_ENCODERS", Encoders(kDate, 1, 2));
  Add(kDate + 20'000, "MAEBOT_ENCODERS", Encoders(kDate + 20'000, 1, 2));
  Add(kDate + 20'001, "MAEBOT_ENCODERS", Encoders(kDate + 20'000, 1, 3));
  for (int i = 0; i < 3; ++i) {
    Add(kDate, "MAEBOT_IMU", Bytes(0xed966784146237ec).Int64(1));
  }
  writer_.Write(TimeFromMicroseconds(kDate),
                "LCM_SELF_TEST",
                std::vector<std::uint8_t>{'l', 'c', 'm'});
  Add(kDate, "RPLIDAR_LASER", Laser(kDate, {0.0, 0.1, 0.25}));
  const Recording recording = Read();
  EXPECT_EQ(recording.encoders.size(), 2u);
  EXPECT_TRUE(recording.scans.empty());
  EXPECT_FALSE(recording.start);
  EXPECT_THAT(recording.notes,
              testing::IsSupersetOf(
                  {HasSubstr("encoders: 1 messages left out"),
                   HasSubstr("1 laser scans left out: beams not evenly"),
                   HasSubstr("left out: 1 LCM_SELF_TEST, 3 MAEBOT_IMU")}));
}

TEST_F(MaebotTest, EvenBeamsMayPassTheFullTurn) {
  Add(kDate, "MAEBOT_ENCODERS", Encoders(kDate, 1, 2));
  Add(kDate, "LASER", Laser(kDate, {6.1, 6.2, 6.3 - 2.0 * kPi, 0.1168}));
  const Recording recording = Read();
  ASSERT_EQ(recording.scans.size(), 1u);
  EXPECT_NEAR(recording.scans[0].step, 0.1, 1e-6);
  EXPECT_FLOAT_EQ(recording.scans[0].ranges[3], 4.0f);
}

TEST_F(MaebotTest, CountersWrapAt32Bits) {
  const std::int32_t max = std::numeric_limits<std::int32_t>::max();
  Add(kDate, "E", Encoders(kDate, max - 1, -max));
  Add(kDate + 20'000, "E", Encoders(kDate + 20'000, -max, max));
  Add(kDate + 40'000, "E", Encoders(kDate + 40'000, -max + 5, max - 5));
  const Recording recording = Read();
  const std::int64_t big = max;
  EXPECT_EQ(recording.encoders[1].left, big + 2);  // 3 further on.
  EXPECT_EQ(recording.encoders[2].left, big + 7);
  EXPECT_EQ(recording.encoders[1].right, -big - 2);  // 2 back.
  EXPECT_EQ(recording.encoders[2].right, -big - 7);
}

TEST_F(MaebotTest, DamageBetweenRecordsIsSkippedAndTold) {
  for (int i = 0; i < 4; ++i) {
    Add(kDate + i, "E", Encoders(kDate + i, i, i));
  }
  writer_.Close();
  auto bytes = ReadBytes(path_);
  bytes.resize(bytes.size() - 5);  // Torn end.
  WriteBytes(path_, bytes);
  const Recording recording = ReadMaebotLog(path_);
  EXPECT_EQ(recording.encoders.size(), 3u);
  EXPECT_THAT(recording.notes,
              Contains(HasSubstr("48 bytes in 1 place skipped")));
}

TEST_F(MaebotTest, BadMessagesNameTheirEvent) {
  Add(kDate, "E", Encoders(kDate, 1, 2));
  Add(kDate, "E", Bytes(kEncodersType).Int64(kDate).Int32(1));
  EXPECT_THAT(InputErrorOf([&] { (void)Read(); }),
              EndsWith("bot.log: event 1 (E): is cut short"));
}

TEST_F(MaebotTest, PosesMustBeFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Add(kDate, "E", Encoders(kDate, 1, 2));
  Add(kDate, "SLAM_POSE", PoseBytes(kDate, {0.0, nan, 0.0}));
  EXPECT_THAT(InputErrorOf([&] { (void)Read(); }),
              EndsWith("event 1 (SLAM_POSE): has a number that is not finite"));
}

TEST_F(MaebotTest, LengthsMustFit) {
  Add(kDate, "E", Encoders(kDate, 1, 2));
  Add(kDate, "L", Bytes(kLaserType).Int64(kDate).Int32(2'000'000'000));
  EXPECT_THAT(InputErrorOf([&] { (void)Read(); }),
              EndsWith("event 1 (L): states 2000000000 beams, has 0"));
}

TEST_F(MaebotTest, HostileStampsAreNoClock) {
  const std::int64_t min = std::numeric_limits<std::int64_t>::min();
  Add(kDate, "E", Encoders(min, 1, 2));
  Add(kDate + 1, "E", Encoders(std::numeric_limits<std::int64_t>::max(), 1, 2));
  Add(kDate + 1, "SLAM_POSE", PoseBytes(min, {}));
  const Recording recording = Read();
  EXPECT_EQ(Microseconds(recording.encoders[0].time), kDate);
  EXPECT_EQ(Microseconds(recording.reference.samples[0].time), kDate + 1);
}

TEST_F(MaebotTest, LogsWithoutEncodersAreRefused) {
  Add(kDate, "SLAM_POSE", PoseBytes(kDate, {}));
  EXPECT_THAT(InputErrorOf([&] { (void)Read(); }),
              EndsWith("no MAEBot encoder or motor feedback messages in it"));
}

}  // namespace
}  // namespace waymark
