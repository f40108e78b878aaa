#include "logs/log_tool/log_copy.h"

#include "tests/logs/log_tool/log_maker.h"

#include <gmock/gmock.h>

namespace waymark {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using LogCopyTest = LogToolTest;

std::optional<LogMoment> Moment(const std::string& text) {
  return LogMoment("--start", text);
}

TEST_F(LogCopyTest, RepairSavesAllWholeRecords) {
  WriteDrive();
  const auto events = ReadAll(log_);
  auto bytes = ReadBytes(log_);
  bytes[200] ^= 0xFF;  // Somewhere in a payload or header.
  bytes.insert(bytes.begin() + 700, 50, 0xEE);
  bytes.erase(bytes.end() - 3, bytes.end());
  WriteBytes(log_, bytes);
  const LogCopyReport report = CopyLog(log_, out_, {});
  EXPECT_FALSE(report.read.is_sound());
  EXPECT_GE(report.num_events, 27);
  EXPECT_EQ(
      report.num_bytes,
      static_cast<std::int64_t>(bytes.size()) - report.read.num_skipped_bytes);
  LogReader reader(out_);
  std::int64_t number = 0;
  while (const auto event = reader.Next()) EXPECT_EQ(event->number, number++);
  EXPECT_EQ(number, report.num_events);
  EXPECT_TRUE(reader.report().is_sound());
}

TEST_F(LogCopyTest, CopyOfASoundLogIsTheSameBytes) {
  WriteDrive();
  CopyLog(log_, out_, {});
  EXPECT_EQ(ReadBytes(log_), ReadBytes(out_));
}

TEST_F(LogCopyTest, CutsJoinWithoutLossOrDoubles) {
  WriteDrive();
  LogCopyOptions first;
  first.end = Moment("0.8");
  LogCopyOptions second;
  second.start = Moment("0.8");
  const std::string other = directory_ / "other.log";
  CopyLog(log_, out_, first);
  CopyLog(log_, other, second);
  auto joined = ReadAll(out_);
  EXPECT_EQ(joined.size(), 12U);  // 8 encoders and 4 poses before 0.8 s.
  for (auto& event : ReadAll(other)) joined.push_back(std::move(event));
  const auto all = ReadAll(log_);
  ASSERT_EQ(joined.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(joined[i].time, all[i].time);
    EXPECT_EQ(joined[i].data, all[i].data);
  }
}

TEST_F(LogCopyTest, MomentsSinceTheEpoch) {
  WriteDrive();
  LogCopyOptions options;
  options.start = Moment(std::to_string(kLogStart + 1'500'000) + "us");
  EXPECT_EQ(CopyLog(log_, out_, options).num_events, 5 + 2);
}

TEST_F(LogCopyTest, Channels) {
  WriteDrive();
  LogCopyOptions options;
  options.channels = "PO.*|NONE";
  EXPECT_EQ(CopyLog(log_, out_, options).num_events, 10);
  options.invert_channels = true;
  options.if_exists = IfExists::kReplace;
  EXPECT_EQ(CopyLog(log_, out_, options).num_events, 20);
  EXPECT_EQ(ReadAll(out_).at(0).channel, "ENCODERS");
}

TEST_F(LogCopyTest, BadRequestsAreOneClearLine) {
  WriteDrive();
  const auto copy = [&](const LogCopyOptions& options) {
    return ErrorOf([&] { CopyLog(log_, out_, options); });
  };
  LogCopyOptions nothing;
  nothing.channels = "OSE";  // Whole names only.
  EXPECT_THAT(copy(nothing), HasSubstr("none of its 30 events"));
  EXPECT_FALSE(std::filesystem::exists(out_));
  LogCopyOptions backwards;
  backwards.start = {"--start", "0.2"};
  backwards.end = {"--end", "0.2"};
  EXPECT_THAT(copy(backwards), HasSubstr("--end: must be later than --start"));
  EXPECT_FALSE(std::filesystem::exists(out_));
  LogCopyOptions malformed;
  malformed.channels = "(";
  EXPECT_THAT(copy(malformed), HasSubstr("no regular expression"));
  EXPECT_FALSE(std::filesystem::exists(out_));
  for (const char* text :
       {"", "x", "-1", "1s", "nan", "inf", "1e300", "5 us"}) {
    EXPECT_THAT(ErrorOf([&] { Moment(text); }),
                AllOf(HasSubstr("--start"), HasSubstr(text)));
  }
}

TEST_F(LogCopyTest, NeverOverwritesWhatItShouldNot) {
  WriteDrive();
  const auto before = ReadBytes(log_);
  LogCopyOptions replace;
  replace.if_exists = IfExists::kReplace;
  EXPECT_THAT(ErrorOf([&] { CopyLog(log_, log_, replace); }),
              HasSubstr("is an input too"));
  WriteBytes(out_, before);
  EXPECT_THAT(ErrorOf([&] { CopyLog(log_, out_, {}); }), HasSubstr("exists"));
  EXPECT_EQ(ReadBytes(log_), before);
}

}  // namespace
}  // namespace waymark
