#include "tests/support/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace waymark {
namespace {

std::string TemporaryFile() {
  std::array<char, 32> path{};
  std::strcpy(path.data(), "/tmp/waymark_child_XXXXXX");
  const int fd = ::mkstemp(path.data());
  if (fd < 0) throw std::runtime_error("mkstemp failed");
  ::close(fd);
  return path.data();
}

std::string Contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments)
    : out_path_(TemporaryFile()), err_path_(TemporaryFile()) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) {
    argv.push_back(const_cast<char*>(argument.c_str()));
  }
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(
      &actions, STDOUT_FILENO, out_path_.c_str(), O_WRONLY | O_TRUNC, 0600);
  ::posix_spawn_file_actions_addopen(
      &actions, STDERR_FILENO, err_path_.c_str(), O_WRONLY | O_TRUNC, 0600);
  const int error =
      ::posix_spawnp(&pid_, argv[0], &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw std::runtime_error(arguments[0] + ": " + std::strerror(error));
  }
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  std::remove(out_path_.c_str());
  std::remove(err_path_.c_str());
}

void ChildProcess::Signal(int signal) {
  if (pid_ > 0) ::kill(pid_, signal);
}

ChildResult ChildProcess::Wait() {
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          Contents(out_path_),
          Contents(err_path_)};
}

std::string ChildProcess::ErrSoFar() const {
  return Contents(err_path_);
}

ChildResult RunChild(const std::vector<std::string>& arguments) {
  return ChildProcess(arguments).Wait();
}

std::string BuildPath(const std::string& relative) {
  const char* build = std::getenv("WAYMARK_BUILD");
  if (build == nullptr) {
    throw std::runtime_error("set WAYMARK_BUILD, or run the test with ctest");
  }
  return std::string(build) + '/' + relative;
}

}  // namespace waymark
