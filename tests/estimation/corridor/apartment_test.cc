// The tracker alone on a real corridor: images of a fisheye lens on a wheeled
// robot, without odometry and without truth.
#include "estimation/camera/fisheye_camera.h"
#include "estimation/camera/image_remap.h"
#include "estimation/camera/pan_tilt_mount.h"
#include "estimation/corridor/corridor_tracker.h"
#include "estimation/geometry/angle.h"
#include "estimation/lines/manhattan_directions.h"
#include "tests/support/real_data.h"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace waymark {
namespace {

// By the calibration that comes with the images.
const FisheyeCamera kLens({182.322, 182.343, 320.975, 248.635},
                          {0.067955, -0.044254, 0.013958, -0.002250});
const CameraView kCamera{kLens, {640, 480}};

// The drives through the corridor, there and back: first and last image.
constexpr std::array kDrives = {std::pair<std::size_t, std::size_t>(105, 190),
                                std::pair<std::size_t, std::size_t>(275, 345)};

std::vector<std::string> Images(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(folder + "/frames")) {
    files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The axis of the corridor in the camera by three directions at right angles,
// downward known to some degrees: angle about the vertical, rad.
std::optional<double> AxisByDirections(const LineSet& lines,
                                       const Intrinsics& k) {
  DirectionPrior gravity;
  gravity.n_C = Eigen::Vector3d(0.0, 1.0, 0.1).normalized();
  gravity.sigma_rad = 0.05;
  const ManhattanReport found = FindManhattanDirections(
      lines.segments, {k.fx, k.fy, k.cx, k.cy}, gravity, {});
  if (!found.directions) return std::nullopt;
  const Eigen::Matrix3d& R = found.directions->R_CM;
  Eigen::Vector3d ahead =
      std::abs(R(2, 0)) > std::abs(R(2, 1)) ? R.col(0) : R.col(1);
  if (ahead.z() < 0.0) ahead = -ahead;
  return std::atan2(ahead.x(), ahead.z());
}

class Apartment : public testing::Test {
 protected:
  void SetUp() override {
    const std::string folder = RealDataFolder("mbot_apartment_corridor");
    if (folder.empty()) GTEST_SKIP() << "no real recordings";
    files_ = Images(folder);
    ASSERT_GT(files_.size(), kDrives.back().second);
  }

  [[nodiscard]] cv::Mat1b Load(std::size_t i) const {
    return cv::imread(files_[i], cv::IMREAD_GRAYSCALE);
  }

  std::vector<std::string> files_;
};

// After the lens is taken out, what is straight in the world is straight.
TEST_F(Apartment, LongLinesAreStraight) {
  CorridorTracker tracker(kCamera, {});
  const ImageRemap remap(tracker.view(), kCamera, Eigen::Matrix3d::Identity());
  LineExtractor extractor;
  std::vector<double> bends;
  std::size_t num_images = 0;
  for (const auto& [first, last] : kDrives) {
    for (std::size_t i = first; i < last; i += 3) {
      ++num_images;
      const LineSet set = extractor.Extract(cv::Mat1b(remap.Apply(Load(i))));
      for (const LineSegment& s : set.segments) {
        const Eigen::Vector2d way = s.b - s.a;
        if (way.norm() < 100.0) continue;
        // Mean of the middle third against that of both others: how far the
        // line is bowed.
        const Eigen::Vector2d n =
            Eigen::Vector2d(-way.y(), way.x()).normalized();
        double middle = 0.0;
        double outer = 0.0;
        int num_middle = 0;
        for (std::int32_t p = 0; p < s.num_pixels; ++p) {
          const Eigen::Vector2d pixel =
              set.pixels[static_cast<std::size_t>(s.first_pixel + p)]
                  .cast<double>();
          const double off = n.dot(pixel - s.a);
          if (3 * p >= s.num_pixels && 3 * p < 2 * s.num_pixels) {
            middle += off;
            ++num_middle;
          } else {
            outer += off;
          }
        }
        bends.push_back(std::abs(middle / num_middle -
                                 outer / (s.num_pixels - num_middle)));
      }
    }
  }
  EXPECT_GT(bends.size(), 2 * num_images);
  RecordProperty("median_bend_px", std::to_string(Median(bends)));
  EXPECT_LT(Median(bends), 0.3);
}

// The axis' direction changes as a robot of that size can turn, and most images
// have it; the tracker's heading is the same.
TEST_F(Apartment, HeadingIsSteadyFromImageToImage) {
  CorridorTrackerOptions options;
  // The lens' calibration is by others, and the robot sways.
  options.model_px = 1.0;
  options.model_rad = 0.01;
  options.heading.min_margin_share = 0.2;
  CorridorTracker tracker(kCamera, options);
  const ImageRemap remap(tracker.view(), kCamera, Eigen::Matrix3d::Identity());
  const Intrinsics k =
      std::get<PerspectiveCamera>(tracker.view().model).intrinsics();
  LineExtractor extractor;
  PanTiltMount mount;
  // As the directions say in the median over all images.
  mount.X_RH.translation().z() = 0.2;
  const Eigen::Isometry3d X_RC =
      mount.CameraOnRobot(0.0, RadiansFromDegrees(6.0)) *
      Eigen::AngleAxisd(RadiansFromDegrees(-1.1), Eigen::Vector3d::UnitZ());
  std::vector<double> steps;
  std::vector<double> differences;
  std::size_t num_images = 0;
  std::size_t num_axes = 0;
  for (const auto& [first, last] : kDrives) {
    CorridorPrior prior;
    prior.covariance = Eigen::Vector3d(1.0, 1.0, 0.02).asDiagonal();
    std::optional<double> before;
    for (std::size_t i = first; i < last; ++i) {
      ++num_images;
      const cv::Mat1b image = Load(i);
      const auto axis =
          AxisByDirections(extractor.Extract(cv::Mat1b(remap.Apply(image))), k);
      if (axis && before) steps.push_back(std::abs(*axis - *before));
      if (axis) before = axis;
      num_axes += axis ? 1 : 0;
      const CorridorEstimate found =
          tracker.Estimate(image, X_RC, CorridorGeometry{}, prior);
      EXPECT_FALSE(found.y) << "the corridor's size is not known";
      if (!found.heading) continue;
      prior.X_LR.heading = *found.heading;
      if (axis) differences.push_back(std::abs(*found.heading - *axis));
    }
  }
  EXPECT_GT(num_axes, num_images * 9 / 10);
  RecordProperty("median_step_deg",
                 std::to_string(DegreesFromRadians(Median(steps))));
  RecordProperty("headings", std::to_string(differences.size()));
  RecordProperty("median_difference_deg",
                 std::to_string(DegreesFromRadians(Median(differences))));
  std::printf("%zu images, %zu headings; step %.2f deg, difference %.2f deg\n",
              num_images,
              differences.size(),
              DegreesFromRadians(Median(steps)),
              DegreesFromRadians(Median(differences)));
  EXPECT_LT(Median(steps), RadiansFromDegrees(0.8));
  EXPECT_GT(differences.size(), num_images / 3);
  EXPECT_LT(Median(differences), RadiansFromDegrees(1.0));
}

}  // namespace
}  // namespace waymark
