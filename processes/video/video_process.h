// Driver of a camera, or what stands in for one.
#pragma once

#include "drivers/video/frame_source.h"
#include "processes/convert/camera_file.h"
#include "processes/convert/image_convert.h"
#include "processes/support/bus.h"
#include "processes/video/video_config.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace waymark {

// A camera, video file or folder of images -> IMAGE_<camera> as images come,
// CAMERA_INFO_<camera> (1 Hz, where a calibration is given). Recorded images
// are stamped with the time at which they are due, counted from the start; live
// ones with their arrival less latency_s. Faults on STATUS: no camera, images
// of another size than the calibration's (CAMERA_INFO is then withheld), images
// too large to send.
class VideoProcess {
 public:
  using Config = VideoConfig;
  static constexpr std::string_view kName = "video";
  static constexpr std::string_view kAbout =
      "Images of a camera, a video file or a folder -> IMAGE_<camera>, "
      "CAMERA_INFO_<camera>.";
  static constexpr bool kIsLiveOnly = true;

  VideoProcess(const Config& config, Bus* bus);

 private:
  void OnTimer(Time now);
  void Publish(const Frame& frame);
  void PublishCamera(Time now);
  [[nodiscard]] bool FitsCalibration(const Frame& frame);

  Config config_;
  Bus* bus_;
  std::string image_channel_;
  std::string info_channel_;
  std::optional<CameraDescription> camera_;
  ImageEncoder encoder_;
  std::string image_fault_;   // Of the newest image.
  std::string last_refusal_;  // Said once.
  bool fits_ = true;
  bool has_told_end_ = false;
  std::int64_t image_seq_ = 0;
  std::int64_t info_seq_ = 0;
  std::unique_ptr<FrameSource> source_;  // Last: its thread starts at once.
};

}  // namespace waymark
