#include "processes/support/output_file.h"

#include "estimation/base/input_error.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace waymark {

void CheckOutput(const std::string& path,
                 IfExists if_exists,
                 std::span<const std::string> inputs) {
  for (const std::string& input : inputs) {
    std::error_code missing;  // Then they are not the same.
    if (std::filesystem::equivalent(path, input, missing)) {
      throw InputError(path + ": is an input too; choose another name");
    }
  }
  std::error_code unknown;  // Then opening it says why.
  if (if_exists == IfExists::kFail && std::filesystem::exists(path, unknown)) {
    throw InputError(path + ": exists already; --force replaces it");
  }
}

OutputFile::OutputFile(const std::string& path, IfExists if_exists)
    : path_(path),
      file_(std::fopen(path.c_str(),
                       if_exists == IfExists::kFail ? "wxe" : "we")) {
  if (file_ == nullptr && errno == EEXIST) {
    throw InputError(path + ": exists already; --force replaces it");
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
