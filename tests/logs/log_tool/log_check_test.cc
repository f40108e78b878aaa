#include "logs/log_tool/log_check.h"

#include "tests/logs/log_tool/log_maker.h"

#include <waymark/velocity_t.hpp>

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
  static void WriteCommand(LogWriter* writer,
                           const std::string& source,
                           int seq,
                           std::int64_t utime,
                           const std::string& channel = "MOTION_COMMAND") {
    velocity_t message{};
    message.utime = utime;
    message.seq = seq;
    message.source = source;
    std::vector<std::uint8_t> data(
        static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(data.data(), 0, message.getEncodedSize());
    writer->Write(TimeFromMicroseconds(kLogStart), channel, data);
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
        int seq = 0;
        for (const int late : {0, 100, 50, 200, 0}) {
          const encoders_t message = MakeEncoders(kLogStart + late, seq++);
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

// A message that was overtaken is late, whoever sent it.
TEST_F(LogCheckTest, OvertakenMessagesAreNoSecondSender) {
  const Finding finding = OnlyFinding(
      [](LogWriter* writer) {
        for (const int i : {100, 101, 103, 102, 104, 105, 107, 106, 108}) {
          WriteCommand(writer, "a", i, kLogStart + i);
        }
      },
      false);
  EXPECT_EQ(finding.kind, FindingKind::kTimeBackwards);
  EXPECT_EQ(finding.num_events, 2);
}

// Times may be others then: a robot that starts again, in a simulation of its
// own time.
TEST_F(LogCheckTest, ASenderThatStartsAgainIsNoFault) {
  const Finding finding = OnlyFinding(
      [](LogWriter* writer) {
        for (int i = 0; i < 200; ++i) {
          WriteCommand(writer, "a", i, kLogStart + 1000 * i);
        }
        for (int i = 1; i < 400; ++i) {
          WriteCommand(writer, "a", i, kLogStart + 1000 * i);
        }
      },
      true);
  EXPECT_EQ(finding.kind, FindingKind::kRestart);
  EXPECT_EQ(finding.num_events, 1);
  EXPECT_EQ(finding.detail, "number 1 of 'a'");
}

// One of them runs longer, or they begin together: one finding either way.
TEST_F(LogCheckTest, TwoSendersOfOneName) {
  for (const int ahead : {0, 3, 500}) {
    const Finding finding = OnlyFinding(
        [&](LogWriter* writer) {
          for (int i = 0; i < 800; ++i) {
            WriteCommand(writer, "a", i, kLogStart + 1000 * i);
            if (i < ahead) continue;
            // Its clock is late.
            WriteCommand(writer, "a", i - ahead, kLogStart + 1000 * i - 20'000);
          }
        },
        false);
    EXPECT_EQ(finding.kind, FindingKind::kMixedSenders) << ahead;
    EXPECT_EQ(finding.channel, "MOTION_COMMAND");
    EXPECT_GT(finding.num_events, 100);
    std::filesystem::remove(log_);
  }
}

// The guard answers two who ask by clocks of their own, under the name of the
// one that it lets drive.
TEST_F(LogCheckTest, AnswersCarryTheTimesOfThoseWhoAsk) {
  LogWriter writer(log_);
  for (int i = 0; i < 50; ++i) {
    const std::int64_t follower = kLogStart + 50'000 * i;
    const std::int64_t teleop = follower - 20'000;  // A clock that is late.
    WriteCommand(&writer, "follower", i, follower, "MOTION_REQUEST");
    WriteCommand(&writer, "follower", 2 * i, follower);
    WriteCommand(&writer, "teleop", i, teleop, "MOTION_REQUEST");
    WriteCommand(&writer, "follower", 2 * i + 1, teleop);
  }
  writer.Close();
  const LogCheck check = Check();
  EXPECT_TRUE(check.is_sound());
  EXPECT_TRUE(check.findings.empty());
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
