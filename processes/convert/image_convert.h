// Image messages to images and back. What comes in is checked here once: behind
// these functions an image has the size that its message states.
#pragma once

#include "estimation/base/time.h"

#include <waymark/image_t.hpp>

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

// Where a pan-tilt head looked.
struct HeadAngles {
  double pan = 0.0;   // About H's z, left positive, rad.
  double tilt = 0.0;  // Then about the panned y, downward positive, rad.
  bool operator==(const HeadAngles&) const = default;
};

// What a message says of an image besides its pixels.
struct ImageTags {
  Time time;  // Of the exposure.
  std::optional<std::int64_t> seq;
  std::optional<HeadAngles> head;
  bool operator==(const ImageTags&) const = default;
};

enum class ImageFormat { kJpeg, kRaw };

struct ImageEncoderOptions {
  ImageFormat format = ImageFormat::kJpeg;
  bool is_gray = false;  // Turn colour into gray.
  // Of one JPEG. The default keeps a message within one datagram of LCM.
  int max_bytes = 60000;
  int min_quality = 20;  // JPEG quality, 1 to 100.
  int max_quality = 90;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Makes messages of the images of one camera. The JPEG quality follows what the
// images need: down at once where one is too large, up by one after each that
// leaves room. The same images in the same order give the same bytes.
class ImageEncoder {
 public:
  explicit ImageEncoder(const ImageEncoderOptions& options);

  // `image`: 8 bits, one channel (gray) or three (BGR), at most 20000 px wide
  // and high. Returns nullopt and sets *reason where the JPEG has more than
  // max_bytes at min_quality. `reason` must not be null.
  [[nodiscard]] std::optional<image_t> Encode(const cv::Mat& image,
                                              const ImageTags& tags,
                                              std::string* reason);

  [[nodiscard]] int quality() const { return quality_; }

 private:
  [[nodiscard]] bool EncodeJpeg(const cv::Mat& image,
                                image_t* message,
                                std::string* reason);

  ImageEncoderOptions options_;
  int quality_;  // For the next image.
};

// What a receiver wants: 1 channel, 3 (BGR), or as many as there are.
enum class ImageColor { kAsSent, kGray, kBgr };

// The pixels, owned by the result. Returns nullopt and sets *reason where the
// format is none of image_t's, a size is not in 1 to 20000 px or makes more
// than 2^26 px, rows do not fill the data exactly, or a JPEG is cut short, says
// another size than its message, or cannot be decoded. `reason` must not be
// null.
[[nodiscard]] std::optional<cv::Mat> ImageFromMessage(const image_t& message,
                                                      ImageColor color,
                                                      std::string* reason);

// The image as a file, to look at.
struct ImageFile {
  std::string extension;  // ".jpg": as it was sent; ".png": it was sent raw.
  std::vector<std::uint8_t> bytes;
};

// Returns nullopt and sets *reason where ImageFromMessage() does. `reason` must
// not be null.
[[nodiscard]] std::optional<ImageFile> ImageFileFromMessage(
    const image_t& message, std::string* reason);

// Returns nullopt and sets *reason where the time is not positive, or seq, pan
// or tilt is not eight bytes, or an angle not finite; pan and tilt come
// together. Other metadata is let pass. `reason` must not be null.
[[nodiscard]] std::optional<ImageTags> TagsFromMessage(const image_t& message,
                                                       std::string* reason);

}  // namespace waymark
