// The size of an image file, from its header.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace waymark {

struct ImageFileSize {
  std::int64_t width = 0;  // px.
  std::int64_t height = 0;
};

// Of a PNG, JPEG, BMP, PGM, PPM or TIFF file, read without decoding it: a
// small file may claim to be a huge image. Returns nullopt and sets *reason,
// which must not be null, where it is none of these, or a JPEG that is cut
// short: decoders fill in what is missing and say nothing.
[[nodiscard]] std::optional<ImageFileSize> SizeOfImageFile(
    std::span<const std::uint8_t> data, std::string* reason);

}  // namespace waymark
