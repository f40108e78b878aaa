#include "estimation/camera/image_remap.h"

#include "estimation/geometry/angle.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cstdint>
#include <stdexcept>

namespace waymark {
namespace {

// Grey that rises by two a column and one a row.
cv::Mat Ramp(const ImageSize& size) {
  cv::Mat image(size.height, size.width, CV_32FC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      image.at<float>(v, u) = static_cast<float>(2 * u + v);
    }
  }
  return image;
}

TEST(ImageRemap, ToTheSameViewIsTheSameImage) {
  const CameraView view{
      PerspectiveCamera({200.0, 201.0, 79.0, 61.0}, {-0.1, 0.01}), {160, 120}};
  const ImageRemap remap(view, view, Eigen::Matrix3d::Identity());
  const cv::Mat image = Ramp(view.size);
  // cv::remap counts in 32nds of a pixel.
  EXPECT_LT(cv::norm(remap.Apply(image), image, cv::NORM_INF), 2.0 / 32);
  EXPECT_EQ(cv::countNonZero(remap.seen()), 160 * 120);
}

TEST(ImageRemap, TurnedPanoramaIsShifted) {
  const CameraView view{PanoramaCamera::WholeTurn({360, 40}, 19.5), {360, 40}};
  const cv::Mat image = Ramp(view.size);
  // `to` looks 10 degrees farther right (about C's y, which points down).
  const Eigen::Matrix3d R_FromTo =
      Eigen::AngleAxisd(RadiansFromDegrees(10.0), Eigen::Vector3d::UnitY())
          .toRotationMatrix();
  const cv::Mat turned = ImageRemap(view, view, R_FromTo).Apply(image);
  for (const int u : {100, 180, 250}) {
    EXPECT_NEAR(turned.at<float>(20, u), image.at<float>(20, u + 10), 0.1);
  }
}

TEST(ImageRemap, PanoramaOfAMirrorShowsWhatTheMirrorShows) {
  const CameraView mirror{SphereCamera(1.0, {120.0, -120.0, 159.5, 159.5}),
                          {320, 320}};
  const CameraView panorama{PanoramaCamera::WholeTurn({512, 128}, 40.0),
                            {512, 128}};
  // The mirror's axis (its z, toward the lens) points down: the panorama's y.
  Eigen::Matrix3d R_MirrorPanorama;
  R_MirrorPanorama << 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0;
  const ImageRemap remap(panorama, mirror, R_MirrorPanorama);
  const cv::Mat image = Ramp(mirror.size);
  const cv::Mat result = remap.Apply(image);
  int num_seen = 0;
  for (int v = 0; v < 128; v += 9) {
    for (int u = 0; u < 512; u += 17) {
      const auto back = RayFromPixel(panorama.model, {u, v});
      ASSERT_TRUE(back);
      const auto there =
          PixelFromRay(mirror.model, R_MirrorPanorama * back->ray);
      const bool is_seen = there && IsInside(mirror.size, there->pixel);
      EXPECT_EQ(remap.seen().at<std::uint8_t>(v, u), is_seen ? 255 : 0);
      if (!is_seen) {
        EXPECT_EQ(result.at<float>(v, u), 0.0f);
        continue;
      }
      ++num_seen;
      if (there->pixel.minCoeff() < 0.0 || there->pixel.maxCoeff() > 319.0) {
        continue;  // Where the edge is repeated.
      }
      EXPECT_NEAR(result.at<float>(v, u),
                  2.0 * there->pixel.x() + there->pixel.y(),
                  0.15);
    }
  }
  EXPECT_GT(num_seen, 200);
}

TEST(ImageRemap, WrongSizesAreRefused) {
  const CameraView view{PerspectiveCamera({200.0, 200.0, 79.5, 59.5}),
                        {160, 120}};
  CameraView none = view;
  none.size.width = 0;
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  EXPECT_THROW(ImageRemap(none, view, same), std::invalid_argument);
  EXPECT_THROW((void)ImageRemap(view, view, same).Apply(Ramp({120, 160})),
               std::invalid_argument);
}

}  // namespace
}  // namespace waymark
