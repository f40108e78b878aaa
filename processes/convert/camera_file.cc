#include "processes/convert/camera_file.h"

#include "drivers/video/image_file.h"
#include "estimation/base/input_error.h"
#include "estimation/camera/camera_parameters.h"
#include "estimation/camera/hyperbolic_mirror.h"
#include "estimation/geometry/angle.h"
#include "processes/support/configuration.h"
#include "processes/support/shipped_file.h"

#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

namespace waymark {
namespace {

// Focal lengths and centres, px, far beyond any camera's: what is larger is a
// slip, and would make every ray the same.
constexpr double kMaxFocal = 1e6;
constexpr double kMaxDistortion = 1e4;
constexpr double kMaxXi = 100.0;
constexpr double kMaxPosition = 100.0;  // m.

struct Contents {
  CameraKind kind = CameraKind::kPerspective;
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::vector<double> values;  // Of ParameterNames(kind).
  std::vector<double> mirror;  // Semi-axes, m; empty: none.
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double roll = 0.0;
  double pitch = 0.0;
  double yaw = 0.0;
  std::vector<double> head;  // Empty: the camera is fixed.

  void Describe(Describer& d) {
    std::vector<std::pair<std::string, CameraKind>> kinds;
    for (const CameraKind k : {CameraKind::kPerspective,
                               CameraKind::kFisheye,
                               CameraKind::kSphere,
                               CameraKind::kPanorama}) {
      kinds.emplace_back(NameOf(k), k);
    }
    d.Choice("model", &kind, kinds, "How rays become pixels");
    d.Integer("width", &width, 1, kMaxImageFileSide, "Of the image, px");
    d.Integer("height", &height, 1, kMaxImageFileSide, "Of the image, px");
    const std::vector<std::string>& names = ParameterNames(kind);
    values.resize(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
      d.Number(names[i],
               &values[i],
               RangeOf(names[i], i),
               i < 4 ? "px" : "Of the lens");
    }
    if (kind == CameraKind::kSphere) {
      d.Numbers("mirror",
                &mirror,
                2,
                "Semi-axes a, b of a hyperbolic mirror, m, instead of xi; fx, "
                "fy are the lens's then; empty: none");
    }
    d.Group(
        "mounting", [&] { DescribeMounting(d); }, "On the robot, X_RC");
  }

  static Range RangeOf(const std::string& name, std::size_t i) {
    if (name == "xi") return {0.0, kMaxXi};
    const double bound = i < 4 ? kMaxFocal : kMaxDistortion;
    return {-bound, bound};
  }

