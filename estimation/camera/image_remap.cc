#include "estimation/camera/image_remap.h"

#include <opencv2/imgproc.hpp>

#include <cstdint>
#include <stdexcept>

namespace waymark {

ImageRemap::ImageRemap(const CameraView& to,
                       const CameraView& from,
                       const Eigen::Matrix3d& R_FromTo)
    : from_(from.size) {
  for (const ImageSize& size : {to.size, from.size}) {
    if (size.width <= 0 || size.height <= 0) {
      throw std::invalid_argument("an image's size is not positive");
    }
  }
  const cv::Size size(to.size.width, to.size.height);
  x_ = cv::Mat::zeros(size, CV_32F);
  y_ = cv::Mat::zeros(size, CV_32F);
  seen_ = cv::Mat::zeros(size, CV_8U);
  for (int v = 0; v < to.size.height; ++v) {
    for (int u = 0; u < to.size.width; ++u) {
      const auto back = RayFromPixel(to.model, {u, v});
      if (!back) continue;
      const auto there = PixelFromRay(from.model, R_FromTo * back->ray);
      if (!there || !IsInside(from.size, there->pixel)) continue;
      x_.at<float>(v, u) = static_cast<float>(there->pixel.x());
      y_.at<float>(v, u) = static_cast<float>(there->pixel.y());
      seen_.at<std::uint8_t>(v, u) = 255;
    }
  }
  unseen_ = seen_ == 0;
  has_unseen_ = cv::countNonZero(unseen_) > 0;
  // What cv::remap does with maps of floats for every image anew.
  cv::convertMaps(x_, y_, whole_, fraction_, CV_16SC2);
}

cv::Mat ImageRemap::Apply(const cv::Mat& image) const {
  if (image.cols != from_.width || image.rows != from_.height) {
    throw std::invalid_argument("an image is not of the remap's size");
  }
  // Half a pixel beyond the outermost centres is still inside, so the edge is
  // repeated there; what is nowhere is blanked afterwards.
  cv::Mat result;
  cv::remap(
      image, result, whole_, fraction_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  if (has_unseen_) result.setTo(cv::Scalar::all(0.0), unseen_);
  return result;
}

}  // namespace waymark
