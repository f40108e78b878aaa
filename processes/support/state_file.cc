#include "processes/support/state_file.h"

#include "estimation/base/input_error.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace waymark {
namespace {

[[noreturn]] void Fail(const std::string& path, int error) {
  throw InputError(path + ": cannot be written: " + std::strerror(error));
}

}  // namespace

void CheckStateFolder(const std::string& path) {
  const auto folder = std::filesystem::absolute(path).parent_path();
  if (::access(folder.c_str(), W_OK) != 0) Fail(path, errno);
}

std::string UnfinishedStateFile(const std::string& path) {
  return path + ".new";
}

void SaveStateFile(const std::string& path, const std::string& text) {
  const std::string beside = UnfinishedStateFile(path);
  const int file =
      ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) Fail(path, errno);
  // Synced before the rename: after a power cut the name must not point to
  // an empty file.
  const bool written = ::write(file, text.data(), text.size()) ==
                           static_cast<ssize_t>(text.size()) &&
                       ::fsync(file) == 0;
  const int write_error = errno;
  ::close(file);
  if (!written) {
    ::unlink(beside.c_str());
    Fail(path, write_error == 0 ? ENOSPC : write_error);
  }
  if (std::rename(beside.c_str(), path.c_str()) != 0) {
    const int rename_error = errno;
    ::unlink(beside.c_str());
    Fail(path, rename_error);
  }
}

}  // namespace waymark
