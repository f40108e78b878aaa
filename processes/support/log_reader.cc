#include "processes/support/log_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace waymark {
namespace {

constexpr std::int64_t kWindowBytes = 256 * 1024;
constexpr std::int64_t kSyncBytes = 4;

template <typename Integer>
Integer FromBigEndian(const std::uint8_t* bytes) {
  std::make_unsigned_t<Integer> value = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    value = static_cast<decltype(value)>(value << 8 | bytes[i]);
  }
  return static_cast<Integer>(value);
}

// Random access to a file through one window, so that small records cost no
// system call each.
class WindowedFile {
 public:
  explicit WindowedFile(const std::string& path) : path_(path) {
    fd_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd_ < 0) {
      throw InputError(path + ": cannot be opened: " + std::strerror(errno));
    }
    struct stat status {};
    const bool known = fstat(fd_, &status) == 0;
    if (!known || !S_ISREG(status.st_mode)) {
      close(fd_);
      throw InputError(path + (S_ISDIR(status.st_mode)
                                   ? ": is a directory, not an LCM log"
                                   : ": is not a regular file"));
    }
    size_ = status.st_size;
  }
  ~WindowedFile() { close(fd_); }
  WindowedFile(const WindowedFile&) = delete;
  WindowedFile& operator=(const WindowedFile&) = delete;

  [[nodiscard]] std::int64_t size() const { return size_; }
  [[nodiscard]] const std::string& path() const { return path_; }

  // Copies bytes that lie in the file. `move_window` says that reading goes on
  // from here.
  void Read(std::int64_t offset,
            std::span<std::uint8_t> out,
            bool move_window = true) {
    const auto n = static_cast<std::int64_t>(out.size());
    if (offset < start_ || offset + n > start_ + length_) {
      if (!move_window || n > kWindowBytes) return ReadFile(offset, out);
      start_ = offset;
      length_ = std::min(kWindowBytes, size_ - offset);
      window_.resize(static_cast<std::size_t>(kWindowBytes));
      const auto length = static_cast<std::size_t>(length_);
      length_ = 0;  // Should the read throw, the window holds nothing.
      ReadFile(offset, std::span(window_).first(length));
      length_ = static_cast<std::int64_t>(length);
    }
    std::copy_n(window_.begin() + (offset - start_), n, out.begin());
  }

  // First offset in [from, to) at which a sync word starts; `to` if none does.
  std::int64_t FindSync(std::int64_t from, std::int64_t to) {
    constexpr std::array<std::uint8_t, 4> kSync = {0xED, 0xA1, 0xDA, 0x01};
    to = std::min(to, size_);
    while (from < to && size_ - from >= kSyncBytes) {
      std::array<std::uint8_t, kSyncBytes> first;
      Read(from, first);  // Brings `from` into the window.
      const auto begin = window_.begin() + (from - start_);
      const auto end = window_.begin() + length_;
      const auto hit = std::search(begin, end, kSync.begin(), kSync.end());
      if (hit != end) return std::min(to, from + (hit - begin));
      // A sync word may lie across the end of the window.
      from += (end - begin) - (kSyncBytes - 1);
    }
    return to;
  }

 private:
  void ReadFile(std::int64_t offset, std::span<std::uint8_t> out) const {
    while (!out.empty()) {
      const ssize_t n = pread(fd_, out.data(), out.size(), offset);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        throw InputError(path_ + ": cannot be read at byte " +
                         std::to_string(offset) + ": " +
                         (n < 0 ? std::strerror(errno) : "file has shrunk"));
      }
      offset += n;
      out = out.subspan(static_cast<std::size_t>(n));
    }
  }

  std::string path_;
  int fd_ = -1;
  std::int64_t size_ = 0;
  std::vector<std::uint8_t> window_;
  std::int64_t start_ = 0;
  std::int64_t length_ = 0;
};

bool HasControlCharacter(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  });
}

}  // namespace

class LogReader::Impl {
 public:
  explicit Impl(const std::string& path) : file_(path) {
    report_.num_file_bytes = file_.size();
    if (file_.size() == 0) {
      throw InputError(path + ": is empty, not an LCM log");
    }
    // A log torn within its first record is a log without events; a file that
    // neither starts with a sync word nor holds a record is something else.
    if (!StartsWithSync(0) && !FindRecord(0, file_.size())) {
      throw InputError(path + ": is not an LCM log (no record in its " +
                       std::to_string(file_.size()) + " bytes)");
    }
  }

  std::optional<LogEvent> Next() {
    const std::int64_t expected = offset_;
    const auto record = NextRecord();
    const std::int64_t start = record ? record->offset : file_.size();
    if (start > expected) AddGap(expected, start - expected, !record);
    offset_ = start;
    if (!record) return std::nullopt;

    LogEvent event;
    event.number = record->number;
    event.time = TimeFromMicroseconds(record->utime);
    event.channel = record->channel;
    event.data.resize(static_cast<std::size_t>(record->num_data_bytes));
    file_.Read(record->end() - record->num_data_bytes, event.data);
    event_offset_ = start;
    offset_ = record->end();
    last_number_ = record->number;
    ++report_.num_events;
    return event;
  }

  [[nodiscard]] const LogReadReport& report() const { return report_; }
  [[nodiscard]] std::int64_t offset() const { return offset_; }
  [[nodiscard]] std::int64_t event_offset() const { return event_offset_; }
  [[nodiscard]] const std::string& path() const { return file_.path(); }

