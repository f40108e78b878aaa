#include "drivers/wheels/serial_port.h"

#include <fcntl.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

struct BaudRate {
  int baud;
  speed_t speed;
};
constexpr std::array<BaudRate, 6> kBaudRates{{{9600, B9600},
                                              {19200, B19200},
                                              {38400, B38400},
                                              {57600, B57600},
                                              {115200, B115200},
                                              {230400, B230400}}};

speed_t SpeedOf(int baud) {
  for (const BaudRate& rate : kBaudRates) {
    if (rate.baud == baud) return rate.speed;
  }
  throw std::invalid_argument(
      "baud = " + std::to_string(baud) +
      " must be 9600, 19200, 38400, 57600, 115200 or 230400");
}

}  // namespace

SerialPort::SerialPort(std::string device, int baud)
    : device_(std::move(device)), speed_(SpeedOf(baud)) {}

SerialPort::~SerialPort() {
  Close();
}

void SerialPort::Close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
  unsent_.clear();
}

bool SerialPort::Fail(const char* what) {
  const int reason = errno;
  Close();
  error_ = device_ + ": " + what + ": " + std::strerror(reason);
  return false;
}

bool SerialPort::Open() {
  Close();
  // Without O_NONBLOCK opening waits for a modem.
  fd_ = ::open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) return Fail("cannot open");
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return Fail("cannot lock");
    Close();
    error_ = device_ + ": another process uses it";
    return false;
  }
  if (!Configure()) return Fail("is no serial port");
  error_.clear();
  return true;
}

bool SerialPort::Configure() {
  termios settings{};
  if (::tcgetattr(fd_, &settings) != 0) return false;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  // At least one byte: that a device is gone reads as none.
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  return ::cfsetispeed(&settings, speed_) == 0 &&
         ::cfsetospeed(&settings, speed_) == 0 &&
         ::tcsetattr(fd_, TCSANOW, &settings) == 0 &&
         ::tcflush(fd_, TCIOFLUSH) == 0;
}

std::optional<Bytes> SerialPort::Read() {
  if (!is_open()) return std::nullopt;
  Bytes bytes(4096);
  const ssize_t size = ::read(fd_, bytes.data(), bytes.size());
  if (size < 0 && errno != EAGAIN && errno != EINTR) {
    Fail("cannot read");
    return std::nullopt;
  }
  if (size == 0) {
    Close();
    error_ = device_ + ": was disconnected";
    return std::nullopt;
  }
  bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return bytes;
}

std::optional<std::size_t> SerialPort::WriteSome(
    std::span<const std::uint8_t> bytes) {
  const ssize_t size = ::write(fd_, bytes.data(), bytes.size());
  if (size >= 0) return static_cast<std::size_t>(size);
  if (errno == EAGAIN || errno == EINTR) return 0;
  Fail("cannot write");
  return std::nullopt;
}

bool SerialPort::Write(std::span<const std::uint8_t> bytes) {
  if (!is_open()) return false;
  if (!unsent_.empty()) {
    const std::optional<std::size_t> taken = WriteSome(unsent_);
    if (!taken) return false;
    unsent_.erase(unsent_.begin(),
                  unsent_.begin() + static_cast<std::ptrdiff_t>(*taken));
    if (!unsent_.empty()) return true;
  }
  const std::optional<std::size_t> taken = WriteSome(bytes);
  if (!taken) return false;
  if (*taken > 0) {
    const auto rest = bytes.subspan(*taken);
    unsent_.assign(rest.begin(), rest.end());
  }
  return true;
}

}  // namespace waymark
