#include "processes/convert/camera_convert.h"

#include "estimation/camera/camera_parameters.h"
#include "processes/convert/message_check.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

// As in calibration files.
constexpr int kMaxSide = 20000;
constexpr double kMaxPosition = 100.0;

bool CheckPosition(const char* key, const double (&p)[3], std::string* reason) {
  for (const double value : p) {
    if (!(std::abs(value) <= kMaxPosition)) {
      return Refuse(
          reason, key, ": ", value, " m must be within +-", kMaxPosition);
    }
  }
  return true;
}

bool CheckNumbers(const camera_info_t& message, std::string* reason) {
  for (const int side : {message.width, message.height}) {
    if (side < 1 || side > kMaxSide) {
      return Refuse(
          reason, "size: ", side, " px must be in [1, ", kMaxSide, "]");
    }
  }
  const auto& q = message.orientation_R;
  const double norm =
      std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  // What a text of seven digits leaves of a unit quaternion.
  if (!(std::abs(norm - 1.0) <= 1e-6)) {
    return Refuse(reason, "orientation_R: norm ", norm, " must be 1");
  }
  return CheckTime("utime", message.utime, reason) &&
         CheckPosition("position_R", message.position_R, reason) &&
         CheckPosition("head_R", message.head_R, reason);
}

std::optional<CameraModel> ModelFrom(const camera_info_t& message,
                                     std::string* reason) {
  try {
    const CameraKind kind = CameraKindFromName(message.model);
    if (message.names != ParameterNames(kind)) {
      Refuse(reason, "names: not those of a ", message.model, " camera");
      return std::nullopt;
    }
    return CameraFromParameters(
        kind,
        Eigen::Map<const Eigen::VectorXd>(
            message.values.data(),
            static_cast<Eigen::Index>(message.values.size())));
  } catch (const std::invalid_argument& error) {
    *reason = error.what();
    return std::nullopt;
  }
}

}  // namespace

camera_info_t ToMessage(const CameraDescription& camera,
                        const std::string& name,
                        Time time,
                        std::int64_t seq) {
  camera_info_t message;
  message.utime = Microseconds(time);
  message.seq = static_cast<std::int32_t>(seq);
  message.camera = name;
  const CameraKind kind = KindOf(camera.model);
  message.model = NameOf(kind);
  message.width = camera.size.width;
  message.height = camera.size.height;
  message.names = ParameterNames(kind);
  const Eigen::VectorXd values = ParametersOf(camera.model);
  message.values.assign(values.begin(), values.end());
  message.num_parameters = static_cast<std::int32_t>(message.values.size());
  const Eigen::Quaterniond q(camera.X_RC.linear());
  const Eigen::Vector4d wxyz(q.w(), q.x(), q.y(), q.z());
  std::copy_n(camera.X_RC.translation().data(), 3, &message.position_R[0]);
  std::copy_n(wxyz.data(), 4, &message.orientation_R[0]);
  message.is_pan_tilt = static_cast<std::int8_t>(camera.p_RH.has_value());
  if (camera.p_RH) std::copy_n(camera.p_RH->data(), 3, &message.head_R[0]);
  return message;
}

std::optional<CameraDescription> CameraFromMessage(const camera_info_t& message,
                                                   std::string* reason) {
  if (!CheckNumbers(message, reason)) return std::nullopt;
  const std::optional<CameraModel> model = ModelFrom(message, reason);
  if (!model) return std::nullopt;
  CameraDescription camera;
  camera.model = *model;
  camera.size = {message.width, message.height};
  const auto& q = message.orientation_R;
  camera.X_RC.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3])
                             .normalized()
                             .toRotationMatrix();
  camera.X_RC.translation() =
      Eigen::Map<const Eigen::Vector3d>(&message.position_R[0]);
  if (message.is_pan_tilt != 0) {
    camera.p_RH = Eigen::Map<const Eigen::Vector3d>(&message.head_R[0]);
  }
  return camera;
}

}  // namespace waymark
