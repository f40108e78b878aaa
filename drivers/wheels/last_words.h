// Bytes that reach a device even when the process that drives it is killed.
#pragma once

#include "drivers/wheels/create_protocol.h"

#include <sys/types.h>

namespace waymark {

// A small process of its own that writes `bytes` to a device as soon as this
// object, or the whole process that owns it, is gone, SIGKILL included: a robot
// without a watchdog would go on with its last command. It does nothing else,
// keeps nothing else open, and outlives a signal to the process group.
class LastWords {
 public:
  // Throws std::runtime_error where the system gives no process.
  LastWords(int device_fd, const Bytes& bytes);
  // Writes now, and waits until that is done.
  ~LastWords();
  LastWords(const LastWords&) = delete;
  LastWords& operator=(const LastWords&) = delete;

 private:
  int pipe_ = -1;  // Its other end reads as closed when this one is.
  pid_t child_ = -1;
};

}  // namespace waymark
