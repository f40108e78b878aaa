#include "drivers/wheels/last_words.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string>

namespace waymark {
namespace {

// In the child of a process that may have threads: system calls only.
[[noreturn]] void WaitAndWrite(int pipe_fd,
                               int device_fd,
                               const std::uint8_t* bytes,
                               std::size_t size) {
  ::setsid();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    ::signal(signal, SIG_IGN);
  }
  constexpr int kPipe = 0;
  constexpr int kDevice = 1;
  // Neither may be where the other goes to.
  const int pipe_copy = ::fcntl(pipe_fd, F_DUPFD, 10);
  const int device_copy = ::fcntl(device_fd, F_DUPFD, 10);
  if (::dup2(pipe_copy, kPipe) < 0 || ::dup2(device_copy, kDevice) < 0) {
    ::_exit(1);
  }
  // All else: sockets and terminals that others wait to see closed.
  ::close_range(2, ~0u, 0);
  char byte = 0;
  while (::read(kPipe, &byte, 1) < 0 && errno == EINTR) {
  }
  const ssize_t written = ::write(kDevice, bytes, size);
  ::_exit(written == static_cast<ssize_t>(size) ? 0 : 1);
}

}  // namespace

LastWords::LastWords(int device_fd, const Bytes& bytes) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
  }
  child_ = ::fork();
  if (child_ == 0) WaitAndWrite(ends[0], device_fd, bytes.data(), bytes.size());
  const int reason = errno;
  ::close(ends[0]);
  pipe_ = ends[1];
  if (child_ < 0) {
    ::close(pipe_);
    throw std::runtime_error(std::string("no process: ") +
                             std::strerror(reason));
  }
}

LastWords::~LastWords() {
  ::close(pipe_);
  while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace waymark
