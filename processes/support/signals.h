// SIGINT and SIGTERM as something to ask for, instead of handlers.
#pragma once

namespace waymark {

// While one exists, both signals are blocked in the calling thread and the
// threads that it makes, and wait to be taken.
class Signals {
 public:
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  // True once for each signal that came; does not wait.
  [[nodiscard]] bool Take();
  // Readable while a signal waits.
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_ = -1;
};

}  // namespace waymark
