// Camera models as lists of numbers: what calibration estimates and files hold.
#pragma once

#include "estimation/camera/camera_model.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

enum class CameraKind { kPerspective, kFisheye, kSphere, kPanorama };

// "perspective", "fisheye", "sphere", "panorama".
[[nodiscard]] std::string_view NameOf(CameraKind kind);
// Throws std::invalid_argument that lists the names.
[[nodiscard]] CameraKind CameraKindFromName(std::string_view name);
[[nodiscard]] CameraKind KindOf(const CameraModel& camera);

// Names of all numbers of a kind, in order: fx, fy, cx, cy, then perspective
// k1, k2, p1, p2, k3; fisheye k1, k2, k3, k4; sphere xi, k1, k2, p1, p2, k3.
[[nodiscard]] const std::vector<std::string>& ParameterNames(CameraKind kind);

[[nodiscard]] Eigen::VectorXd ParametersOf(const CameraModel& camera);
// Throws std::invalid_argument where the model refuses a value or the number
// of values is not that of the names.
[[nodiscard]] CameraModel CameraFromParameters(CameraKind kind,
                                               const Eigen::VectorXd& values);

// Derivative of a pixel by each of ParameterNames(kind).
using ParameterJacobian =
    Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 10>;
// Of the pixel that sees this point in C; nullopt where ExtendedPixelFromRay
// has none.
[[nodiscard]] std::optional<ParameterJacobian> PixelByParameters(
    const CameraModel& camera, const Eigen::Vector3d& point_C);

}  // namespace waymark