  void DescribeMounting(Describer& d) {
    d.Number("x",
             &x,
             {-kMaxPosition, kMaxPosition},
             "Forward of the robot's origin, m");
    d.Number("y", &y, {-kMaxPosition, kMaxPosition}, "To the left, m");
    d.Number("z", &z, {-kMaxPosition, kMaxPosition}, "Up, m");
    d.Degrees("roll_deg", &roll, {-180.0, 180.0}, "About the line of sight");
    d.Degrees("pitch_deg", &pitch, {-90.0, 90.0}, "Downward");
    d.Degrees("yaw_deg", &yaw, {-180.0, 180.0}, "To the left");
    d.Numbers("head",
              &head,
              3,
              "Crossing of a pan-tilt head's axes x, y, z, m; empty: none");
  }
};

Eigen::Matrix3d TurnOf(double yaw, double pitch, double roll) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

// Throws std::invalid_argument where the model refuses a value.
CameraModel ModelOf(const Contents& contents) {
  const CameraModel model = CameraFromParameters(
      contents.kind,
      Eigen::Map<const Eigen::VectorXd>(
          contents.values.data(),
          static_cast<Eigen::Index>(contents.values.size())));
  if (contents.mirror.empty()) return model;
  const SphereCamera& lens = std::get<SphereCamera>(model);
  if (lens.xi() != 0.0) {
    throw std::invalid_argument("mirror must not be beside xi");
  }
  return CameraFromMirror({contents.mirror[0], contents.mirror[1]},
                          lens.intrinsics(),
                          lens.distortion());
}

CameraDescription CameraOf(const Contents& contents,
                           const std::string& source) {
  if (contents.width == 0 || contents.height == 0) {
    throw InputError(source + ": width and height are missing");
  }
  if (contents.values[0] == 0.0 || contents.values[1] == 0.0) {
    throw InputError(source + ": fx and fy must be given, not 0");
  }
  if (contents.width * contents.height > kMaxImageFilePixels) {
    throw InputError(source + ": width x height must be at most " +
                     std::to_string(kMaxImageFilePixels) + " pixels");
  }
  CameraDescription camera;
  camera.size = {static_cast<int>(contents.width),
                 static_cast<int>(contents.height)};
  try {
    camera.model = ModelOf(contents);
  } catch (const std::invalid_argument& error) {
    throw InputError(source + ": " + error.what());
  }
  camera.X_RC.linear() = TurnOf(contents.yaw, contents.pitch, contents.roll) *
                         ForwardCameraRotation();
  camera.X_RC.translation() << contents.x, contents.y, contents.z;
  if (!contents.head.empty()) {
    camera.p_RH = Eigen::Map<const Eigen::Vector3d>(contents.head.data());
    if (!(camera.p_RH->cwiseAbs().maxCoeff() <= kMaxPosition)) {
      throw InputError(source + ": mounting.head must be within +-100 m");
    }
  }
  return camera;
}

}  // namespace

PanTiltMount MountOf(const CameraDescription& camera) {
  PanTiltMount mount;
  mount.X_RH.linear() =
      camera.X_RC.linear() * ForwardCameraRotation().transpose();
  mount.X_RH.translation() = camera.p_RH.value_or(camera.X_RC.translation());
  mount.lever_arm = mount.X_RH.inverse() * camera.X_RC.translation();
  return mount;
}

CameraDescription LoadCameraFile(const std::string& path) {
  Contents contents;
  LoadConfigurationFile(path, [&](Describer& d) { contents.Describe(d); });
  return CameraOf(contents, path);
}

CameraDescription CameraFromYaml(const std::string& yaml,
                                 const std::string& source) {
  Contents contents;
  LoadConfigurationText(
      yaml, source, [&](Describer& d) { contents.Describe(d); });
  return CameraOf(contents, source);
}

std::string YamlOfCamera(const CameraDescription& camera) {
  Contents contents;
  contents.kind = KindOf(camera.model);
  contents.width = camera.size.width;
  contents.height = camera.size.height;
  const Eigen::VectorXd values = ParametersOf(camera.model);
  contents.values.assign(values.begin(), values.end());
  contents.x = camera.X_RC.translation().x();
  contents.y = camera.X_RC.translation().y();
  contents.z = camera.X_RC.translation().z();
  const Eigen::Matrix3d R =
      camera.X_RC.linear() * ForwardCameraRotation().transpose();
  // Of a camera that looks straight up or down (within rounding) yaw and roll
  // are one turn, which is given as roll.
  constexpr double kVertical = 1e-9;
  const double horizontal = std::hypot(R(0, 0), R(1, 0));
  contents.yaw = horizontal < kVertical ? 0.0 : std::atan2(R(1, 0), R(0, 0));
  contents.pitch = std::atan2(-R(2, 0), horizontal);
  const Eigen::Matrix3d level = TurnOf(-contents.yaw, 0.0, 0.0) * R;
  contents.roll = std::atan2(-level(1, 2), level(1, 1));
  if (camera.p_RH) {
    contents.head.assign(camera.p_RH->begin(), camera.p_RH->end());
  }
  return PrintConfiguration([&](Describer& d) { contents.Describe(d); });
}

std::string FindCameraFile(const std::string& name) {
  return FindShippedFile(name, "cameras", "drivers/simulator/cameras", ".yaml");
}

}  // namespace waymark
