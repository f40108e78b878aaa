#include "tests/network/network_namespace.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace waymark {
namespace {

void Run(const char* command) {
  if (std::system(command) != 0) {
    throw std::runtime_error(std::string("failed: ") + command);
  }
}

}  // namespace

std::string EnterNetworkNamespace() {
  if (::unshare(CLONE_NEWNET) != 0) {
    return std::string("cannot make a network namespace: ") +
           std::strerror(errno);
  }
  Run("ip link set lo up");
  AddMulticastRoute();
  return {};
}

void RemoveMulticastRoute() {
  Run("ip route del 224.0.0.0/4 dev lo");
}

void AddMulticastRoute() {
  Run("ip route add 224.0.0.0/4 dev lo");
}

ReceiveBufferLimit::ReceiveBufferLimit() {
  fd_ = ::open("/proc/sys/net/core/rmem_max", O_RDWR | O_CLOEXEC);
  if (fd_ < 0) return;
  std::array<char, 32> text{};
  const ssize_t size = ::pread(fd_, text.data(), text.size() - 1, 0);
  before_.assign(text.data(), static_cast<std::size_t>(size < 0 ? 0 : size));
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return;
  watcher_ = ::fork();
  if (watcher_ == 0) {
    // Outlives the test by the time of one write, whatever ends it.
    ::close(ends[1]);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      ::signal(signal, SIG_IGN);
    }
    char none = 0;
    while (::read(ends[0], &none, 1) < 0 && errno == EINTR) {
    }
    const ssize_t written = ::pwrite(fd_, before_.data(), before_.size(), 0);
    ::_exit(written < 0 ? 1 : 0);
  }
  ::close(ends[0]);
  alive_fd_ = ends[1];
}

ReceiveBufferLimit::~ReceiveBufferLimit() {
  if (alive_fd_ >= 0) ::close(alive_fd_);
  if (watcher_ > 0) ::waitpid(watcher_, nullptr, 0);
  if (fd_ >= 0) ::close(fd_);
}

bool ReceiveBufferLimit::Set(std::int64_t num_bytes) {
  const std::string text = std::to_string(num_bytes) + '\n';
  return fd_ >= 0 && ::pwrite(fd_, text.data(), text.size(), 0) ==
                         static_cast<ssize_t>(text.size());
}

}  // namespace waymark
