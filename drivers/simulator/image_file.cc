#include "drivers/simulator/image_file.h"

#include "estimation/base/input_error.h"

#include <opencv2/imgcodecs.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <vector>

namespace waymark {
namespace {

constexpr std::size_t kMaxImageBytes = std::size_t{256} << 20U;

std::uint32_t BigEndian(std::string_view bytes, std::size_t at, int length) {
  std::uint32_t value = 0;
  for (int i = 0; i < length; ++i) {
    value = (value << 8U) |
            static_cast<std::uint8_t>(bytes[at + static_cast<std::size_t>(i)]);
  }
  return value;
}

// Width and height from the header; nullopt where it is no such file.
std::optional<cv::Size> PngSize(std::string_view bytes) {
  // Signature, length, "IHDR", width, height.
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  if (bytes.size() < 24 || !bytes.starts_with(kSignature)) return std::nullopt;
  return cv::Size(static_cast<int>(BigEndian(bytes, 16, 4) & 0x7FFFFFFFu),
                  static_cast<int>(BigEndian(bytes, 20, 4) & 0x7FFFFFFFu));
}

std::optional<cv::Size> JpegSize(std::string_view bytes) {
  if (!bytes.starts_with("\xFF\xD8")) return std::nullopt;
  std::size_t at = 2;
  while (at + 9 <= bytes.size()) {
    if (bytes[at] != '\xFF') return std::nullopt;
    const std::uint32_t marker = BigEndian(bytes, at + 1, 1);
    if (marker == 0xFF) {  // Filling.
      ++at;
      continue;
    }
    // Frames, but for the tables DHT, JPG and DAC among their numbers.
    if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 &&
        marker != 0xCC) {
      return cv::Size(static_cast<int>(BigEndian(bytes, at + 7, 2)),
                      static_cast<int>(BigEndian(bytes, at + 5, 2)));
    }
    at += 2 + BigEndian(bytes, at + 2, 2);
  }
  return std::nullopt;
}

}  // namespace

cv::Mat DecodeImage(std::string_view bytes,
                    const std::string& source,
                    bool keep_alpha) {
  std::optional<cv::Size> size = PngSize(bytes);
  if (!size) size = JpegSize(bytes);
  if (!size) throw InputError(source + ": not a PNG or JPEG image");
  if (size->width < 1 || size->height < 1 || size->width > kMaxImageFileSide ||
      size->height > kMaxImageFileSide) {
    throw InputError(source + ": " + std::to_string(size->width) + " x " +
                     std::to_string(size->height) +
                     " pixels; each side must be in [1, " +
                     std::to_string(kMaxImageFileSide) + "]");
  }
  cv::Mat image;
  try {
    const std::vector<char> buffer(bytes.begin(), bytes.end());
    image = cv::imdecode(buffer,
                         keep_alpha ? cv::IMREAD_UNCHANGED : cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) throw InputError(source + ": the image is broken");
  return image;
}

cv::Mat LoadImageFile(const std::string& path, bool keep_alpha) {
  return DecodeImage(ReadWholeFile(path, kMaxImageBytes), path, keep_alpha);
}

std::string ReadWholeFile(const std::string& path, std::size_t max_bytes) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path + ": is a folder, not a file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened");
  std::string content;
  std::vector<char> block(std::size_t{1} << 16U);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    content.append(block.data(), static_cast<std::size_t>(file.gcount()));
    if (content.size() > max_bytes) {
      throw InputError(path + ": longer than the " + std::to_string(max_bytes) +
                       " bytes that are read");
    }
  }
  if (file.bad()) throw InputError(path + ": cannot be read to its end");
  return content;
}

}  // namespace waymark
