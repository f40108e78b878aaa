// Every channel name, declared once. lcmtypes/README.md is the table of
// record: type, producer, rate, policy.
#pragma once

#include <string_view>

namespace waymark {

inline constexpr std::string_view kEncoders = "ENCODERS";
inline constexpr std::string_view kPositionFix = "POSITION_FIX";
inline constexpr std::string_view kCorridorPose = "CORRIDOR_POSE";
inline constexpr std::string_view kRelativeMotion = "RELATIVE_MOTION";
inline constexpr std::string_view kInitialPose = "INITIAL_POSE";
inline constexpr std::string_view kTruth = "TRUTH";
inline constexpr std::string_view kRanges = "RANGES";
inline constexpr std::string_view kOdometry = "ODOMETRY";
inline constexpr std::string_view kPose = "POSE";
inline constexpr std::string_view kPoseSettled = "POSE_SETTLED";
inline constexpr std::string_view kPoseBot = "POSE_BOT";
inline constexpr std::string_view kOdometryParameters = "ODOMETRY_PARAMETERS";
inline constexpr std::string_view kStatus = "STATUS";
inline constexpr std::string_view kConfig = "CONFIG";
inline constexpr std::string_view kTask = "TASK";
inline constexpr std::string_view kTaskStatus = "TASK_STATUS";
inline constexpr std::string_view kMotionRequest = "MOTION_REQUEST";
inline constexpr std::string_view kMotionCommand = "MOTION_COMMAND";
inline constexpr std::string_view kStop = "STOP";
inline constexpr std::string_view kPanTiltCommand = "PAN_TILT_COMMAND";
inline constexpr std::string_view kBase = "BASE";
// Followed by the camera's name: IMAGE_FRONT.
inline constexpr std::string_view kImagePrefix = "IMAGE_";
inline constexpr std::string_view kCameraInfoPrefix = "CAMERA_INFO_";
// Whether it may follow them: A-Z, 0-9 and _ alone.
[[nodiscard]] constexpr bool IsCameraName(std::string_view name) {
  constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  return !name.empty() &&
         name.find_first_not_of(kAllowed) == std::string_view::npos;
}

}  // namespace waymark
