#include "drivers/video/image_file.h"

#include "drivers/video/image_size.h"
#include "drivers/video/quiet_opencv.h"
#include "estimation/base/input_error.h"
#include "estimation/base/whole_file.h"

#include <opencv2/imgcodecs.hpp>

#include <cstddef>
#include <optional>
#include <vector>

namespace waymark {
namespace {

constexpr std::size_t kMaxImageBytes = std::size_t{256} << 20U;

int FlagsOf(ImageFileColor color) {
  switch (color) {
    case ImageFileColor::kGray:
      return cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION;
    case ImageFileColor::kBgr:
      return cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION;
    case ImageFileColor::kGrayOrBgr:
      return cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION;
    case ImageFileColor::kAsStored:
      break;
  }
  return cv::IMREAD_UNCHANGED;  // Ignores orientation too.
}

}  // namespace

cv::Mat DecodeImage(std::span<const std::uint8_t> bytes,
                    const std::string& source,
                    ImageFileColor color) {
  std::string reason;
  const std::optional<ImageFileSize> size = SizeOfImageFile(bytes, &reason);
  if (!size) throw InputError(source + ": " + reason);
  if (size->width < 1 || size->height < 1 || size->width > kMaxImageFileSide ||
      size->height > kMaxImageFileSide ||
      size->width * size->height > kMaxImageFilePixels) {
    throw InputError(source + ": " + std::to_string(size->width) + " x " +
                     std::to_string(size->height) +
                     " pixels; each side must be in [1, " +
                     std::to_string(kMaxImageFileSide) + "], all at most " +
                     std::to_string(kMaxImageFilePixels));
  }
  const QuietOpenCv quiet;
  cv::Mat image;
  try {
    const cv::Mat buffer(1,
                         static_cast<int>(bytes.size()),
                         CV_8U,
                         const_cast<std::uint8_t*>(bytes.data()));
    image = cv::imdecode(buffer, FlagsOf(color));
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) throw InputError(source + ": the image is broken");
  return image;
}

cv::Mat LoadImageFile(const std::string& path, ImageFileColor color) {
  const std::string bytes = ReadWholeFile(path, kMaxImageBytes);
  return DecodeImage(
      {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
      path,
      color);
}

}  // namespace waymark
