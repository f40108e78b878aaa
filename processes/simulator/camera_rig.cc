#include "processes/simulator/camera_rig.h"

#include "estimation/geometry/pose3.h"
#include "processes/convert/camera_convert.h"
#include "processes/support/channels.h"

#include <vector>

namespace waymark {
namespace {

// The axes of the head cross at the camera's centre.
PanTiltMount HeadMount(const CameraDescription& camera) {
  PanTiltMount mount;
  mount.X_RH.linear() =
      camera.X_RC.linear() * ForwardCameraRotation().transpose();
  mount.X_RH.translation() = camera.X_RC.translation();
  return mount;
}

ImageEncoderOptions EncoderOptions(const SimulatedCameraConfig& config) {
  ImageEncoderOptions options;
  options.format = config.is_raw ? ImageFormat::kRaw : ImageFormat::kJpeg;
  options.is_gray = config.is_gray;
  options.max_bytes = static_cast<int>(config.max_bytes);
  return options;
}

}  // namespace

CameraRig::CameraRig(const SimulatedCameraConfig& config,
                     const Renderer* renderer,
                     std::uint64_t /*seed*/)
    : config_(config),
      renderer_(renderer),
      camera_(LoadCameraFile(FindCameraFile(config.file))),
      mount_(HeadMount(camera_)),
      rays_(CameraView{camera_.model, camera_.size}),
      encoder_(EncoderOptions(config)),
      image_channel_(std::string(kImagePrefix) + config.name),
      info_channel_(std::string(kCameraInfoPrefix) + config.name) {}

Eigen::Isometry3d CameraRig::CameraPose(const ExposurePose& pose) const {
  const Eigen::Isometry3d X_RC =
      config_.has_head ? mount_.CameraOnRobot(pose.head.pan, pose.head.tilt)
                       : camera_.X_RC;
  return SpatialPose(pose.X_WR) * X_RC;
}

CameraRig::Shot CameraRig::Expose(const CameraEvent& event) {
  const ExposurePose& middle = event.poses[event.poses.size() / 2];
  RenderOptions options;
  options.quality = config_.quality == CameraQuality::kLive
                        ? RenderQuality::kLive
                        : RenderQuality::kStill;
  std::vector<Eigen::Isometry3d> X_WP;
  for (const Pose2& X : middle.X_WP) X_WP.push_back(SpatialPose(X));
  const RenderedView view =
      renderer_->Render(rays_, CameraPose(middle), X_WP, options);
  ImageTags tags;
  tags.time = event.frame.stamp;
  tags.seq = event.frame.number;
  if (config_.has_head)
    tags.head = HeadAngles{middle.head.pan, middle.head.tilt};
  Shot shot;
  shot.image = encoder_.Encode(view.image, tags, &shot.reason);
  if (!shot.image) shot.reason = image_channel_ + ": " + shot.reason;
  return shot;
}

camera_info_t CameraRig::Info(Time time, std::int64_t seq) const {
  camera_info_t message = ToMessage(camera_, config_.name, time, seq);
  message.is_pan_tilt = config_.has_head;
  if (config_.has_head) {
    Eigen::Vector3d::Map(message.head_R) = mount_.X_RH.translation();
  }
  return message;
}

SimulatedCamera CameraRig::timing() const {
  return {config_.name, config_.timing, static_cast<int>(config_.blur_samples)};
}

}  // namespace waymark
