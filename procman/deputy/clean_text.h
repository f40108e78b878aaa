// Bytes of any program as text that every receiver can read.
#pragma once

#include <string>
#include <string_view>

namespace waymark {

// Valid UTF-8 of pieces that may be cut within a character: what is no
// character, and zero bytes, become U+FFFD; of \r\n only \n is left.
class CleanText {
 public:
  [[nodiscard]] std::string Add(std::string_view bytes);
  // What is left of a character that never came to its end.
  [[nodiscard]] std::string Finish();

 private:
  std::string tail_;
};

}  // namespace waymark
