#include "processes/corridor_tracker/corridor_tracker_process.h"

#include "estimation/camera/panorama_camera.h"
#include "estimation/geometry/angle.h"
#include "estimation/geometry/pose3.h"
#include "processes/convert/camera_convert.h"
#include "processes/convert/corridor_file.h"
#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <chrono>
#include <string>
#include <vector>

namespace waymark {
namespace {

constexpr Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

// A corridor without boards as flat areas, by projecting its corners: floor and
// ceiling darker than the walls.
cv::Mat1b ImageOf(const CameraDescription& camera, const Pose2& X_LR) {
  const CorridorGeometry corridor =
      LoadCorridorFile(FindCorridorFile("corridor_plain")).front();
  const double half = 0.5 * *corridor.width;
  const double height = *corridor.height;
  const Eigen::Isometry3d X_CL = (SpatialPose(X_LR) * camera.X_RC).inverse();
  cv::Mat1b image(camera.size.height, camera.size.width, std::uint8_t{200});
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const auto ray = RayFromPixel(camera.model, {x, y});
      if (!ray) continue;
      const Eigen::Vector3d ray_L = X_CL.linear().transpose() * ray->ray;
      const Eigen::Vector3d p_L = X_CL.inverse().translation();
      const double wall =
          ((ray_L.y() > 0.0 ? half : -half) - p_L.y()) / ray_L.y();
      const double level =
          ((ray_L.z() > 0.0 ? height : 0.0) - p_L.z()) / ray_L.z();
      if (level < wall) image(y, x) = ray_L.z() > 0.0 ? 120 : 80;
    }
  }
  cv::GaussianBlur(image, image, {5, 5}, 1.0);
  return image;
}

class CorridorTrackerProcessTest : public testing::Test {
 protected:
  CorridorTrackerProcessTest() {
    camera_ = LoadCameraFile(FindCameraFile("perspective"));
    config_.corridors = "corridor_plain";
    config_.calibration = "perspective";
  }

  // `arrival`: when it comes; a clock that stepped tells another time.
  void PublishPose(Time time, const Pose2& X_WR) {
    PublishPose(time, X_WR, bus_.now());
  }

  void PublishPose(Time time, const Pose2& X_WR, Time arrival) {
    PoseEstimate estimate;
    estimate.time = time;
    estimate.is_known = true;
    estimate.X_WR = X_WR;
    estimate.covariance = Eigen::Vector3d(0.04, 0.01, 0.0025).asDiagonal();
    bus_.PublishAt(arrival, kPose, ToMessage(estimate, 0));
  }

  void PublishImage(Time time, const cv::Mat1b& image) {
    PublishImage(time, image, time + std::chrono::milliseconds(60));
  }

  void PublishImage(Time time, const cv::Mat1b& image, Time arrival) {
    ImageEncoder encoder({.format = ImageFormat::kRaw, .is_gray = true});
    std::string reason;
    const auto message = encoder.Encode(image, {time, seq_++, {}}, &reason);
    ASSERT_TRUE(message) << reason;
    bus_.PublishAt(arrival, "IMAGE_FRONT", *message);
  }

  std::vector<corridor_pose_t> Run() {
    CorridorTrackerProcess process(config_,
                                   bus_.AddProcess("corridor_tracker"));
    bus_.Run();
    return bus_.Messages<corridor_pose_t>(kCorridorPose);
  }

  CameraDescription camera_;
  CorridorTrackerConfig config_;
  LocalBus bus_{kStart};
  std::int64_t seq_ = 0;
};

// The world's axis is y = 1.
TEST_F(CorridorTrackerProcessTest, SaysWhereItIsFromAnImage) {
  const Pose2 X_LR{4.0, 0.3, RadiansFromDegrees(-7.0)};
  PublishPose(kStart, {4.0, 1.2, RadiansFromDegrees(-4.0)});
  PublishImage(kStart, ImageOf(camera_, X_LR));
  const auto answers = Run();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].status, "accepted") << answers[0].reason;
  EXPECT_EQ(answers[0].utime, Microseconds(kStart));
  EXPECT_EQ(answers[0].source, "FRONT");
  EXPECT_EQ(answers[0].corridor, "corridor");
  // What whoever draws it needs; times are those of a bus that is live.
  EXPECT_EQ(answers[0].width, 2.0);
  EXPECT_EQ(answers[0].height, 2.5);
  EXPECT_EQ(answers[0].lines_us, 0);
  EXPECT_EQ(answers[0].pose_us, 0);
  EXPECT_NEAR(answers[0].y_L, 0.3, 0.01);
  EXPECT_NEAR(answers[0].heading_L, RadiansFromDegrees(-7.0), 0.003);
  EXPECT_DOUBLE_EQ(answers[0].corridor_W[1], 1.0);
  EXPECT_NEAR(answers[0].sensor_R[0], 0.1, 1e-9);
  EXPECT_GT(answers[0].num_lines, 3);
}

