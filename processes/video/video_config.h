// Configuration of video.
#pragma once

#include "drivers/video/frame_source.h"
#include "processes/convert/image_convert.h"
#include "processes/support/describer.h"

#include <string>

namespace waymark {

struct VideoConfig {
  std::string camera = "FRONT";
  FrameSourceOptions source{.source = "/dev/video0"};
  std::string calibration;  // Path; empty: not known.
  double latency_s = 0.0;
  ImageEncoderOptions encoder;

  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const;
};

}  // namespace waymark
