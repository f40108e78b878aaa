// A terminal without a screen, for tests of programs that want one.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

namespace waymark {

class PseudoTerminal {
 public:
  PseudoTerminal() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    std::array<char, 64> name{};
    if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
        ::ptsname_r(master_, name.data(), name.size()) != 0) {
      throw std::runtime_error("no pseudo-terminal");
    }
    device_ = name.data();
    terminal_ = ::open(device_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (terminal_ < 0) throw std::runtime_error("cannot open " + device_);
  }
  ~PseudoTerminal() {
    ::close(terminal_);
    ::close(master_);
  }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  // The program's side.
  [[nodiscard]] int fd() const { return terminal_; }
  [[nodiscard]] const std::string& device() const { return device_; }
  [[nodiscard]] termios settings() const {
    termios settings{};
    ::tcgetattr(terminal_, &settings);
    return settings;
  }

  void Type(std::string_view keys) {
    if (::write(master_, keys.data(), keys.size()) !=
        static_cast<ssize_t>(keys.size())) {
      throw std::runtime_error("the pseudo-terminal takes no keys");
    }
  }
  // All that has been written to it so far.
  [[nodiscard]] const std::string& Screen() {
    pollfd wait{master_, POLLIN, 0};
    std::array<char, 4096> bytes{};
    while (::poll(&wait, 1, 0) > 0 && (wait.revents & POLLIN) != 0) {
      const ssize_t size = ::read(master_, bytes.data(), bytes.size());
      if (size <= 0) break;
      screen_.append(bytes.data(), static_cast<std::size_t>(size));
    }
    return screen_;
  }

 private:
  int master_;
  int terminal_ = -1;
  std::string device_;
  std::string screen_;
};

}  // namespace waymark
