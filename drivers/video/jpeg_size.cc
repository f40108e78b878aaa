#include "drivers/video/jpeg_size.h"

#include <cstddef>

namespace waymark {
namespace {

constexpr std::uint8_t kMark = 0xff;
constexpr std::uint8_t kStart = 0xd8;
constexpr std::uint8_t kEnd = 0xd9;

}  // namespace

bool IsJpeg(std::span<const std::uint8_t> data) {
  return data.size() >= 2 && data[0] == kMark && data[1] == kStart;
}

std::optional<JpegSize> SizeOfWholeJpeg(std::span<const std::uint8_t> data,
                                        std::string* reason) {
  while (!data.empty() && data.back() == 0) data = data.first(data.size() - 1);
  if (data.size() < 4 || !IsJpeg(data)) {
    *reason = std::to_string(data.size()) + " bytes are no JPEG";
    return std::nullopt;
  }
  if (data[data.size() - 2] != kMark || data.back() != kEnd) {
    *reason = "JPEG cut short at " + std::to_string(data.size()) + " bytes";
    return std::nullopt;
  }
  const auto number_at = [&](std::size_t at) {
    return data[at] * 256 + data[at + 1];
  };
  // Segments: mark, kind, length (with its own two bytes), content.
  for (std::size_t at = 2; at + 4 <= data.size() && data[at] == kMark;) {
    const int kind = data[at + 1];
    // Frame headers are C0 to CF but for three kinds of tables.
    const bool is_frame = kind >= 0xc0 && kind <= 0xcf && kind != 0xc4 &&
                          kind != 0xc8 && kind != 0xcc;
    if (is_frame && at + 9 <= data.size()) {
      return JpegSize{number_at(at + 7), number_at(at + 5)};
    }
    // Fill bytes may precede a kind.
    at += kind == kMark ? 1 : 2 + static_cast<std::size_t>(number_at(at + 2));
  }
  *reason = "JPEG without a frame";
  return std::nullopt;
}

}  // namespace waymark
