// Files that tools write: none is lost that was there before.
#pragma once

#include <charconv>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace waymark {

enum class IfExists { kFail, kReplace };

// To be called for every output before the work begins. Throws InputError
// where `path` is one of `inputs`, by whatever name or link, since it would be
// emptied before or after it is read; or, with kFail, where it exists.
void CheckOutput(const std::string& path,
                 IfExists if_exists,
                 std::span<const std::string> inputs);

class OutputFile {
 public:
  // Throws InputError where `path` exists (kFail) or cannot be created.
  explicit OutputFile(const std::string& path,
                      IfExists if_exists = IfExists::kFail);

  // Both throw InputError where the disk does not take it.
  void Write(std::string_view text);
  void Close();

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  [[noreturn]] void Fail() const;

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
};

// The fewest digits that read back as the same number.
template <typename Number>
[[nodiscard]] std::string ShortestNumber(Number value) {
  char text[64];
  const auto result = std::to_chars(text, text + sizeof(text), value);
  return {text, result.ptr};
}

}  // namespace waymark
