// A terminal that gives every key at once.
#pragma once

#include <string>
#include <string_view>

namespace waymark {

// Restores the terminal when it ends: by its destructor, and by a handler for
// signals that would end the process otherwise (SIGHUP, SIGQUIT, SIGABRT,
// SIGSEGV; RunProcess takes SIGINT and SIGTERM). One at a time.
class Terminal {
 public:
  // Throws InputError where `input_fd` is no terminal.
  Terminal(int input_fd, int output_fd);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // What has been typed; does not wait. Throws std::runtime_error where the
  // terminal is gone.
  [[nodiscard]] std::string Read();
  void Write(std::string_view text);
  // Of a line; 80 where it cannot be told.
  [[nodiscard]] int num_columns() const;

 private:
  int input_fd_;
  int output_fd_;
};

}  // namespace waymark
