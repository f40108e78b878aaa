// LCM log files: reading that survives damage, and writing.
//
// A log is a sequence of records without header, index or compression:
// sync word 0xEDA1DA01, event number (int64), time in microseconds since the
// epoch (int64), channel length (int32), data length (int32), channel bytes
// without NUL, data bytes; all big endian.
#pragma once

#include "estimation/base/input_error.h"
#include "estimation/base/time.h"
#include "processes/support/decode.h"
#include "processes/support/output_file.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

inline constexpr std::uint32_t kLogSync = 0xEDA1DA01;
inline constexpr std::int64_t kLogHeaderBytes = 28;
// What lcm::LogFile reads; LCM itself sends at most 63.
inline constexpr std::int32_t kMaxLogChannelBytes = 999;
inline constexpr std::int32_t kMaxLogDataBytes = 1 << 28;  // LCM's own limit.

struct LogEvent {
  std::int64_t number = 0;  // As stored; restarts where logs were appended.
  Time time;                // Receive time.
  std::string channel;
  std::vector<std::uint8_t> data;  // Fingerprint first.
};

// A range of bytes that belong to no readable record.
struct LogGap {
  std::int64_t offset = 0;
  std::int64_t num_bytes = 0;
  std::int64_t num_events_before = 0;  // Events read before it.
};

struct LogReadReport {
  std::int64_t num_events = 0;
  std::int64_t num_skipped_bytes = 0;
  std::int64_t num_gaps = 0;  // The torn end counts as one.
  bool torn_end = false;      // The last bytes are no whole record.
  std::vector<LogGap> gaps;   // The first kMaxListedGaps of them.
  std::int64_t num_file_bytes = 0;
  static constexpr std::size_t kMaxListedGaps = 1000;

  [[nodiscard]] bool is_sound() const { return num_gaps == 0; }
  // "12 bytes in 2 places".
  [[nodiscard]] std::string SkippedText() const;
};

// Reads a log from front to back in constant memory (one event and a small
// window of the file), whatever its size.
//
// A record counts as whole where its lengths are possible, its channel has no
// control characters, and the next sync word or the end of the file follows. A
// record that is followed by something else is taken too, unless a whole
// record starts inside it (then its length is what is damaged); away from a
// record boundary it must also continue the event numbers. So a sync word
// inside image data starts nothing. All other bytes are skipped up to the next
// record and reported. Payloads carry no checksum: a damaged one is found only
// when it fails to decode.
class LogReader {
 public:
  // Throws InputError where `path` cannot be read, is empty, or holds no LCM
  // record at all. A file that starts with a sync word but is torn within its
  // first record opens, and has no events.
  explicit LogReader(const std::string& path);
  ~LogReader();
  LogReader(LogReader&&) noexcept;
  LogReader& operator=(LogReader&&) noexcept;

  // The next event, nullopt at the end. Throws InputError where reading fails.
  std::optional<LogEvent> Next();

  // Complete once Next() has returned nullopt.
  [[nodiscard]] const LogReadReport& report() const;
  // Offset of the next byte to be looked at, for progress.
  [[nodiscard]] std::int64_t offset() const;
  // Offset of the record that Next() returned last.
  [[nodiscard]] std::int64_t event_offset() const;
  [[nodiscard]] const std::string& path() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// Writes a log; events are numbered from 0. Whole records reach the file, so a
// crash leaves at most a torn last one. Where the disk is full the file is cut
// back to its last whole record.
class LogWriter {
 public:
  // Throws InputError where `path` exists (kFail) or cannot be created.
  explicit LogWriter(const std::string& path,
                     IfExists if_exists = IfExists::kFail);
  // Closes; errors are lost, so call Close() first.
  ~LogWriter();
  LogWriter(LogWriter&&) noexcept;
  LogWriter& operator=(LogWriter&&) noexcept;

  // Channel of 1 to kMaxLogChannelBytes bytes, data of at most
  // kMaxLogDataBytes. Throws InputError (file, bytes, cause) where writing
  // fails; nothing can be written after that.
  void Write(Time time,
             std::string_view channel,
             std::span<const std::uint8_t> data);

  // The event's time is the message's utime.
  template <typename M>
  void Write(std::string_view channel, const M& message) {
    std::vector<std::uint8_t> data(
        static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(data.data(), 0, static_cast<int>(data.size()));
    Write(TimeFromMicroseconds(message.utime), channel, data);
  }

  // Hands everything written so far to the operating system.
  void Flush();
  // Flushes and closes. Does nothing when already closed.
  void Close();

  [[nodiscard]] std::int64_t num_events() const;
  [[nodiscard]] std::int64_t num_bytes() const;
  [[nodiscard]] const std::string& path() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// The event's message, nullopt where it is of another type or does not decode
// to exactly its length.
template <typename M>
[[nodiscard]] std::optional<M> DecodeAs(const LogEvent& event) {
  return DecodeMessage<M>(event.data);
}

}  // namespace waymark
