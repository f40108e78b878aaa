#include "drivers/video/video_file.h"

#include "drivers/video/quiet_opencv.h"
#include "estimation/base/input_error.h"

#include <opencv2/videoio.hpp>

#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

namespace waymark {

class VideoFile::Decoder : public cv::VideoCapture {};

VideoFile::VideoFile(std::string path, double rate_hz)
    : path_(std::move(path)) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path_, error)) {
    throw InputError(path_ + ": no such folder, pattern or video file");
  }
  Rewind();
  if (!decoder_->isOpened()) {
    throw InputError(path_ + ": is no video that can be decoded");
  }
  rate_hz_ = rate_hz > 0.0 ? rate_hz : decoder_->get(cv::CAP_PROP_FPS);
  // What headers of damaged files say.
  constexpr double kMaxRateHz = 1000.0;
  if (!std::isfinite(rate_hz_) || rate_hz_ <= 0.0 || rate_hz_ > kMaxRateHz) {
    throw InputError(path_ + ": states no rate; give one (rate_hz)");
  }
}

VideoFile::~VideoFile() = default;

void VideoFile::Rewind() {
  // Opened anew: seeking is not exact in all formats.
  const QuietOpenCv quiet;
  decoder_ = std::make_unique<Decoder>();
  for (const int backend : {cv::CAP_FFMPEG, cv::CAP_OPENCV_MJPEG}) {
    try {
      if (decoder_->open(path_, backend)) break;
    } catch (const cv::Exception&) {
      decoder_->release();
    }
  }
  next_ = 0;
  is_grabbed_ = false;
}

std::optional<Duration> VideoFile::NextTime() {
  if (!is_grabbed_) {
    const QuietOpenCv quiet;
    is_grabbed_ = decoder_->isOpened() && decoder_->grab();
  }
  if (!is_grabbed_) return std::nullopt;
  return DurationFromSeconds(static_cast<double>(next_) / rate_hz_);
}

std::optional<cv::Mat> VideoFile::Read(std::string* error) {
  const QuietOpenCv quiet;
  is_grabbed_ = false;
  const std::int64_t index = next_++;
  cv::Mat image;
  if (!decoder_->retrieve(image) || image.empty() ||
      (image.type() != CV_8UC3 && image.type() != CV_8UC1)) {
    *error = path_ + ": frame " + std::to_string(index) + " cannot be decoded";
    return std::nullopt;
  }
  // The decoder keeps its own buffer.
  return image.clone();
}

}  // namespace waymark
