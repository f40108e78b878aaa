#include "drivers/wheels/watchdog.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>

namespace waymark {
namespace {

// Where the child has them.
constexpr int kPipe = 0;
constexpr int kDevice = 1;

// Leaves the child with these two alone: sockets and terminals are others',
// who wait to see them closed.
void KeepOnly(int pipe_fd, int device_fd) {
  // Neither may be where the other goes to.
  constexpr int kAbove = 10;
  const int pipe_copy = ::fcntl(pipe_fd, F_DUPFD, kAbove);
  const int device_copy = ::fcntl(device_fd, F_DUPFD, kAbove);
  if (::dup2(pipe_copy, kPipe) < 0 || ::dup2(device_copy, kDevice) < 0) {
    ::_exit(1);
  }
  ::close_range(2, ~0u, 0);
}

// In the child of a process that may have threads: system calls only.
[[noreturn]] void Watch(std::span<const std::uint8_t> bytes, int timeout_ms) {
  ::setsid();
  ::prctl(PR_SET_NAME, "watchdog");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    ::signal(signal, SIG_IGN);
  }
  std::array<char, 256> beats{};
  int timeout = timeout_ms;
  while (true) {
    pollfd wait{kPipe, POLLIN, 0};
    const int ready = ::poll(&wait, 1, timeout);
    if (ready < 0) continue;
    timeout = timeout_ms;
    if (ready > 0 && ::read(kPipe, beats.data(), beats.size()) > 0) continue;
    const ssize_t written = ::write(kDevice, bytes.data(), bytes.size());
    if (ready > 0) {
      ::_exit(written == static_cast<ssize_t>(bytes.size()) ? 0 : 1);
    }
    timeout = -1;  // Said once; until the next beat.
  }
}

}  // namespace

Watchdog::Watchdog(int device_fd, const Bytes& bytes, double timeout_s) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
  }
  child_ = ::fork();
  if (child_ == 0) {
    KeepOnly(ends[0], device_fd);
    Watch(bytes, static_cast<int>(timeout_s * 1000.0));
  }
  const int reason = errno;
  ::close(ends[0]);
  pipe_ = ends[1];
  if (child_ < 0) {
    ::close(pipe_);
    throw std::runtime_error(std::string("no process: ") +
                             std::strerror(reason));
  }
  // A child that was stopped must not stop its parent.
  ::fcntl(pipe_, F_SETFL, O_NONBLOCK);
}

Watchdog::~Watchdog() {
  ::close(pipe_);
  while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void Watchdog::Beat() {
  const char beat = 0;
  // A full pipe is as good, and a child that is gone cannot be helped.
  [[maybe_unused]] const ssize_t written = ::write(pipe_, &beat, 1);
}

}  // namespace waymark
