#include "drivers/video/camera_device.h"

#include "drivers/video/quiet_opencv.h"

#include <fcntl.h>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace waymark {
namespace {

class V4l2Camera final : public CameraDevice {
 public:
  bool Open(const CameraRequest& request) {
    if (!capture_.open(request.device, cv::CAP_V4L2)) return false;
    if (request.width > 0) {
      // At most sizes cameras send full rate as Motion JPEG only.
      capture_.set(cv::CAP_PROP_FOURCC,
                   cv::VideoWriter::fourcc('M', 'J', 'P', 'G'));
      capture_.set(cv::CAP_PROP_FRAME_WIDTH, request.width);
      capture_.set(cv::CAP_PROP_FRAME_HEIGHT, request.height);
    }
    if (request.rate_hz > 0.0) {
      capture_.set(cv::CAP_PROP_FPS, request.rate_hz);
    }
    // Old images are of no use.
    capture_.set(cv::CAP_PROP_BUFFERSIZE, 1);
    return true;
  }
  [[nodiscard]] int width() {
    return static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH));
  }
  [[nodiscard]] int height() {
    return static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT));
  }

  bool Read(cv::Mat* image) override {
    try {
      return capture_.read(*image) && !image->empty();
    } catch (const cv::Exception&) {
      return false;
    }
  }

 private:
  cv::VideoCapture capture_;
};

}  // namespace

std::unique_ptr<CameraDevice> OpenCamera(const CameraRequest& request,
                                         std::string* error) {
  // OpenCV does not say why.
  const int fd =
      ::open(request.device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    *error = request.device + ": cannot open: " + std::strerror(errno);
    return nullptr;
  }
  ::close(fd);
  const QuietOpenCv quiet;
  auto camera = std::make_unique<V4l2Camera>();
  bool is_open = false;
  try {
    is_open = camera->Open(request);
  } catch (const cv::Exception&) {
    is_open = false;
  }
  if (!is_open) {
    *error = request.device + ": is no camera, or another process uses it";
    return nullptr;
  }
  if (request.width > 0 && (camera->width() != request.width ||
                            camera->height() != request.height)) {
    *error = request.device + ": has no images of " +
             std::to_string(request.width) + " x " +
             std::to_string(request.height) + " px, but of " +
             std::to_string(camera->width()) + " x " +
             std::to_string(camera->height());
    return nullptr;
  }
  return camera;
}

}  // namespace waymark
