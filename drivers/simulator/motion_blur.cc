#include "drivers/simulator/motion_blur.h"

#include "estimation/base/check.h"

#include <opencv2/core.hpp>

namespace waymark {

cv::Mat3f GatherLight(const Renderer& renderer,
                      const CameraRays& camera,
                      std::span<const ExposureMoment> moments,
                      RenderQuality quality) {
  WAYMARK_CHECK(!moments.empty());
  RenderOptions options;
  options.quality = quality;
  options.image = false;
  options.linear = true;
  cv::Mat3f sum;
  for (const ExposureMoment& moment : moments) {
    cv::Mat3f light =
        renderer.Render(camera, moment.X_WC, moment.X_WP, options).linear;
    if (sum.empty()) {
      sum = light;
    } else {
      sum += light;
    }
  }
  sum *= 1.0 / static_cast<double>(moments.size());
  return sum;
}

}  // namespace waymark
