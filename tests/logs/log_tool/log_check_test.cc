#include "logs/log_tool/log_check.h"

#include "tests/logs/log_tool/log_maker.h"

#include <gmock/gmock.h>

#include <limits>

namespace waymark {
namespace {

using testing::HasSubstr;

class LogCheckTest : public LogToolTest {
 protected:
  LogCheck Check() {
    TypeTable types("");
    return CheckLog(log_, &types);
  }
  // The only finding of a log that `write` makes.
  template <typename Write>
  Finding OnlyFinding(const Write& write, bool expect_sound) {
    {
      LogWriter writer(log_);
      write(&writer);
      writer.Close();
    }
    const LogCheck check = Check();
    EXPECT_EQ(check.is_sound(), expect_sound);
    EXPECT_EQ(check.findings.size(), 1U);
    return check.findings.empty() ? Finding{} : check.findings[0];
  }
};

TEST_F(LogCheckTest, SoundLog) {
  WriteDrive();
  const LogCheck check = Check();
  EXPECT_TRUE(check.is_sound());
  EXPECT_TRUE(check.findings.empty());
}

TEST_F(LogCheckTest, DamageIsNotSound) {
  WriteDrive();
  auto bytes = ReadBytes(log_);
  bytes.pop_back();
  WriteBytes(log_, bytes);
  EXPECT_FALSE(Check().is_sound());
}

TEST_F(LogCheckTest, NumbersThatAreNotFinite) {
  const Finding finding = OnlyFinding(
      [](LogWriter* writer) {
        writer->Write("POSE", MakePose(kLogStart, 0));
        pose_t pose = MakePose(kLogStart + 1, 1);
        pose.pose_W[1] = std::numeric_limits<double>::quiet_NaN();
        writer->Write("POSE", pose);
        pose.pose_W[1] = std::numeric_limits<double>::infinity();
        writer->Write("POSE", pose);
      },
      false);
  EXPECT_EQ(finding.kind, FindingKind::kNotFinite);
  EXPECT_EQ(finding.num_events, 2);
  EXPECT_EQ(finding.first_event, 1);
  EXPECT_EQ(finding.first_offset, 28 + 4 + MakePose(0, 0).getEncodedSize());
  EXPECT_EQ(finding.detail, "pose_W[1] is nan");
}

TEST_F(LogCheckTest, UtimeBackwards) {
  const Finding finding = OnlyFinding(
      [](LogWriter* writer) {
        const Time time = TimeFromMicroseconds(kLogStart);
        for (const int late : {0, 100, 50, 200, 0}) {
          const encoders_t message = MakeEncoders(kLogStart + late, late);
          std::vector<std::uint8_t> data(
              static_cast<std::size_t>(message.getEncodedSize()));
          message.encode(data.data(), 0, message.getEncodedSize());
          writer->Write(time, "ENCODERS", data);
        }
      },
      false);
  EXPECT_EQ(finding.kind, FindingKind::kTimeBackwards);
  EXPECT_EQ(finding.channel, "ENCODERS");
  EXPECT_EQ(finding.num_events, 2);
  EXPECT_EQ(finding.first_event, 2);
  EXPECT_EQ(finding.detail, "by 0.000050 s");
  EXPECT_NEAR(finding.worst_step_s, 200e-6, 1e-6);
}

// Loggers reorder events a little; a step of the clock is a fault.
TEST_F(LogCheckTest, EventTimeBackwards) {
  for (const std::int64_t step : {99'000, 101'000}) {
    const Finding finding = OnlyFinding(
        [&](LogWriter* writer) {
          writer->Write("ENCODERS", MakeEncoders(kLogStart, 0));
          writer->Write("POSE", MakePose(kLogStart - step, 0));
        },
        step < 100'000);
    EXPECT_EQ(finding.kind, FindingKind::kEventTimeBackwards);
    std::filesystem::remove(log_);
  }
}

TEST_F(LogCheckTest, BytesThatDoNotDecode) {
  const Finding finding = OnlyFinding(
      [](LogWriter* writer) {
        const pose_t pose = MakePose(kLogStart, 0);
        std::vector<std::uint8_t> data(
            static_cast<std::size_t>(pose.getEncodedSize()));
        pose.encode(data.data(), 0, pose.getEncodedSize());
        data.pop_back();
        writer->Write(TimeFromMicroseconds(kLogStart), "POSE", data);
      },
      false);
  EXPECT_EQ(finding.kind, FindingKind::kNotDecodable);
  EXPECT_EQ(finding.detail, "waymark.pose_t: it ends within num_rejected");
}

TEST_F(LogCheckTest, UnknownTypesAreNoFault) {
  const Finding finding = OnlyFinding(
      [](LogWriter* writer) {
        writer->Write(TimeFromMicroseconds(kLogStart),
                      "THEIRS",
                      std::vector<std::uint8_t>(9, 1));
      },
      true);
  EXPECT_EQ(finding.kind, FindingKind::kUnknownType);
  EXPECT_THAT(finding.detail, HasSubstr("0101010101010101"));
}

}  // namespace
}  // namespace waymark
