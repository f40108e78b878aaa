#include "logs/log_tool/output_file.h"

#include "processes/support/input_error.h"

#include <cerrno>
#include <cstring>

namespace waymark {

OutputFile::OutputFile(const std::string& path)
    : path_(path), file_(std::fopen(path.c_str(), "wxe")) {
  if (file_ == nullptr && errno == EEXIST) {
    throw InputError(path + ": output exists already; choose another name");
  }
  if (file_ == nullptr) {
    throw InputError(path + ": cannot be created: " + std::strerror(errno));
  }
}

void OutputFile::Write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) {
    Fail();
  }
}

void OutputFile::Close() {
  if (file_ == nullptr) return;
  if (std::fflush(file_.get()) != 0) Fail();
  if (std::fclose(file_.release()) != 0) Fail();
}

void OutputFile::Fail() const {
  throw InputError(path_ + ": cannot be written: " + std::strerror(errno));
}

}  // namespace waymark
