#include "tests/support/create_on_pty.h"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace waymark {

CreateOnPty::CreateOnPty() {
  Plug();
}

CreateOnPty::~CreateOnPty() {
  must_end_ = true;
  if (thread_.joinable()) thread_.join();
  Unplug();
}

void CreateOnPty::Unplug() {
  const std::lock_guard lock(mutex_);
  std::filesystem::remove(device());
  if (master_ >= 0) ::close(master_);
  master_ = -1;
}

void CreateOnPty::Plug() {
  const std::lock_guard lock(mutex_);
  master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  std::array<char, 100> name{};
  if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
      ::ptsname_r(master_, name.data(), name.size()) != 0) {
    throw std::runtime_error("no pseudo-terminal");
  }
  // Before the driver opens it, what the robot sends must not be echoed.
  termios settings{};
  ::tcgetattr(master_, &settings);
  ::cfmakeraw(&settings);
  ::tcsetattr(master_, TCSANOW, &settings);
  std::filesystem::create_symlink(name.data(), device());
}

void CreateOnPty::Pump(double dt) {
  std::array<std::uint8_t, 4096> bytes{};
  for (;;) {
    const ssize_t size = ::read(master_, bytes.data(), bytes.size());
    if (size <= 0) break;
    robot_.Receive(std::span(bytes).first(static_cast<std::size_t>(size)));
  }
  const CreateEmulator::Bytes out = robot_.Step(dt);
  // A driver that does not read loses what its buffer does not hold.
  if (master_ >= 0 && !out.empty() &&
      ::write(master_, out.data(), out.size()) < 0) {
    return;
  }
}

void CreateOnPty::Step(double dt) {
  const std::lock_guard lock(mutex_);
  // The kernel carries bytes across in a worker of its own.
  if (master_ >= 0) {
    pollfd wait{master_, POLLIN, 0};
    ::poll(&wait, 1, 2);
  }
  Pump(dt);
}

void CreateOnPty::RunLive() {
  thread_ = std::thread([this] {
    auto last = std::chrono::steady_clock::now();
    while (!must_end_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(3));
      const auto now = std::chrono::steady_clock::now();
      const std::lock_guard lock(mutex_);
      Pump(std::chrono::duration<double>(now - last).count());
      last = now;
    }
  });
}

void CreateOnPty::With(const std::function<void(CreateEmulator&)>& action) {
  const std::lock_guard lock(mutex_);
  action(robot_);
}

}  // namespace waymark
