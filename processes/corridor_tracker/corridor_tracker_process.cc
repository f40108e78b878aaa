#include "processes/corridor_tracker/corridor_tracker_process.h"

#include "estimation/camera/camera_parameters.h"
#include "processes/convert/camera_convert.h"
#include "processes/convert/corridor_file.h"
#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

// Where the camera sits in the plane, and which way it looks.
Pose2 PlanarMounting(const Eigen::Isometry3d& X_RC) {
  const Eigen::Vector3d forward = X_RC.linear().col(2);
  return {X_RC.translation().x(),
          X_RC.translation().y(),
          std::atan2(forward.y(), forward.x())};
}

Eigen::Isometry3d MountingOf(const CameraDescription& camera,
                             const std::optional<HeadAngles>& head) {
  if (!head) return camera.X_RC;
  return MountOf(camera).CameraOnRobot(head->pan, head->tilt);
}

CorridorEstimate None(CorridorStatus status, std::string reason) {
  CorridorEstimate estimate;
  estimate.status = status;
  estimate.reason = std::move(reason);
  return estimate;
}

}  // namespace

CorridorTrackerProcess::CorridorTrackerProcess(const Config& config, Bus* bus)
    : config_(config),
      bus_(bus),
      image_channel_(std::string(kImagePrefix) + config.camera),
      info_channel_(std::string(kCameraInfoPrefix) + config.camera),
      corridors_(LoadCorridorFile(FindCorridorFile(config.corridors))) {
  std::string names;
  for (const CorridorGeometry& corridor : corridors_) {
    names += (names.empty() ? "" : ", ") + corridor.name;
  }
  spdlog::info("corridors of {}: {}", config.corridors, names);
  if (!config.calibration.empty()) {
    config.CheckFiles();
    SetCamera(LoadCameraFile(FindCameraFile(config.calibration)));
  } else {
    bus->Subscribe<camera_info_t>(
        info_channel_, Keep::Latest(), [this](const camera_info_t& m, Time) {
          OnInfo(m);
        });
  }
  bus->Advertise<corridor_pose_t>(kCorridorPose, config.camera);
  bus->Subscribe<pose_t>(
      kPose, Keep::All(), [this](const pose_t& m, Time) { OnPose(m); });
  bus->Subscribe<image_t>(image_channel_,
                          Keep::Latest(),
                          [this](const image_t& m, Time) { OnImage(m); });
}

void CorridorTrackerProcess::OnInfo(const camera_info_t& message) {
  std::string reason;
  if (const auto camera = CameraFromMessage(message, &reason)) {
    try {
      CheckSeesAhead(camera->model);
      SetCamera(*camera);
      return;
    } catch (const std::invalid_argument& error) {
      reason = error.what();
    }
  }
  bus_->ReportBad(info_channel_, Bad::kContent, reason);
}

void CorridorTrackerProcess::OnPose(const pose_t& message) {
  std::string reason;
  if (const auto pose = PoseEstimateFromMessage(message, &reason)) {
    history_.Add(*pose);
  } else {
    bus_->ReportBad(kPose, Bad::kContent, reason);
  }
}

void CorridorTrackerProcess::SetCamera(const CameraDescription& camera) {
  // Said once a second; what it looks through is made anew when it changes.
  const bool is_same =
      camera_ && camera.size == camera_->size &&
      KindOf(camera.model) == KindOf(camera_->model) &&
      ParametersOf(camera.model) == ParametersOf(camera_->model);
  camera_ = camera;
  if (!is_same) tracker_.reset();
}

void CorridorTrackerProcess::OnImage(const image_t& message) {
  std::string reason;
  const auto tags = TagsFromMessage(message, &reason);
  const auto image = tags
                         ? ImageFromMessage(message, ImageColor::kGray, &reason)
                         : std::nullopt;
  if (!image) {
    bus_->ReportBad(image_channel_, Bad::kContent, reason);
    return;
  }
  CorridorAnswer answer;
  answer.time = tags->time;
  answer.seq = seq_++;
  answer.source = config_.camera;
  answer.estimate = EstimateOf(*image, *tags, &answer);
  bus_->Publish(kCorridorPose, ToMessage(answer));
}

CorridorEstimate CorridorTrackerProcess::EstimateOf(const cv::Mat1b& image,
                                                    const ImageTags& tags,
                                                    CorridorAnswer* answer) {
  if (!camera_) {
    return None(CorridorStatus::kNoLines,
                "no calibration of the camera yet: " + info_channel_);
  }
  if (image.cols != camera_->size.width || image.rows != camera_->size.height) {
    return None(CorridorStatus::kNoLines,
                "the image is not of the calibration's size");
  }
  // Not before: an image's size is limited, a calibration's is not.
  if (!tracker_) {
    tracker_ = std::make_unique<CorridorTracker>(
        CameraView{camera_->model, camera_->size}, config_.Options());
  }
  const Eigen::Isometry3d X_RC = MountingOf(*camera_, tags.head);
  answer->X_RS = PlanarMounting(X_RC);
  const CorridorChoice choice =
      ChooseCorridor(corridors_, history_.At(tags.time));
  if (!choice.corridor) return None(CorridorStatus::kOutside, choice.reason);
  const CorridorGeometry& corridor = corridors_[*choice.corridor];
  answer->corridor = corridor;
  const Time begin = bus_->now();
  const LineSet lines = tracker_->FindLines(image);
  const Time found = bus_->now();
  CorridorEstimate estimate =
      tracker_->EstimateFrom(lines, X_RC, corridor, choice.prior);
  answer->lines_took = found - begin;
  answer->pose_took = bus_->now() - found;
  return estimate;
}

}  // namespace waymark
