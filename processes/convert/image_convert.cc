#include "processes/convert/image_convert.h"

#include "drivers/video/jpeg_size.h"
#include "estimation/base/check.h"
#include "processes/convert/message_check.h"
#include "processes/support/decode.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

constexpr int kMaxSide = 20000;
// A JPEG of some bytes may claim gigabytes of pixels.
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 26;

bool CheckSize(int width, int height, std::string* reason) {
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    return Refuse(reason,
                  "size: ",
                  width,
                  " x ",
                  height,
                  " px must be in [1, ",
                  kMaxSide,
                  "]");
  }
  return std::int64_t{width} * height <= kMaxPixels ||
         Refuse(reason,
                "size: ",
                width,
                " x ",
                height,
                " px must make at most ",
                kMaxPixels);
}

// ---- JPEG ------------------------------------------------------------------

// The decoder itself would take memory for any size, and fill in what is
// missing.
bool CheckJpeg(const image_t& message, std::string* reason) {
  const std::optional<JpegSize> size = SizeOfWholeJpeg(message.data, reason);
  if (!size) return Refuse(reason, "data: ", std::string(*reason));
  return (size->width == message.width && size->height == message.height) ||
         Refuse(reason,
                "size: ",
                message.width,
                " x ",
                message.height,
                " px, but its JPEG has ",
                size->width,
                " x ",
                size->height);
}

std::optional<cv::Mat> DecodeJpeg(const image_t& message,
                                  ImageColor color,
                                  std::string* reason) {
  if (!CheckJpeg(message, reason)) return std::nullopt;
  int flags = cv::IMREAD_IGNORE_ORIENTATION;
  switch (color) {
    case ImageColor::kAsSent:
      flags |= cv::IMREAD_ANYCOLOR;
      break;
    case ImageColor::kGray:
      flags |= cv::IMREAD_GRAYSCALE;
      break;
    case ImageColor::kBgr:
      flags |= cv::IMREAD_COLOR;
      break;
  }
  cv::Mat image;
  try {
    image = cv::imdecode(message.data, flags);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.cols != message.width || image.rows != message.height) {
    Refuse(reason, "data: JPEG cannot be decoded");
    return std::nullopt;
  }
  return image;
}

// ---- raw -------------------------------------------------------------------

int NumChannels(std::int32_t format) {
  switch (format) {
    case image_t::PIXEL_FORMAT_GRAY:
      return 1;
    case image_t::PIXEL_FORMAT_RGB:
    case image_t::PIXEL_FORMAT_BGR:
      return 3;
    default:
      return 0;
  }
}

// Code for cv::cvtColor; nullopt: as it is.
std::optional<int> Conversion(std::int32_t format, ImageColor color) {
  const bool is_gray = format == image_t::PIXEL_FORMAT_GRAY;
  const bool is_rgb = format == image_t::PIXEL_FORMAT_RGB;
  if (color == ImageColor::kGray && !is_gray) {
    return is_rgb ? cv::COLOR_RGB2GRAY : cv::COLOR_BGR2GRAY;
  }
  if (color == ImageColor::kBgr && is_gray) return cv::COLOR_GRAY2BGR;
  if (is_rgb) return cv::COLOR_RGB2BGR;
  return std::nullopt;
}

std::optional<cv::Mat> CopyRaw(const image_t& message,
                               ImageColor color,
                               std::string* reason) {
  const int channels = NumChannels(message.pixelformat);
  if (channels == 0) {
    Refuse(reason,
           "pixelformat: ",
           message.pixelformat,
           " must be gray, RGB, BGR or MJPEG");
    return std::nullopt;
  }
  const std::int64_t row = message.row_stride;
  const auto size = static_cast<std::int64_t>(message.data.size());
  if (row < std::int64_t{message.width} * channels ||
      size != row * message.height) {
    Refuse(reason,
           "data: ",
           size,
           " bytes in rows of ",
           row,
           " are not ",
           message.width,
           " x ",
           message.height,
           " px of ",
           channels,
           " bytes");
    return std::nullopt;
  }
  // cv::Mat has no view of constant data; it is only read.
  const cv::Mat view(message.height,
                     message.width,
                     CV_8UC(channels),
                     const_cast<std::uint8_t*>(message.data.data()),
                     static_cast<std::size_t>(row));
  cv::Mat image;
  const std::optional<int> conversion = Conversion(message.pixelformat, color);
  if (conversion) {
    cv::cvtColor(view, image, *conversion);
  } else {
    view.copyTo(image);
  }
  return image;
}

void FillRaw(const cv::Mat& image, image_t* message) {
  const auto row = static_cast<std::size_t>(image.cols) * image.elemSize();
  if (image.channels() == 1) {
    message->pixelformat = image_t::PIXEL_FORMAT_GRAY;
  } else {
    message->pixelformat = image_t::PIXEL_FORMAT_BGR;
  }
  message->row_stride = static_cast<std::int32_t>(row);
  message->data.reserve(row * static_cast<std::size_t>(image.rows));
  for (int y = 0; y < image.rows; ++y) {
    const std::uint8_t* begin = image.ptr(y);
    message->data.insert(message->data.end(), begin, begin + row);
  }
}

// ---- metadata --------------------------------------------------------------

