// Reader of logs: whatever the bytes, every one is accounted for.
#include "processes/support/log_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace waymark::fuzz {
namespace {

void PutInteger(std::string* text, std::uint64_t value, int num_bytes) {
  for (int shift = 8 * (num_bytes - 1); shift >= 0; shift -= 8) {
    text->push_back(static_cast<char>(value >> shift));
  }
}

std::string Record(std::uint64_t number,
                   std::string_view channel,
                   std::string_view data) {
  std::string record;
  PutInteger(&record, kLogSync, 4);
  PutInteger(&record, number, 8);
  PutInteger(&record, 1'000'000'000 + 10'000 * number, 8);
  PutInteger(&record, channel.size(), 4);
  PutInteger(&record, data.size(), 4);
  return record.append(channel).append(data);
}

}  // namespace

void RunOne(Bytes data) {
  const MemoryFile file(data);
  TakesOrRefuses([&] {
    LogReader reader(file.path());
    std::int64_t num_bytes = 0;
    std::int64_t num_events = 0;
    while (const auto event = reader.Next()) {
      Expect(reader.event_offset() >= num_bytes, "records do not overlap");
      num_bytes += kLogHeaderBytes +
                   static_cast<std::int64_t>(event->channel.size()) +
                   static_cast<std::int64_t>(event->data.size());
      ++num_events;
    }
    const LogReadReport& report = reader.report();
    Expect(report.num_events == num_events, "events are counted");
    Expect(report.num_file_bytes == static_cast<std::int64_t>(data.size()),
           "the file's size is known");
    Expect(num_bytes + report.num_skipped_bytes == report.num_file_bytes,
           "read and skipped bytes make up the file");
    Expect(report.is_sound() == (report.num_skipped_bytes == 0),
           "sound where nothing was skipped");
  });
}

std::vector<std::string> Seeds() {
  std::string sound;
  for (std::uint64_t i = 0; i < 4; ++i) {
    sound += Record(i, "ENCODERS", std::string(40, static_cast<char>(i)));
  }
  std::string sync;
  PutInteger(&sync, kLogSync, 4);
  // A record within a record's data, bytes between records, a torn end.
  const std::string nested =
      Record(0, "IMAGE", "ab" + Record(7, "X", "") + sync);
  return {sound,
          nested + Record(1, "A", "data"),
          Record(0, "A", "") + "bytes between" + Record(1, "A", "b"),
          sound.substr(0, sound.size() - 5),
          sync + sync + sound,
          Record(3, "LAST", "1") + Record(0, "APPENDED", "2")};
}

}  // namespace waymark::fuzz
