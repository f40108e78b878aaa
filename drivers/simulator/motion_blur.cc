#include "drivers/simulator/motion_blur.h"

#include "estimation/base/check.h"

#include <opencv2/core.hpp>

namespace waymark {
namespace {

Eigen::Isometry3d Between(const Eigen::Isometry3d& a,
                          const Eigen::Isometry3d& b,
                          double share) {
  Eigen::Isometry3d between = Eigen::Isometry3d::Identity();
  between.linear() = Eigen::Quaterniond(a.linear())
                         .slerp(share, Eigen::Quaterniond(b.linear()))
                         .toRotationMatrix();
  between.translation() =
      a.translation() + share * (b.translation() - a.translation());
  return between;
}

}  // namespace

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

std::vector<ExposureMoment> MomentsBetween(const ExposureMoment& first,
                                           const ExposureMoment& last,
                                           int num_moments) {
  WAYMARK_CHECK(num_moments >= 1, num_moments);
  WAYMARK_CHECK(first.X_WP.size() == last.X_WP.size());
  std::vector<ExposureMoment> moments;
  for (int i = 0; i < num_moments; ++i) {
    const double share = (i + 0.5) / num_moments;
    ExposureMoment& moment = moments.emplace_back();
    moment.X_WC = Between(first.X_WC, last.X_WC, share);
    for (std::size_t k = 0; k < first.X_WP.size(); ++k) {
      moment.X_WP.push_back(Between(first.X_WP[k], last.X_WP[k], share));
    }
  }
  return moments;
}

}  // namespace waymark
