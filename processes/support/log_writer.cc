#include "estimation/base/check.h"
#include "processes/support/log_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace waymark {
namespace {

// Enough that a system call is paid once per some hundred small messages.
constexpr std::size_t kBufferBytes = 256 * 1024;

template <typename Integer>
void AppendBigEndian(Integer value, std::vector<std::uint8_t>* out) {
  const auto bits = static_cast<std::make_unsigned_t<Integer>>(value);
  for (int shift = 8 * static_cast<int>(sizeof(bits)) - 8; shift >= 0;
       shift -= 8) {
    out->push_back(static_cast<std::uint8_t>(bits >> shift));
  }
}

}  // namespace

class LogWriter::Impl {
 public:
  Impl(const std::string& path, IfExists if_exists) : path_(path) {
    const int mode = if_exists == IfExists::kFail ? O_EXCL : O_TRUNC;
    fd_ = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | mode, 0644);
    if (fd_ < 0 && errno == EEXIST) {
      throw InputError(path + ": exists already; --force replaces it");
    }
    if (fd_ < 0) {
      throw InputError(path + ": cannot be created: " + std::strerror(errno));
    }
    buffer_.reserve(kBufferBytes);
  }

  ~Impl() {
    try {
      Close();
    } catch (const std::exception&) {
      // Close() is there for those who want to know.
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void Write(Time time,
             std::string_view channel,
             std::span<const std::uint8_t> data) {
    WAYMARK_CHECK(fd_ >= 0, path_, "is closed");
    WAYMARK_CHECK(!channel.empty() && channel.size() <= kMaxLogChannelBytes,
                  channel);
    WAYMARK_CHECK(data.size() <= kMaxLogDataBytes, channel, data.size());
    if (buffer_.size() + data.size() > kBufferBytes) Flush();
    AppendBigEndian(kLogSync, &buffer_);
    AppendBigEndian(num_events_, &buffer_);
    AppendBigEndian(Microseconds(time), &buffer_);
    AppendBigEndian(static_cast<std::int32_t>(channel.size()), &buffer_);
    AppendBigEndian(static_cast<std::int32_t>(data.size()), &buffer_);
    buffer_.insert(buffer_.end(), channel.begin(), channel.end());
    buffer_.insert(buffer_.end(), data.begin(), data.end());
    ++num_events_;
    if (buffer_.size() >= kBufferBytes) Flush();
  }

  void Flush() {
    if (fd_ < 0) return;
    std::size_t done = 0;
    while (done < buffer_.size()) {
      const ssize_t n =
          write(fd_, buffer_.data() + done, buffer_.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) Fail(done, n < 0 ? errno : ENOSPC);
      done += static_cast<std::size_t>(n);
    }
    num_flushed_bytes_ += static_cast<std::int64_t>(buffer_.size());
    buffer_.clear();
  }

  void Close() {
    if (fd_ < 0) return;
    Flush();
    // Some file systems report a full disk only here.
    const int result = close(std::exchange(fd_, -1));
    if (result != 0 && errno != EINTR) {
      throw InputError(path_ + ": " + std::strerror(errno) + " on closing");
    }
  }

  [[nodiscard]] std::int64_t num_events() const { return num_events_; }
  [[nodiscard]] std::int64_t num_bytes() const {
    return num_flushed_bytes_ + static_cast<std::int64_t>(buffer_.size());
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  // Where `num_written` bytes of the buffer reached the file: keeps its whole
  // records, gives up the rest.
  [[noreturn]] void Fail(std::size_t num_written, int error) {
    std::size_t whole = 0;
    while (true) {
      const std::size_t next = EndOfRecord(whole);
      if (next == whole || next > num_written) break;
      whole = next;
    }
    const auto kept = num_flushed_bytes_ + static_cast<std::int64_t>(whole);
    const std::string needed = std::to_string(buffer_.size() - num_written);
    // A device such as /dev/full cannot be cut; that changes nothing.
    [[maybe_unused]] const int cut = ftruncate(fd_, kept);
    close(std::exchange(fd_, -1));
    buffer_.clear();
    num_flushed_bytes_ = kept;
    throw InputError(path_ + ": " + std::strerror(error) + " (" +
                     std::to_string(kept) + " bytes written, " + needed +
                     " more did not fit)");
  }

  // Offset behind the record at `offset` of the buffer; `offset` at its end.
  [[nodiscard]] std::size_t EndOfRecord(std::size_t offset) const {
    if (offset >= buffer_.size()) return offset;
    const auto length = [&](std::size_t at) {
      std::size_t value = 0;
      for (int i = 0; i < 4; ++i) value = value << 8 | buffer_[at++];
      return value;
    };
    return offset + kLogHeaderBytes + length(offset + 20) + length(offset + 24);
  }

  std::string path_;
  int fd_ = -1;
  std::vector<std::uint8_t> buffer_;
  std::int64_t num_events_ = 0;
  std::int64_t num_flushed_bytes_ = 0;
};

LogWriter::LogWriter(const std::string& path, IfExists if_exists)
    : impl_(std::make_unique<Impl>(path, if_exists)) {}
LogWriter::~LogWriter() = default;
LogWriter::LogWriter(LogWriter&&) noexcept = default;
LogWriter& LogWriter::operator=(LogWriter&&) noexcept = default;

void LogWriter::Write(Time time,
                      std::string_view channel,
                      std::span<const std::uint8_t> data) {
  impl_->Write(time, channel, data);
}
void LogWriter::Flush() {
  impl_->Flush();
}
void LogWriter::Close() {
  impl_->Close();
}
std::int64_t LogWriter::num_events() const {
  return impl_->num_events();
}
std::int64_t LogWriter::num_bytes() const {
  return impl_->num_bytes();
}
const std::string& LogWriter::path() const {
  return impl_->path();
}

}  // namespace waymark