void AddMetadata(const char* key, std::uint64_t bits, image_t* message) {
  image_metadata_t item;
  item.key = key;
  item.n = 8;
  for (int shift = 56; shift >= 0; shift -= 8) {
    item.value.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
  message->metadata.push_back(std::move(item));
  message->nmetadata = static_cast<std::int32_t>(message->metadata.size());
}

// False where the key is there, but not as eight bytes.
bool FindMetadata(const image_t& message,
                  const char* key,
                  std::optional<std::uint64_t>* bits,
                  std::string* reason) {
  for (const image_metadata_t& item : message.metadata) {
    if (item.key != key) continue;
    if (item.value.size() != 8) {
      return Refuse(reason,
                    "metadata ",
                    key,
                    ": ",
                    item.value.size(),
                    " bytes must be 8");
    }
    *bits = BigEndian64(item.value);
    return true;
  }
  return true;
}

}  // namespace

void ImageEncoderOptions::Check() const {
  if (max_bytes < 1000) {
    throw std::invalid_argument("max_bytes must be at least 1000");
  }
  if (min_quality < 1 || min_quality > max_quality || max_quality > 100) {
    throw std::invalid_argument(
        "min_quality and max_quality must be in [1, 100], min first");
  }
}

ImageEncoder::ImageEncoder(const ImageEncoderOptions& options)
    : options_(options), quality_(options.max_quality) {
  options_.Check();
}

bool ImageEncoder::EncodeJpeg(const cv::Mat& image,
                              image_t* message,
                              std::string* reason) {
  message->pixelformat = image_t::PIXEL_FORMAT_MJPEG;
  const auto limit = static_cast<std::size_t>(options_.max_bytes);
  for (int step = 3;; step *= 2) {
    cv::imencode(
        ".jpg", image, message->data, {cv::IMWRITE_JPEG_QUALITY, quality_});
    if (message->data.size() <= limit) break;
    if (quality_ == options_.min_quality) {
      return Refuse(reason,
                    "JPEG of ",
                    image.cols,
                    " x ",
                    image.rows,
                    " px has ",
                    message->data.size(),
                    " bytes at quality ",
                    quality_,
                    ", more than ",
                    options_.max_bytes);
    }
    quality_ = std::max(quality_ - step, options_.min_quality);
  }
  // One step of quality adds some 5 % at most; twice that leaves room for the
  // next image to differ a little.
  if (message->data.size() * 10 < limit * 9 &&
      quality_ < options_.max_quality) {
    ++quality_;
  }
  return true;
}

std::optional<image_t> ImageEncoder::Encode(const cv::Mat& image,
                                            const ImageTags& tags,
                                            std::string* reason) {
  WAYMARK_CHECK(image.type() == CV_8UC1 || image.type() == CV_8UC3,
                image.type());
  if (!CheckSize(image.cols, image.rows, reason)) return std::nullopt;
  cv::Mat pixels = image;
  if (options_.is_gray && image.channels() == 3) {
    cv::cvtColor(image, pixels, cv::COLOR_BGR2GRAY);
  }
  image_t message;
  message.utime = Microseconds(tags.time);
  message.width = pixels.cols;
  message.height = pixels.rows;
  if (options_.format == ImageFormat::kRaw) {
    FillRaw(pixels, &message);
  } else if (!EncodeJpeg(pixels, &message, reason)) {
    return std::nullopt;
  }
  message.size = static_cast<std::int32_t>(message.data.size());
  if (tags.seq) {
    AddMetadata("seq", static_cast<std::uint64_t>(*tags.seq), &message);
  }
  if (tags.head) {
    AddMetadata("pan", std::bit_cast<std::uint64_t>(tags.head->pan), &message);
    AddMetadata(
        "tilt", std::bit_cast<std::uint64_t>(tags.head->tilt), &message);
  }
  return message;
}

std::optional<cv::Mat> ImageFromMessage(const image_t& message,
                                        ImageColor color,
                                        std::string* reason) {
  if (!CheckSize(message.width, message.height, reason)) return std::nullopt;
  return message.pixelformat == image_t::PIXEL_FORMAT_MJPEG
             ? DecodeJpeg(message, color, reason)
             : CopyRaw(message, color, reason);
}

std::optional<ImageFile> ImageFileFromMessage(const image_t& message,
                                              std::string* reason) {
  const auto image = ImageFromMessage(message, ImageColor::kAsSent, reason);
  if (!image) return std::nullopt;
  if (message.pixelformat == image_t::PIXEL_FORMAT_MJPEG) {
    return ImageFile{".jpg", message.data};
  }
  ImageFile file{".png", {}};
  if (!cv::imencode(file.extension, *image, file.bytes)) {
    Refuse(reason, "data: cannot be written as PNG");
    return std::nullopt;
  }
  return file;
}

std::optional<ImageTags> TagsFromMessage(const image_t& message,
                                         std::string* reason) {
  std::optional<std::uint64_t> seq;
  std::optional<std::uint64_t> pan;
  std::optional<std::uint64_t> tilt;
  if (!CheckTime("utime", message.utime, reason) ||
      !FindMetadata(message, "seq", &seq, reason) ||
      !FindMetadata(message, "pan", &pan, reason) ||
      !FindMetadata(message, "tilt", &tilt, reason)) {
    return std::nullopt;
  }
  if (pan.has_value() != tilt.has_value()) {
    Refuse(reason, "metadata pan and tilt: one without the other");
    return std::nullopt;
  }
  ImageTags tags;
  tags.time = TimeFromMicroseconds(message.utime);
  if (seq) tags.seq = static_cast<std::int64_t>(*seq);
  if (pan) {
    tags.head =
        HeadAngles{std::bit_cast<double>(*pan), std::bit_cast<double>(*tilt)};
    if (!std::isfinite(tags.head->pan) || !std::isfinite(tags.head->tilt)) {
      Refuse(reason, "metadata pan, tilt: must be finite");
      return std::nullopt;
    }
  }
  return tags;
}

}  // namespace waymark
