// Where images come from: a camera, a video file, a folder of images.
#pragma once

#include "estimation/base/time.h"

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

struct Frame {
  cv::Mat image;  // 8 bits, one channel (gray) or three (BGR).
  Time time;
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // The newest frame until `now` that has not been taken; nullopt: none new.
  // Never waits for a camera. Times never go back.
  [[nodiscard]] virtual std::optional<Frame> Take(Time now) = 0;

  // Why there are no images, in one line; "" where there are.
  [[nodiscard]] virtual std::string Fault() const = 0;
  // One line for each image skipped since the last call.
  [[nodiscard]] virtual std::vector<std::string> TakeWarnings() = 0;
  // No more will come.
  [[nodiscard]] virtual bool has_ended() const = 0;
  // Frames that gave way to newer ones before they were taken.
  [[nodiscard]] virtual std::int64_t num_missed() const = 0;
};

struct FrameSourceOptions {
  // "/dev/video0" or another character device; a folder of images; a pattern
  // such as "run1/*.png"; a video file.
  std::string source;
  // Of images: one line each, "time" or "time name", time in seconds.
  std::string times_file{};
  // Images without times: at this rate, 0: 10 Hz. Video files and cameras: at
  // this rate instead of their own where it is not 0.
  double rate_hz = 0.0;
  bool loops = false;  // Files: from the beginning again after the end.
  // Of a camera, px; 0: its own choice.
  int width = 0;
  int height = 0;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// `clock` stamps the frames of a camera, from a thread of its own. Files start
// to play with the first Take().
//
// Throws InputError with one line for files that cannot be used; a camera may
// come later.
[[nodiscard]] std::unique_ptr<FrameSource> OpenFrameSource(
    const FrameSourceOptions& options, std::function<Time()> clock);

}  // namespace waymark
