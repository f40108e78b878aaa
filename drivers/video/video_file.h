// A video file as a recording.
#pragma once

#include "drivers/video/played_frames.h"

#include <cstdint>
#include <memory>
#include <string>

namespace waymark {

// What FFmpeg, as OpenCV uses it, or OpenCV itself (Motion JPEG in AVI) can
// decode.
class VideoFile final : public Recording {
 public:
  // Throws InputError with one line where it cannot be opened, or states no
  // rate and none is given (rate_hz 0).
  VideoFile(std::string path, double rate_hz);
  ~VideoFile() override;
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  [[nodiscard]] std::optional<Duration> NextTime() override;
  [[nodiscard]] std::optional<cv::Mat> Read(std::string* error) override;
  void Rewind() override;

 private:
  class Decoder;
  std::string path_;
  std::unique_ptr<Decoder> decoder_;
  double rate_hz_ = 0.0;
  std::int64_t next_ = 0;
  bool is_grabbed_ = false;  // The next frame waits in the decoder.
};

}  // namespace waymark
