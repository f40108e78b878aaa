// Image files that textures and floor plans come from.
#pragma once

#include <opencv2/core/mat.hpp>

#include <string>
#include <string_view>

namespace waymark {

inline constexpr int kMaxImageFileSide = 8192;  // Pixels.

// Decodes a PNG or JPEG file as 8-bit BGR, or BGRA where `keep_alpha` and it
// has alpha. Its size is read from its header first, so that a small file
// cannot ask for much memory. Throws InputError naming `source` where it is
// neither, broken, or has a side longer than kMaxImageFileSide.
[[nodiscard]] cv::Mat DecodeImage(std::string_view bytes,
                                  const std::string& source,
                                  bool keep_alpha = false);
// The same from a file; `source` is its path. Throws InputError where it
// cannot be read.
[[nodiscard]] cv::Mat LoadImageFile(const std::string& path,
                                    bool keep_alpha = false);

// The whole of a file of at most `max_bytes`. Throws InputError naming it.
[[nodiscard]] std::string ReadWholeFile(const std::string& path,
                                        std::size_t max_bytes);

}  // namespace waymark
