// Text files that tools write, and numbers as text.
#pragma once

#include <charconv>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace waymark {

class OutputFile {
 public:
  // Throws InputError where `path` exists or cannot be created.
  explicit OutputFile(const std::string& path);

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
