// Image files.
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <span>
#include <string>

namespace waymark {

inline constexpr int kMaxImageFileSide = 16384;               // px.
inline constexpr std::int64_t kMaxImageFilePixels = 1 << 26;  // 8192 x 8192.

enum class ImageFileColor {
  kGray,       // CV_8UC1.
  kBgr,        // CV_8UC3.
  kGrayOrBgr,  // As the file has it.
  kAsStored,   // With alpha and all bits.
};

// Decodes an image as its pixels are stored: a note in it on how the camera
// was held is not obeyed, since calibrations are of pixels. Its size is read
// from its header first (SizeOfImageFile()), so that a small file cannot ask
// for much memory. Throws InputError naming `source` where it is no image,
// broken, or larger than the constants above.
[[nodiscard]] cv::Mat DecodeImage(std::span<const std::uint8_t> bytes,
                                  const std::string& source,
                                  ImageFileColor color);
// The same from a file; `source` is its path. Throws InputError where it
// cannot be read.
[[nodiscard]] cv::Mat LoadImageFile(const std::string& path,
                                    ImageFileColor color);

}  // namespace waymark
