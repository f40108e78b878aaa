// A camera that waits for its next image.
#pragma once

#include <opencv2/core/mat.hpp>

#include <memory>
#include <string>

namespace waymark {

class CameraDevice {
 public:
  virtual ~CameraDevice() = default;
  // Waits for the next image, and copies it; false: the camera is gone.
  virtual bool Read(cv::Mat* image) = 0;
};

struct CameraRequest {
  std::string device;  // "/dev/video0".
  int width = 0;       // px; 0: the camera's own choice.
  int height = 0;
  double rate_hz = 0.0;  // 0: the camera's own choice.
};

// By V4L2, through OpenCV. Returns null and sets *error (one line: device,
// what, why) where there is no such camera, or it does not do what is asked
// for.
[[nodiscard]] std::unique_ptr<CameraDevice> OpenCamera(
    const CameraRequest& request, std::string* error);

}  // namespace waymark