TEST_F(CorridorTrackerProcessTest, SaysWhyNot) {
  const cv::Mat1b image = ImageOf(camera_, {4.0, 0.0, 0.0});
  using std::chrono::seconds;
  PublishImage(kStart, image);  // No pose yet.
  PublishPose(kStart + seconds(1), {4.0, 1.0, 0.0});
  PublishImage(kStart + seconds(1), cv::Mat1b(480, 640, std::uint8_t{0}));
  PublishPose(kStart + seconds(2), {4.0, 30.0, 0.0});
  PublishImage(kStart + seconds(2), image);
  PublishImage(kStart + seconds(3), cv::Mat1b(100, 100, std::uint8_t{0}));
  const auto answers = Run();
  ASSERT_EQ(answers.size(), 4u);
  EXPECT_EQ(answers[0].status, "ambiguous");
  EXPECT_EQ(answers[0].has_heading, 0);
  EXPECT_EQ(answers[1].status, "no_lines");
  EXPECT_EQ(answers[2].status, "outside");
  EXPECT_EQ(answers[3].status, "no_lines");
  for (std::size_t i = 0; i < answers.size(); ++i) {
    EXPECT_EQ(answers[i].seq, static_cast<int>(i));
    EXPECT_EQ(answers[i].has_y, 0);
    EXPECT_FALSE(answers[i].reason.empty());
  }
}

// A panorama is no camera that looks ahead; maps for a huge one would not fit
// into memory, and no image is of that size.
TEST_F(CorridorTrackerProcessTest, BadCalibrationsAreCountedNotFatal) {
  config_.calibration.clear();
  CameraDescription panorama = camera_;
  panorama.model = PanoramaCamera({160.0, 160.0, 319.5, 239.5});
  CameraDescription huge = camera_;
  huge.size = {20000, 20000};
  bus_.Publish("CAMERA_INFO_FRONT", ToMessage(panorama, "FRONT", kStart, 0));
  bus_.Publish("CAMERA_INFO_FRONT", ToMessage(huge, "FRONT", kStart, 1));
  PublishPose(kStart, {4.0, 1.0, 0.0});
  PublishImage(kStart, ImageOf(camera_, {4.0, 0.0, 0.0}));
  const auto answers = Run();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_NE(answers[0].reason.find("size"), std::string::npos)
      << answers[0].reason;
}

TEST_F(CorridorTrackerProcessTest, TakesTheCalibrationThatIsSaid) {
  config_.calibration.clear();
  bus_.Publish("CAMERA_INFO_FRONT", ToMessage(camera_, "FRONT", kStart, 0));
  PublishPose(kStart, {4.0, 1.2, RadiansFromDegrees(-4.0)});
  PublishImage(kStart, ImageOf(camera_, {4.0, 0.3, RadiansFromDegrees(-7.0)}));
  const auto answers = Run();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].status, "accepted") << answers[0].reason;
  EXPECT_NEAR(answers[0].y_L, 0.3, 0.01);
}

TEST_F(CorridorTrackerProcessTest, AClockThatStepsBackLeavesItAnswering) {
  using std::chrono::seconds;
  const cv::Mat1b image = ImageOf(camera_, {4.0, 0.3, 0.0});
  PublishPose(kStart + seconds(100), {4.0, 1.3, 0.0}, kStart);
  PublishImage(kStart + seconds(100), image, kStart + seconds(1));
  PublishPose(kStart, {4.0, 1.3, 0.0}, kStart + seconds(2));
  PublishImage(kStart, image, kStart + seconds(3));
  const auto answers = Run();
  ASSERT_EQ(answers.size(), 2u);
  for (const auto& answer : answers) EXPECT_EQ(answer.status, "accepted");
}

TEST_F(CorridorTrackerProcessTest, WaitsForTheCalibration) {
  config_.calibration.clear();
  PublishPose(kStart, {4.0, 1.0, 0.0});
  PublishImage(kStart, ImageOf(camera_, {4.0, 0.0, 0.0}));
  const auto answers = Run();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_NE(answers[0].reason.find("CAMERA_INFO_FRONT"), std::string::npos);
}

}  // namespace
}  // namespace waymark
