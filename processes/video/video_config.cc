#include "processes/video/video_config.h"

#include "processes/support/channels.h"

#include <cstdint>
#include <stdexcept>

namespace waymark {
namespace {

constexpr std::int64_t kMaxSide = 20000;  // What a message can carry, px.

}  // namespace

void VideoConfig::Describe(Describer& d) {
  d.Text("camera", &camera, "Name, as in IMAGE_<camera>: A-Z, 0-9 and _");
  d.Text("source",
         &source.source,
         "A camera's device, a folder of images, a pattern such as a/*.png, or "
         "a video file");
  d.Text("times_file",
         &source.times_file,
         "Of images: a line each, 'time' or 'time name', s; empty: from names "
         "that are nanoseconds, else by rate_hz");
  d.Number("rate_hz",
           &source.rate_hz,
           {0.0, 1000.0},
           "Of images without times, or instead of a video's or a camera's "
           "own; 0: its own, images 10");
  d.Flag("loop", &source.loops, "Files: from the beginning after the end");
  std::int64_t width = source.width;
  std::int64_t height = source.height;
  d.Integer("width", &width, 0, kMaxSide, "Asked of a camera, px; 0: its own");
  d.Integer("height", &height, 0, kMaxSide, "As width");
  source.width = static_cast<int>(width);
  source.height = static_cast<int>(height);
  d.Text("calibration",
         &calibration,
         "Calibration file of the camera, for CAMERA_INFO_<camera>; empty: "
         "none");
  d.Number("latency_s",
           &latency_s,
           {0.0, 10.0},
           "From the exposure to the arrival of a camera's image");
  d.Choice<ImageFormat>(
      "format",
      &encoder.format,
      {{"jpeg", ImageFormat::kJpeg}, {"raw", ImageFormat::kRaw}},
      "Of the messages");
  d.Flag("gray", &encoder.is_gray, "Send gray images, whatever comes");
  std::int64_t max_bytes = encoder.max_bytes;
  std::int64_t min_quality = encoder.min_quality;
  std::int64_t max_quality = encoder.max_quality;
  d.Integer("jpeg_max_bytes",
            &max_bytes,
            1000,
            10'000'000,
            "The quality goes down until an image fits");
  d.Integer("jpeg_min_quality", &min_quality, 1, 100, "but no further");
  d.Integer("jpeg_max_quality", &max_quality, 1, 100, "nor higher than needed");
  encoder.max_bytes = static_cast<int>(max_bytes);
  encoder.min_quality = static_cast<int>(min_quality);
  encoder.max_quality = static_cast<int>(max_quality);
}

void VideoConfig::Check() const {
  if (!IsCameraName(camera)) {
    throw std::invalid_argument("camera = " + camera +
                                " must consist of A-Z, 0-9 and _");
  }
  source.Check();
  encoder.Check();
}

}  // namespace waymark
