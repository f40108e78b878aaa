#include "processes/teleop/terminal.h"

#include "estimation/base/check.h"
#include "estimation/base/input_error.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

namespace waymark {
namespace {

constexpr std::array<int, 4> kDeadly{SIGHUP, SIGQUIT, SIGABRT, SIGSEGV};

// What a signal handler needs; set before the handlers are.
struct Saved {
  int fd = -1;
  termios settings{};
};
Saved g_saved;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

extern "C" void RestoreAndDie(int signal) {
  ::tcsetattr(g_saved.fd, TCSANOW, &g_saved.settings);
  // The default action was put back by SA_RESETHAND.
  ::raise(signal);
}

}  // namespace

Terminal::Terminal(int input_fd, int output_fd)
    : input_fd_(input_fd), output_fd_(output_fd) {
  WAYMARK_CHECK(g_saved.fd < 0, "one terminal at a time");
  termios settings{};
  if (::tcgetattr(input_fd, &settings) != 0) {
    throw InputError(
        "the standard input is no terminal: teleop reads the keyboard");
  }
  g_saved.settings = settings;
  g_saved.fd = input_fd;
  settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  // Nobody leaves a robot that drives with the key for 'suspend'.
  settings.c_cc[VSUSP] = _POSIX_VDISABLE;
  settings.c_cc[VQUIT] = _POSIX_VDISABLE;
  ::tcsetattr(input_fd, TCSANOW, &settings);
  struct sigaction action {};
  action.sa_handler = RestoreAndDie;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : kDeadly) ::sigaction(signal, &action, nullptr);
}

Terminal::~Terminal() {
  for (const int signal : kDeadly) std::signal(signal, SIG_DFL);
  ::tcsetattr(input_fd_, TCSANOW, &g_saved.settings);
  g_saved.fd = -1;
}

std::string Terminal::Read() {
  std::string text;
  pollfd wait{input_fd_, POLLIN, 0};
  while (::poll(&wait, 1, 0) > 0) {
    std::array<char, 256> bytes{};
    const ssize_t size = ::read(input_fd_, bytes.data(), bytes.size());
    if (size < 0 && errno == EINTR) continue;
    // VMIN is 0: readable and nothing to read is the end.
    if (size <= 0) throw std::runtime_error("the terminal is gone");
    text.append(bytes.data(), static_cast<std::size_t>(size));
  }
  return text;
}

void Terminal::Write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t size = ::write(output_fd_, text.data(), text.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return;  // What is not seen does no harm.
    text.remove_prefix(static_cast<std::size_t>(size));
  }
}

int Terminal::num_columns() const {
  winsize size{};
  if (::ioctl(output_fd_, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) {
    return 80;
  }
  return size.ws_col;
}

}  // namespace waymark
