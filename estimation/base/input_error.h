// What a user handed in and cannot be used: configuration, calibration, log,
// file.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace waymark {

// what() is the one line that the user sees: file, key or place, value,
// allowed range. RunProcess and RunTool print it and exit with 2. Control
// characters of the text, which often quotes the input, appear as \n or \x1b.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::string_view text)
      : std::runtime_error(OneLine(text)) {}

 private:
  static std::string OneLine(std::string_view text) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string line;
    for (const char c : text) {
      const auto code = static_cast<unsigned char>(c);
      if (c == '\n') {
        line += "\\n";
      } else if (code < 0x20 || code == 0x7f) {
        line += {'\\', 'x', kDigits[code >> 4], kDigits[code & 15]};
      } else {
        line += c;
      }
    }
    return line;
  }
};

}  // namespace waymark
