// Bytes that reach a device when the process that drives it is gone or hangs.
#pragma once

#include "drivers/wheels/create_protocol.h"

#include <sys/types.h>

namespace waymark {

// A small process of its own that writes `bytes` to a device as soon as this
// object, or the whole process that owns it, is gone, SIGKILL included, and
// when Beat() has not been called for a while (SIGSTOP, a loop without end, a
// machine that is overloaded): a robot without a watchdog would go on with its
// last command. It does nothing else, keeps nothing else open, and outlives a
// signal to the process group.
class Watchdog {
 public:
  // Throws std::runtime_error where the system gives no process.
  Watchdog(int device_fd, const Bytes& bytes, double timeout_s);
  // Writes now, and waits until that is done.
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  void Beat();

 private:
  int pipe_ = -1;  // Its other end reads as closed when this one is.
  pid_t child_ = -1;
};

}  // namespace waymark
