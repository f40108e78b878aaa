#include "procman/deputy/clean_text.h"

#include <cstddef>
#include <cstdint>

namespace waymark {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

struct Found {
  std::size_t size = 0;  // Of the character, or of what is none.
  bool is_good = false;
  bool is_cut = false;  // It may become one with what follows.
};

// At the beginning of `bytes`, which are not empty. Unicode 15, table 3-7.
Found CharacterAt(std::string_view bytes) {
  const auto at = [&](std::size_t i) {
    return static_cast<std::uint8_t>(bytes[i]);
  };
  const std::uint8_t first = at(0);
  if (first < 0x80) return {1, first != 0, false};
  if (first < 0xC2 || first > 0xF4) return {1, false, false};
  const std::size_t size = first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  const std::uint8_t low = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
  const std::uint8_t high = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
  for (std::size_t i = 1; i < size; ++i) {
    if (i == bytes.size()) return {i, false, true};
    const bool is_next =
        i == 1 ? at(i) >= low && at(i) <= high : at(i) >= 0x80 && at(i) <= 0xBF;
    if (!is_next) return {i, false, false};
  }
  return {size, true, false};
}

}  // namespace

std::string CleanText::Add(std::string_view bytes) {
  tail_ += bytes;
  const std::string_view all = tail_;
  std::string text;
  text.reserve(all.size());
  std::size_t i = 0;
  while (i < all.size()) {
    if (all[i] == '\r') {
      if (i + 1 == all.size()) break;
      if (all[i + 1] != '\n') text += '\r';
      ++i;
      continue;
    }
    const Found found = CharacterAt(all.substr(i));
    if (found.is_cut) break;
    if (found.is_good) {
      text += all.substr(i, found.size);
    } else {
      text += kReplacement;
    }
    i += found.size;
  }
  tail_.erase(0, i);
  return text;
}

std::string CleanText::Finish() {
  std::string text;
  if (!tail_.empty()) text = tail_ == "\r" ? "\r" : std::string(kReplacement);
  tail_.clear();
  return text;
}

}  // namespace waymark
