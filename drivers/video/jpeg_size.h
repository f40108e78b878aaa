// The size of a JPEG without decoding it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace waymark {

struct JpegSize {
  int width = 0;  // px.
  int height = 0;
};

// Of a JPEG that begins and ends as one (zeros after its end are padding).
// Returns nullopt and sets *reason where it does not: decoders fill in what is
// missing and say nothing. `reason` must not be null.
[[nodiscard]] std::optional<JpegSize> SizeOfWholeJpeg(
    std::span<const std::uint8_t> data, std::string* reason);

// Whether the bytes begin as a JPEG.
[[nodiscard]] bool IsJpeg(std::span<const std::uint8_t> data);

}  // namespace waymark
