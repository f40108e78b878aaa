// The image that another camera at the same place would have taken.
#pragma once

#include "estimation/camera/camera_model.h"

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace waymark {

struct CameraView {
  CameraModel model;
  ImageSize size;
};

// Where each pixel of one view lies in another. R_FromTo turns rays of `to`
// into those of `from`. Built once, used for every image.
class ImageRemap {
 public:
  // Throws std::invalid_argument where a size is not positive.
  ImageRemap(const CameraView& to,
             const CameraView& from,
             const Eigen::Matrix3d& R_FromTo);

  // `image`: of the size of `from`, 8 bits or float, any channels. The result
  // has the size of `to`; pixels that `from` does not see are 0. Bilinear.
  // Throws std::invalid_argument where the size differs.
  [[nodiscard]] cv::Mat Apply(const cv::Mat& image) const;

  // Pixels of `from`, CV_32F, as cv::remap takes them; 0 where not seen.
  [[nodiscard]] const cv::Mat& x() const { return x_; }
  [[nodiscard]] const cv::Mat& y() const { return y_; }
  [[nodiscard]] const cv::Mat& seen() const {
    return seen_;
  }  // CV_8U, 0 or 255.

 private:
  ImageSize from_;
  cv::Mat x_;
  cv::Mat y_;
  cv::Mat seen_;
  cv::Mat unseen_;
  bool has_unseen_ = false;
  // The same maps in steps of 1/32 px, the steps of cv::remap.
  cv::Mat whole_;
  cv::Mat fraction_;
};

}  // namespace waymark
