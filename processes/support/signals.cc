#include "processes/support/signals.h"

#include "estimation/base/check.h"

#include <pthread.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <csignal>

namespace waymark {
namespace {

sigset_t Watched() {
  sigset_t set;
  ::sigemptyset(&set);
  ::sigaddset(&set, SIGINT);
  ::sigaddset(&set, SIGTERM);
  return set;
}

}  // namespace

Signals::Signals() {
  const sigset_t set = Watched();
  ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
  fd_ = ::signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
  WAYMARK_CHECK(fd_ >= 0);
}

Signals::~Signals() {
  ::close(fd_);
  const sigset_t set = Watched();
  ::pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

bool Signals::Take() {
  signalfd_siginfo info{};
  return ::read(fd_, &info, sizeof(info)) == sizeof(info);
}

}  // namespace waymark
