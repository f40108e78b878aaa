#include "processes/simulator/camera_rig.h"

#include "drivers/simulator/motion_blur.h"
#include "estimation/base/random.h"
#include "estimation/geometry/pose3.h"
#include "processes/convert/camera_convert.h"
#include "processes/support/channels.h"

#include <opencv2/core.hpp>

#include <vector>

namespace waymark {
namespace {

// A head that the calibration does not know turns about the camera's centre.
CameraDescription LoadCamera(const SimulatedCameraConfig& config) {
  CameraDescription camera = LoadCameraFile(FindCameraFile(config.file));
  if (config.has_head && !camera.p_RH) camera.p_RH = camera.X_RC.translation();
  return camera;
}

ImageEncoderOptions EncoderOptions(const SimulatedCameraConfig& config) {
  ImageEncoderOptions options;
  options.format = config.is_raw ? ImageFormat::kRaw : ImageFormat::kJpeg;
  options.is_gray = config.is_gray;
  options.max_bytes = static_cast<int>(config.max_bytes);
  return options;
}

// Cameras of other names have other noise.
ImageSensorOptions SensorOptions(const SimulatedCameraConfig& config,
                                 std::uint64_t seed) {
  ImageSensorOptions options = config.sensor;
  options.seed = SeedFor(seed, "sensor of " + config.name);
  return options;
}

}  // namespace

CameraRig::CameraRig(const SimulatedCameraConfig& config,
                     const Renderer* renderer,
                     std::uint64_t seed)
    : config_(config),
      renderer_(renderer),
      camera_(LoadCamera(config)),
      mount_(MountOf(camera_)),
      rays_(CameraView{camera_.model, camera_.size}),
      sensor_(SensorOptions(config, seed)),
      encoder_(EncoderOptions(config)),
      image_channel_(std::string(kImagePrefix) + config.name),
      info_channel_(std::string(kCameraInfoPrefix) + config.name) {}

Eigen::Isometry3d CameraRig::CameraPose(const ExposurePose& pose) const {
  const Eigen::Isometry3d X_RC =
      camera_.p_RH ? mount_.CameraOnRobot(pose.head.pan, pose.head.tilt)
                   : camera_.X_RC;
  return SpatialPose(pose.X_WR) * X_RC;
}

cv::Mat3f CameraRig::LightOf(const CameraEvent& event) const {
  std::vector<ExposureMoment> moments;
  for (const ExposurePose& pose : event.poses) {
    ExposureMoment& moment = moments.emplace_back();
    moment.X_WC = CameraPose(pose);
    for (const Pose2& X : pose.X_WP) moment.X_WP.push_back(SpatialPose(X));
  }
  return GatherLight(*renderer_,
                     rays_,
                     moments,
                     config_.quality == CameraQuality::kLive
                         ? RenderQuality::kLive
                         : RenderQuality::kStill);
}

bool CameraRig::IsCovered(const CameraEvent& event) const {
  const std::vector<double>& covered = config_.covered_way;
  return !covered.empty() && event.way >= covered[0] && event.way < covered[1];
}

cv::Mat CameraRig::ImageOf(const CameraEvent& event) {
  // The gain stays: what is uncovered again is not blinded by its own light.
  if (IsCovered(event)) {
    return cv::Mat::zeros(camera_.size.height,
                          camera_.size.width,
                          config_.is_gray ? CV_8UC1 : CV_8UC3);
  }
  const cv::Mat3f light = LightOf(event);
  const auto number = static_cast<std::uint64_t>(event.frame.number);
  const cv::Mat image = config_.is_gray
                            ? cv::Mat(sensor_.Grey(light, number))
                            : cv::Mat(sensor_.Colour(light, number));
  sensor_.Adapt(light, last_ ? Seconds(event.frame.stamp - *last_) : 0.0);
  last_ = event.frame.stamp;
  return image;
}

CameraRig::Shot CameraRig::Expose(const CameraEvent& event) {
  const cv::Mat image = ImageOf(event);
  ImageTags tags;
  tags.time = event.frame.stamp;
  tags.seq = event.frame.number;
  if (camera_.p_RH) {
    const PanTilt& head = event.poses[event.poses.size() / 2].head;
    tags.head = HeadAngles{head.pan, head.tilt};
  }
  Shot shot;
  shot.image = encoder_.Encode(image, tags, &shot.reason);
  if (!shot.image) shot.reason = image_channel_ + ": " + shot.reason;
  return shot;
}

camera_info_t CameraRig::Info(Time time, std::int64_t seq) const {
  return ToMessage(camera_, config_.name, time, seq);
}

SimulatedCamera CameraRig::timing() const {
  return {config_.name,
          config_.timing,
          static_cast<int>(config_.blur_samples),
          config_.head};
}

}  // namespace waymark
