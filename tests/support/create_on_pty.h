// The emulated robot at the end of a pseudo-terminal that a driver opens as
// its serial port.
#pragma once

#include "tests/support/create_emulator.h"
#include "tests/support/temporary_directory.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace waymark {

class CreateOnPty {
 public:
  CreateOnPty();
  ~CreateOnPty();
  CreateOnPty(const CreateOnPty&) = delete;
  CreateOnPty& operator=(const CreateOnPty&) = delete;

  // The device's path, the same after each Plug().
  [[nodiscard]] std::string device() const { return directory_ / "ttyUSB0"; }

  // The cable is pulled: the device vanishes. Then: another one appears.
  void Unplug();
  void Plug();

  // Takes what the driver has sent, lets dt seconds of the robot's time pass,
  // sends. Waits for the kernel's line, some milliseconds, where the driver
  // has just written.
  void Step(double dt);
  // From now on Step() follows real time, in a thread of its own; then the
  // robot is touched by With() only.
  void RunLive();
  void With(const std::function<void(CreateEmulator&)>& action);

 private:
  void Pump(double dt);

  TemporaryDirectory directory_;
  std::mutex mutex_;
  int master_ = -1;
  CreateEmulator robot_;
  std::atomic<bool> must_end_{false};
  std::thread thread_;
};

}  // namespace waymark
