#include "drivers/video/frame_source.h"

#include "drivers/video/camera_device.h"
#include "drivers/video/image_sequence.h"
#include "drivers/video/live_frames.h"
#include "drivers/video/played_frames.h"
#include "drivers/video/video_file.h"

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace waymark {
namespace {

bool IsCamera(const std::string& source) {
  // Also one that is not plugged in yet.
  if (source.starts_with("/dev/video")) return true;
  std::error_code ignored;
  return std::filesystem::is_character_file(source, ignored);
}

bool IsImages(const std::string& source) {
  std::error_code ignored;
  return std::filesystem::is_directory(source, ignored) ||
         source.find_first_of("*?[") != std::string::npos;
}

}  // namespace

void FrameSourceOptions::Check() const {
  if (source.empty()) throw std::invalid_argument("source is missing");
  if (!(rate_hz >= 0.0) || !std::isfinite(rate_hz)) {
    throw std::invalid_argument("rate_hz must not be negative");
  }
  if (width < 0 || height < 0 || (width == 0) != (height == 0)) {
    throw std::invalid_argument("width and height: both, positive, or neither");
  }
}

std::unique_ptr<FrameSource> OpenFrameSource(const FrameSourceOptions& options,
                                             std::function<Time()> clock) {
  options.Check();
  if (IsCamera(options.source)) {
    const CameraRequest request{
        options.source, options.width, options.height, options.rate_hz};
    return std::make_unique<LiveFrames>(
        LiveFramesOptions{options.source},
        [request](std::string* error) { return OpenCamera(request, error); },
        std::move(clock));
  }
  std::unique_ptr<Recording> recording;
  if (IsImages(options.source)) {
    recording = std::make_unique<ImageSequence>(
        options.source, options.times_file, options.rate_hz);
  } else {
    recording = std::make_unique<VideoFile>(options.source, options.rate_hz);
  }
  return std::make_unique<PlayedFrames>(
      options.source, std::move(recording), options.loops);
}

}  // namespace waymark
