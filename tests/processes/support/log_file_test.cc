#include "processes/support/log_file.h"

#include "estimation/base/random.h"
#include "tests/support/temporary_directory.h"

#include <waymark/encoders_t.hpp>
#include <waymark/pose_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace waymark {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

template <typename Function>
std::string ErrorOf(const Function& function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

bool SameEvent(const LogEvent& a, const LogEvent& b) {
  return a.number == b.number && a.time == b.time && a.channel == b.channel &&
         a.data == b.data;
}

struct Contents {
  std::vector<LogEvent> events;
  LogReadReport report;
};

Contents ReadLog(const std::string& path) {
  LogReader reader(path);
  Contents result;
  while (auto event = reader.Next()) result.events.push_back(std::move(*event));
  result.report = reader.report();
  return result;
}

// The bytes that are in no event: must be all that are reported as skipped.
std::int64_t BytesOf(const std::vector<LogEvent>& events) {
  std::int64_t sum = 0;
  for (const auto& event : events) {
    sum += kLogHeaderBytes +
           static_cast<std::int64_t>(event.channel.size() + event.data.size());
  }
  return sum;
}

class LogFileTest : public testing::Test {
 protected:
  // Sizes differ, so that a wrong boundary cannot go unseen.
  std::vector<LogEvent> WriteSmallLog(int num_events) {
    LogWriter writer(log_);
    std::vector<LogEvent> events;
    for (int i = 0; i < num_events; ++i) {
      LogEvent event{i,
                     TimeFromMicroseconds(1'000'000 + 1000 * i),
                     i % 2 == 0 ? "POSE" : "ENCODERS",
                     Bytes(static_cast<std::size_t>(3 * i + (i == 2 ? 0 : 5)),
                           static_cast<std::uint8_t>(0x40 + i))};
      if (i == 3) event.data.clear();
      writer.Write(event.time, event.channel, event.data);
      events.push_back(event);
    }
    writer.Close();
    return events;
  }

  // Reads `bytes` as a log and checks that what is not in an event was
  // counted as skipped.
  Contents ReadDamaged(const Bytes& bytes) {
    WriteBytes(damaged_, bytes);
    Contents read = ReadLog(damaged_);
    EXPECT_EQ(BytesOf(read.events) + read.report.num_skipped_bytes,
              static_cast<std::int64_t>(bytes.size()));
    EXPECT_EQ(read.report.num_events,
              static_cast<std::int64_t>(read.events.size()));
    std::int64_t listed = 0;
    for (const auto& gap : read.report.gaps) listed += gap.num_bytes;
    EXPECT_EQ(listed, read.report.num_skipped_bytes);
    return read;
  }

  static int CountSaved(const std::vector<LogEvent>& original,
                        const std::vector<LogEvent>& read) {
    return static_cast<int>(
        std::count_if(original.begin(), original.end(), [&](const LogEvent& a) {
          return std::any_of(read.begin(), read.end(), [&](const LogEvent& b) {
            return SameEvent(a, b);
          });
        }));
  }

  TemporaryDirectory directory_{TemporaryDirectory::FastParent()};
  std::string log_ = directory_ / "a.log";
  std::string damaged_ = directory_ / "damaged.log";
};

TEST_F(LogFileTest, RoundTripKeepsEverything) {
  const auto events = WriteSmallLog(20);
  const auto read = ReadLog(log_);
  ASSERT_EQ(read.events.size(), events.size());
  EXPECT_EQ(CountSaved(events, read.events), 20);
  EXPECT_TRUE(read.report.is_sound());
  EXPECT_FALSE(read.report.torn_end);
  EXPECT_EQ(read.report.num_skipped_bytes, 0);
}

TEST_F(LogFileTest, LcmReadsWhatWeWrite) {
  const auto events = WriteSmallLog(20);
  lcm::LogFile file(log_, "r");
  ASSERT_TRUE(file.good());
  for (const auto& event : events) {
    const lcm::LogEvent* theirs = file.readNextEvent();
    ASSERT_NE(theirs, nullptr);
    EXPECT_EQ(theirs->eventnum, event.number);
    EXPECT_EQ(theirs->timestamp, Microseconds(event.time));
    EXPECT_EQ(theirs->channel, event.channel);
    const auto* data = static_cast<const std::uint8_t*>(theirs->data);
    EXPECT_EQ(Bytes(data, data + theirs->datalen), event.data);
  }
  EXPECT_EQ(file.readNextEvent(), nullptr);
}

TEST_F(LogFileTest, ReadsWhatLcmWrites) {
  {
    lcm::LogFile file(log_, "w");
    Bytes data = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    for (int i = 0; i < 5; ++i) {
      lcm::LogEvent event{
          0, 500 + i, "CHANNEL", static_cast<std::int32_t>(i), data.data()};
      ASSERT_EQ(file.writeEvent(&event), 0);
    }
  }
  const auto read = ReadLog(log_);
  ASSERT_EQ(read.events.size(), 5U);
  EXPECT_TRUE(read.report.is_sound());
  for (int i = 0; i < 5; ++i) {
    const auto& event = read.events[static_cast<std::size_t>(i)];
    EXPECT_EQ(event.number, i);
    EXPECT_EQ(Microseconds(event.time), 500 + i);
    EXPECT_EQ(event.channel, "CHANNEL");
    EXPECT_EQ(event.data.size(), static_cast<std::size_t>(i));
  }
}

TEST_F(LogFileTest, TruncatedAtEveryByteKeepsAllWholeRecords) {
  const auto events = WriteSmallLog(6);
  const Bytes bytes = ReadBytes(log_);
  for (std::size_t length = 1; length < bytes.size(); ++length) {
    SCOPED_TRACE(length);
    std::size_t num_whole = 0;
    std::int64_t end = 0;
    for (; num_whole < events.size(); ++num_whole) {
      const std::int64_t next = end + BytesOf({events[num_whole]});
      if (next > static_cast<std::int64_t>(length)) break;
      end = next;
    }
    const auto read = ReadDamaged(Bytes(bytes.begin(), bytes.begin() + length));
    ASSERT_EQ(read.events.size(), num_whole);
    for (std::size_t i = 0; i < num_whole; ++i) {
      EXPECT_TRUE(SameEvent(read.events[i], events[i]));
    }
    const bool at_boundary = end == static_cast<std::int64_t>(length);
    EXPECT_EQ(read.report.torn_end, !at_boundary);
    EXPECT_EQ(read.report.num_gaps, at_boundary ? 0 : 1);
  }
}

TEST_F(LogFileTest, OneFlippedBitCostsAtMostOneEvent) {
  const auto events = WriteSmallLog(6);
  const Bytes bytes = ReadBytes(log_);
  for (std::size_t i = 0; i < 8 * bytes.size(); ++i) {
    SCOPED_TRACE(i);
    Bytes flipped = bytes;
    flipped[i / 8] ^= static_cast<std::uint8_t>(1U << i % 8);
    EXPECT_GE(CountSaved(events, ReadDamaged(flipped).events), 5);
  }
}

TEST_F(LogFileTest, BytesRemovedAnywhereCostAtMostTheirEvents) {
  const auto events = WriteSmallLog(8);
  const Bytes bytes = ReadBytes(log_);
  for (std::size_t from = 0; from < bytes.size(); ++from) {
    for (const std::size_t length : {1U, 4U, 29U}) {
      SCOPED_TRACE(std::to_string(from) + " " + std::to_string(length));
      Bytes cut = bytes;
      const auto to = std::min(from + length, bytes.size());
      cut.erase(cut.begin() + static_cast<std::ptrdiff_t>(from),
                cut.begin() + static_cast<std::ptrdiff_t>(to));
      // 29 bytes touch at most two events: each has at least 32.
      EXPECT_GE(CountSaved(events, ReadDamaged(cut).events), 6);
    }
  }
}

TEST_F(LogFileTest, GarbageInsertedAnywhereCostsAtMostOneEvent) {
  const auto events = WriteSmallLog(6);
  const Bytes bytes = ReadBytes(log_);
  for (std::size_t at = 0; at <= bytes.size(); ++at) {
    SCOPED_TRACE(at);
    Random random(at);
    Bytes damaged = bytes;
    Bytes garbage(100);
    for (auto& byte : garbage) {
      byte = static_cast<std::uint8_t>(random.Index(256));
    }
    damaged.insert(damaged.begin() + static_cast<std::ptrdiff_t>(at),
                   garbage.begin(),
                   garbage.end());
    const auto read = ReadDamaged(damaged);
    EXPECT_GE(CountSaved(events, read.events), 5);
    EXPECT_GE(read.report.num_gaps, 1);
  }
}

TEST_F(LogFileTest, GapsSayWhereAndHowMuch) {
  const auto events = WriteSmallLog(4);
  Bytes bytes = ReadBytes(log_);
  const std::int64_t first = BytesOf({events[0]});
  bytes.insert(bytes.begin() + first, 17, 0xAB);
  bytes.push_back(0xED);
  const auto read = ReadDamaged(bytes);
  EXPECT_EQ(CountSaved(events, read.events), 4);
  ASSERT_EQ(read.report.gaps.size(), 2U);
  EXPECT_EQ(read.report.gaps[0].offset, first);
  EXPECT_EQ(read.report.gaps[0].num_bytes, 17);
  EXPECT_EQ(read.report.gaps[0].num_events_before, 1);
  EXPECT_EQ(read.report.gaps[1].num_bytes, 1);
  EXPECT_TRUE(read.report.torn_end);
}

// A payload that holds sync words, and even whole log records, is one event.
TEST_F(LogFileTest, SyncWordsInsideAPayloadStartNothing) {
  WriteSmallLog(3);
  const Bytes inner = ReadBytes(log_);
  Bytes payload(64, 0x55);
  for (int i = 0; i < 5; ++i) {
    const Bytes sync = {0xED, 0xA1, 0xDA, 0x01};
    payload.insert(payload.end(), sync.begin(), sync.end());
  }
  Bytes with_log = payload;
  with_log.insert(with_log.end(), inner.begin(), inner.end());
  const std::string outer = directory_ / "outer.log";
  {
    LogWriter writer(outer);
    writer.Write(TimeFromMicroseconds(1), "IMAGE", payload);
    writer.Write(TimeFromMicroseconds(2), "FILE", with_log);
    writer.Write(TimeFromMicroseconds(3), "IMAGE", payload);
    writer.Close();
  }
  const auto read = ReadLog(outer);
  ASSERT_EQ(read.events.size(), 3U);
  EXPECT_EQ(read.events[1].data, with_log);
  EXPECT_TRUE(read.report.is_sound());

  // The first record's length is damaged: its payload's sync words must not be
  // taken for records while looking for the second.
  Bytes damaged = ReadBytes(outer);
  damaged[24] = 0x7f;
  const auto rest = ReadDamaged(damaged);
  ASSERT_EQ(rest.events.size(), 2U);
  EXPECT_EQ(rest.events[0].data, with_log);
  EXPECT_EQ(rest.report.num_gaps, 1);
}

// Sync words with a possible header, none of them a record: reading must not
// take time quadratic in the file's size.
TEST_F(LogFileTest, HostileHeadersCostLinearTime) {
  Bytes bytes;
  constexpr std::uint32_t kSize = 4'000'000;
  while (bytes.size() < kSize) {
    const Bytes header = {0xED, 0xA1, 0xDA, 0x01, 0x7f, 0, 0, 0, 0,  0,
                          0,    0,    0,    0,    0,    0, 0, 0, 0,  0,
                          0,    0,    0,    1,    0,    8, 0, 0, 'A'};
    bytes.insert(bytes.end(), header.begin(), header.end());
  }
  const auto read = ReadDamaged(bytes);
  EXPECT_LE(read.events.size(), 10U);
}

TEST_F(LogFileTest, LargeEventsCrossTheWindow) {
  std::vector<LogEvent> events;
  {
    LogWriter writer(log_);
    for (int i = 0; i < 8; ++i) {
      LogEvent event{i,
                     TimeFromMicroseconds(i),
                     "IMAGE",
                     Bytes(static_cast<std::size_t>(100'003 * i), 0xED)};
      writer.Write(event.time, event.channel, event.data);
      events.push_back(event);
    }
    writer.Close();
    EXPECT_EQ(writer.num_bytes(),
              static_cast<std::int64_t>(std::filesystem::file_size(log_)));
  }
  const auto read = ReadLog(log_);
  EXPECT_EQ(CountSaved(events, read.events), 8);
  EXPECT_TRUE(read.report.is_sound());
}

TEST_F(LogFileTest, ErrorsAreOneClearLine) {
  EXPECT_THAT(ErrorOf([&] { LogReader reader(directory_ / "none.log"); }),
              AllOf(HasSubstr("none.log"), HasSubstr("No such file")));
  EXPECT_THAT(ErrorOf([&] { LogReader reader("/tmp"); }),
              HasSubstr("is a directory"));
  EXPECT_THAT(ErrorOf([&] { LogReader reader("/dev/null"); }),
              HasSubstr("not a regular file"));
  WriteBytes(damaged_, {});
  EXPECT_THAT(ErrorOf([&] { LogReader reader(damaged_); }),
              HasSubstr("is empty"));
  WriteBytes(damaged_, Bytes{0xFF, 0xD8, 0xFF, 0xE0, 0, 16, 'J', 'F', 'I'});
  EXPECT_THAT(ErrorOf([&] { LogReader reader(damaged_); }),
              AllOf(HasSubstr("damaged.log"), HasSubstr("not an LCM log")));
  EXPECT_THAT(ErrorOf([&] { LogWriter writer(damaged_); }),
              AllOf(HasSubstr("damaged.log"), HasSubstr("exists")));
  EXPECT_THAT(ErrorOf([&] { LogWriter writer(directory_ / "no/a.log"); }),
              HasSubstr("cannot be created"));
}

TEST_F(LogFileTest, RefusingToReplaceLeavesTheFileAlone) {
  WriteSmallLog(3);
  const Bytes before = ReadBytes(log_);
  EXPECT_THROW(LogWriter writer(log_), InputError);
  EXPECT_EQ(ReadBytes(log_), before);
  { LogWriter writer(log_, IfExists::kReplace); }
  EXPECT_TRUE(ReadBytes(log_).empty());
}

TEST_F(LogFileTest, FullDeviceIsOneClearLine) {
  LogWriter writer("/dev/full", IfExists::kReplace);
  writer.Write(TimeFromMicroseconds(1), "POSE", Bytes(10));
  EXPECT_THAT(ErrorOf([&] { writer.Close(); }),
              AllOf(HasSubstr("/dev/full"),
                    HasSubstr("No space left"),
                    HasSubstr("42 more did not fit")));
  writer.Close();  // Closed by the failure: nothing is left to do.
}

// On a full disk the file keeps whole records only.
TEST_F(LogFileTest, FullDiskLeavesAReadableLog) {
  const std::string mount = directory_ / "small";
  std::filesystem::create_directory(mount);
  const std::string command =
      "mount -t tmpfs -o size=1m tmpfs " + mount + " 2>/dev/null";
  if (std::system(command.c_str()) != 0) {
    GTEST_SKIP() << "mounting a small file system needs root";
  }
  const std::string path = mount + "/full.log";
  std::string error;
  {
    LogWriter writer(path);
    error = ErrorOf([&] {
      for (int i = 0; i < 2000; ++i) {
        writer.Write(TimeFromMicroseconds(i), "POSE", Bytes(1001));
      }
      writer.Close();
    });
  }
  const auto read = ReadLog(path);
  std::system(("umount " + mount).c_str());
  EXPECT_THAT(error, AllOf(HasSubstr("full.log"), HasSubstr("No space left")));
  EXPECT_GT(read.events.size(), 900U);
  EXPECT_TRUE(read.report.is_sound());
}

TEST_F(LogFileTest, DecodeAsNeedsTypeAndLength) {
  encoders_t message{};
  message.utime = 77;
  message.left_ticks = -5;
  {
    LogWriter writer(log_);
    writer.Write("ENCODERS", message);
    writer.Close();
  }
  LogEvent event = ReadLog(log_).events.at(0);
  EXPECT_EQ(Microseconds(event.time), 77);
  const auto decoded = DecodeAs<encoders_t>(event);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->left_ticks, -5);
  EXPECT_FALSE(DecodeAs<pose_t>(event));
  event.data.push_back(0);
  EXPECT_FALSE(DecodeAs<encoders_t>(event));
  event.data.resize(event.data.size() - 2);
  EXPECT_FALSE(DecodeAs<encoders_t>(event));
  event.data.resize(7);
  EXPECT_FALSE(DecodeAs<encoders_t>(event));
}

}  // namespace
}  // namespace waymark
