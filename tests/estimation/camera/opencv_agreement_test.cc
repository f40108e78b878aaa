// Where OpenCV has the model, ours is the same.
#include "estimation/base/random.h"
#include "estimation/camera/camera_model.h"

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/ccalib/omnidir.hpp>

#include <vector>

namespace waymark {
namespace {

constexpr double kTolerance = 1e-9;  // px.

const Intrinsics kLens{674.9, 671.2, 307.5, 251.4};
const cv::Matx33d kMatrix(
    kLens.fx, 0.0, kLens.cx, 0.0, kLens.fy, kLens.cy, 0.0, 0.0, 1.0);

std::vector<cv::Point3d> Points(double spread) {
  Random random(11);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 500; ++i) {
    const double z = random.Uniform(0.5, 10.0);
    points.emplace_back(z * random.Uniform(-spread, spread),
                        z * random.Uniform(-spread, spread),
                        z);
  }
  return points;
}

void ExpectSame(const CameraModel& camera,
                const std::vector<cv::Point3d>& points,
                const std::vector<cv::Point2d>& pixels) {
  ASSERT_EQ(points.size(), pixels.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto ours =
        PixelFromRay(camera, {points[i].x, points[i].y, points[i].z});
    ASSERT_TRUE(ours) << points[i];
    EXPECT_NEAR(ours->pixel.x(), pixels[i].x, kTolerance);
    EXPECT_NEAR(ours->pixel.y(), pixels[i].y, kTolerance);
  }
}

TEST(OpenCvAgreement, Perspective) {
  const LensDistortion d{-0.28, 0.08, 1.2e-3, -4e-4, 0.011};
  const auto points = Points(0.6);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points,
                    cv::Vec3d::all(0.0),
                    cv::Vec3d::all(0.0),
                    kMatrix,
                    std::vector<double>{d.k1, d.k2, d.p1, d.p2, d.k3},
                    pixels);
  ExpectSame(PerspectiveCamera(kLens, d), points, pixels);
}

TEST(OpenCvAgreement, Fisheye) {
  const FisheyeCamera::Coefficients k{0.067955, -0.044254, 0.013958, -0.00225};
  const auto points = Points(3.0);
  std::vector<cv::Point2d> pixels;
  cv::fisheye::projectPoints(points,
                             pixels,
                             cv::Vec3d::all(0.0),
                             cv::Vec3d::all(0.0),
                             kMatrix,
                             cv::Vec4d(k[0], k[1], k[2], k[3]));
  ExpectSame(FisheyeCamera(kLens, k), points, pixels);
}

TEST(OpenCvAgreement, Sphere) {
  const LensDistortion d{-0.11, 0.02, 3e-4, -7e-4, 0.0};
  const auto points = Points(2.0);
  for (const double xi : {0.7, 1.0, 1.4}) {
    std::vector<cv::Point2d> pixels;
    cv::omnidir::projectPoints(points,
                               pixels,
                               cv::Vec3d::all(0.0),
                               cv::Vec3d::all(0.0),
                               kMatrix,
                               xi,
                               cv::Vec4d(d.k1, d.k2, d.p1, d.p2));
    ExpectSame(SphereCamera(xi, kLens, d), points, pixels);
  }
}

}  // namespace
}  // namespace waymark