 private:
  struct Record {
    std::int64_t offset = 0;
    std::int64_t number = 0;
    std::int64_t utime = 0;
    std::int64_t num_data_bytes = 0;
    std::string channel;
    [[nodiscard]] std::int64_t end() const {
      return offset + kLogHeaderBytes +
             static_cast<std::int64_t>(channel.size()) + num_data_bytes;
    }
  };

  // The sync word, or as much of it as the file still holds.
  bool StartsWithSync(std::int64_t offset) {
    std::array<std::uint8_t, 4> bytes = {0xED, 0xA1, 0xDA, 0x01};
    const std::int64_t n = std::min(kSyncBytes, file_.size() - offset);
    file_.Read(offset,
               std::span(bytes).first(static_cast<std::size_t>(n)),
               /*move_window=*/false);
    return FromBigEndian<std::uint32_t>(bytes.data()) == kLogSync;
  }

  // A possible record at `offset` that ends within the file.
  std::optional<Record> ParseRecord(std::int64_t offset) {
    if (file_.size() - offset < kLogHeaderBytes) return std::nullopt;
    std::array<std::uint8_t, kLogHeaderBytes> header;
    file_.Read(offset, header);
    const auto num_channel_bytes = FromBigEndian<std::int32_t>(&header[20]);
    Record record{offset,
                  FromBigEndian<std::int64_t>(&header[4]),
                  FromBigEndian<std::int64_t>(&header[12]),
                  FromBigEndian<std::int32_t>(&header[24]),
                  {}};
    if (FromBigEndian<std::uint32_t>(header.data()) != kLogSync ||
        num_channel_bytes < 1 || num_channel_bytes > kMaxLogChannelBytes ||
        record.num_data_bytes < 0 || record.num_data_bytes > kMaxLogDataBytes ||
        record.number < 0 ||
        record.num_data_bytes >
            file_.size() - offset - kLogHeaderBytes - num_channel_bytes) {
      return std::nullopt;
    }
    record.channel.resize(static_cast<std::size_t>(num_channel_bytes));
    file_.Read(offset + kLogHeaderBytes,
               {reinterpret_cast<std::uint8_t*>(record.channel.data()),
                record.channel.size()});
    if (HasControlCharacter(record.channel)) return std::nullopt;
    return record;
  }

  // A whole record: possible, and followed by the next one or the end.
  std::optional<Record> ParseWholeRecord(std::int64_t offset) {
    auto record = ParseRecord(offset);
    if (!record || !StartsWithSync(record->end())) return std::nullopt;
    return record;
  }

  // Whether a whole record starts in [from, to). What was scanned before is
  // not scanned again, or a hostile file would cost its size squared.
  bool WholeRecordStartsIn(std::int64_t from, std::int64_t to) {
    if (from >= scanned_from_ && from < scanned_to_)
      from = scanned_to_;
    else
      scanned_from_ = from;
    while (from < to) {
      from = file_.FindSync(from, to);
      if (from < to && ParseWholeRecord(from)) {
        scanned_to_ = from;  // Found again by the next question.
        return true;
      }
      if (from < to) ++from;
    }
    scanned_to_ = std::max(from, to);
    return false;
  }

  // The record at `offset`, if it can be believed (see LogReader).
  std::optional<Record> ParseCredibleRecord(std::int64_t offset,
                                            bool at_boundary) {
    auto record = ParseRecord(offset);
    if (!record || StartsWithSync(record->end())) return record;
    const bool continues = at_boundary || record->number > last_number_;
    if (!continues || WholeRecordStartsIn(offset + kSyncBytes, record->end())) {
      return std::nullopt;
    }
    return record;
  }

  std::optional<Record> FindRecord(std::int64_t from, std::int64_t to) {
    while ((from = file_.FindSync(from, to)) < to) {
      if (auto record = ParseCredibleRecord(from, false)) return record;
      ++from;
    }
    return std::nullopt;
  }

  std::optional<Record> NextRecord() {
    if (offset_ >= file_.size()) return std::nullopt;
    if (auto record = ParseCredibleRecord(offset_, true)) return record;
    return FindRecord(offset_ + 1, file_.size());
  }

  void AddGap(std::int64_t offset, std::int64_t num_bytes, bool at_end) {
    ++report_.num_gaps;
    report_.num_skipped_bytes += num_bytes;
    report_.torn_end = at_end;
    if (report_.gaps.size() < LogReadReport::kMaxListedGaps) {
      report_.gaps.push_back({offset, num_bytes, report_.num_events});
    }
  }

  WindowedFile file_;
  LogReadReport report_;
  std::int64_t offset_ = 0;
  std::int64_t event_offset_ = 0;
  std::int64_t last_number_ = -1;
  // No whole record starts in [scanned_from_, scanned_to_).
  std::int64_t scanned_from_ = 0;
  std::int64_t scanned_to_ = 0;
};

LogReader::LogReader(const std::string& path)
    : impl_(std::make_unique<Impl>(path)) {}
LogReader::~LogReader() = default;
LogReader::LogReader(LogReader&&) noexcept = default;
LogReader& LogReader::operator=(LogReader&&) noexcept = default;

std::optional<LogEvent> LogReader::Next() {
  return impl_->Next();
}
std::string LogReadReport::SkippedText() const {
  return std::to_string(num_skipped_bytes) + " bytes in " +
         std::to_string(num_gaps) + (num_gaps == 1 ? " place" : " places");
}

const LogReadReport& LogReader::report() const {
  return impl_->report();
}
std::int64_t LogReader::offset() const {
  return impl_->offset();
}
std::int64_t LogReader::event_offset() const {
  return impl_->event_offset();
}
const std::string& LogReader::path() const {
  return impl_->path();
}

}  // namespace waymark
