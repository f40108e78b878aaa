#include "drivers/video/image_size.h"

#include "drivers/video/jpeg_size.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <string_view>

namespace waymark {
namespace {

using Bytes = std::span<const std::uint8_t>;

bool BeginsWith(Bytes data, std::string_view text) {
  return data.size() >= text.size() &&
         std::equal(text.begin(), text.end(), data.begin(), [](char c, auto b) {
           return static_cast<std::uint8_t>(c) == b;
         });
}

// An unsigned number of `length` bytes, of which the first counts most where
// `is_big`; nullopt behind the end.
std::optional<std::uint32_t> NumberAt(Bytes data,
                                      std::size_t at,
                                      int length,
                                      bool is_big) {
  if (at + static_cast<std::size_t>(length) > data.size()) return std::nullopt;
  std::uint32_t value = 0;
  for (int i = 0; i < length; ++i) {
    const int place = is_big ? i : length - 1 - i;
    value = (value << 8U) | data[at + static_cast<std::size_t>(place)];
  }
  return value;
}

std::optional<ImageFileSize> SizeAt(Bytes data, std::size_t at, bool is_big) {
  const auto width = NumberAt(data, at, 4, is_big);
  const auto height = NumberAt(data, at + 4, 4, is_big);
  if (!width || !height) return std::nullopt;
  return ImageFileSize{*width, *height};
}

// Rows of a BMP may go down, which its height says by its sign; headers of 12
// bytes have numbers of two.
std::optional<ImageFileSize> BmpSize(Bytes data) {
  constexpr std::size_t kHeader = 14;
  const auto length = NumberAt(data, kHeader, 4, false);
  if (!length) return std::nullopt;
  if (*length == 12) {
    const auto width = NumberAt(data, kHeader + 4, 2, false);
    const auto height = NumberAt(data, kHeader + 6, 2, false);
    if (!width || !height) return std::nullopt;
    return ImageFileSize{*width, *height};
  }
  const auto size = SizeAt(data, kHeader + 4, false);
  if (!size) return std::nullopt;
  const auto height =
      static_cast<std::int32_t>(static_cast<std::uint32_t>(size->height));
  return ImageFileSize{size->width, std::abs(std::int64_t{height})};
}

// "P5", then numbers among white space and comments.
std::optional<ImageFileSize> PnmSize(Bytes data) {
  std::array<std::int64_t, 2> numbers{};
  std::size_t at = 2;
  for (std::int64_t& number : numbers) {
    while (at < data.size() && (data[at] <= ' ' || data[at] == '#')) {
      if (data[at] == '#') {
        while (at < data.size() && data[at] != '\n') ++at;
      } else {
        ++at;
      }
    }
    constexpr int kMaxDigits = 10;
    int num_digits = 0;
    for (; at < data.size() && data[at] >= '0' && data[at] <= '9'; ++at) {
      if (++num_digits > kMaxDigits) return std::nullopt;
      number = 10 * number + (data[at] - '0');
    }
    if (num_digits == 0) return std::nullopt;
  }
  return ImageFileSize{numbers[0], numbers[1]};
}

// The number of a TIFF tag that has just one, SHORT or LONG; nullopt where it
// is anything else, which a decoder might take for another number.
std::optional<std::uint32_t> TiffNumber(Bytes data,
                                        std::size_t at,
                                        bool is_big) {
  constexpr std::uint32_t kShort = 3;
  constexpr std::uint32_t kLong = 4;
  const auto type = NumberAt(data, at + 2, 2, is_big);
  if (type != kShort && type != kLong) return std::nullopt;
  if (NumberAt(data, at + 4, 4, is_big) != 1U) return std::nullopt;
  return NumberAt(data, at + 8, type == kShort ? 2 : 4, is_big);
}

// Tags 256 and 257 of the first directory. Each must be there just once: which
// of two counts is the decoder's choice.
std::optional<ImageFileSize> TiffSize(Bytes data) {
  constexpr std::uint32_t kWidth = 256;
  constexpr std::uint32_t kHeight = 257;
  constexpr std::size_t kEntry = 12;
  const bool is_big = data[0] == 'M';
  const auto directory = NumberAt(data, 4, 4, is_big);
  if (!directory) return std::nullopt;
  const auto count = NumberAt(data, *directory, 2, is_big);
  if (!count) return std::nullopt;
  std::optional<std::uint32_t> width;
  std::optional<std::uint32_t> height;
  for (std::size_t i = 0; i < *count; ++i) {
    const std::size_t at = *directory + 2 + i * kEntry;
    const auto tag = NumberAt(data, at, 2, is_big);
    if (!tag) return std::nullopt;
    if (tag != kWidth && tag != kHeight) continue;
    std::optional<std::uint32_t>* number = tag == kWidth ? &width : &height;
    if (*number) return std::nullopt;
    *number = TiffNumber(data, at, is_big);
    if (!*number) return std::nullopt;
  }
  if (!width || !height) return std::nullopt;
  return ImageFileSize{*width, *height};
}

}  // namespace

std::optional<ImageFileSize> SizeOfImageFile(Bytes data, std::string* reason) {
  using namespace std::string_view_literals;
  if (IsJpeg(data)) {
    const auto size = SizeOfWholeJpeg(data, reason);
    if (!size) return std::nullopt;
    return ImageFileSize{size->width, size->height};
  }
  std::optional<ImageFileSize> size;
  if (BeginsWith(data, "\x89PNG\r\n\x1a\n"sv)) {
    size = SizeAt(data, 16, true);  // Behind length and name of IHDR.
  } else if (BeginsWith(data, "BM")) {
    size = BmpSize(data);
  } else if (BeginsWith(data, "P2") || BeginsWith(data, "P3") ||
             BeginsWith(data, "P5") || BeginsWith(data, "P6")) {
    size = PnmSize(data);
  } else if (BeginsWith(data, "II*\0"sv) || BeginsWith(data, "MM\0*"sv)) {
    size = TiffSize(data);
  } else {
    *reason = "is no PNG, JPEG, BMP, PGM, PPM or TIFF image";
    return std::nullopt;
  }
  if (!size) *reason = "its header is broken";
  return size;
}

}  // namespace waymark
