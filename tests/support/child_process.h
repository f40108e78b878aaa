// An executable run by a test.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace waymark {

struct ChildResult {
  int exit_code = -1;  // 128 + signal where one killed it.
  std::string out;
  std::string err;
};

class ChildProcess {
 public:
  // Starts `arguments[0]`; throws std::runtime_error where that fails.
  explicit ChildProcess(const std::vector<std::string>& arguments);
  // Kills and reaps what still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void Signal(int signal);
  // Waits until it ends.
  ChildResult Wait();
  // What it has written to stderr so far.
  [[nodiscard]] std::string ErrSoFar() const;

 private:
  pid_t pid_ = -1;
  std::string out_path_;
  std::string err_path_;
};

// Runs to the end.
[[nodiscard]] ChildResult RunChild(const std::vector<std::string>& arguments);

// A path below the build directory, from the environment that CTest sets.
[[nodiscard]] std::string BuildPath(const std::string& relative);

}  // namespace waymark
