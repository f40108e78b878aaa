// Calibration files of cameras.
#pragma once

#include "estimation/camera/camera_model.h"
#include "estimation/camera/pan_tilt_mount.h"

#include <Eigen/Geometry>

#include <optional>
#include <string>

namespace waymark {

// What is known of one camera on a robot.
struct CameraDescription {
  CameraModel model = PerspectiveCamera(Intrinsics{});
  ImageSize size;
  Eigen::Isometry3d X_RC = Eigen::Isometry3d::Identity();  // Mounting; on a
                                                           // head: at pan and
                                                           // tilt 0.
  // Where the two axes of a pan-tilt head cross; absent: the camera is fixed.
  std::optional<Eigen::Vector3d> p_RH;
};

// The camera's head. At pan and tilt 0 it puts the camera at X_RC; without
// p_RH its axes cross in the camera's centre.
[[nodiscard]] PanTiltMount MountOf(const CameraDescription& camera);

// YAML, read as strictly as a configuration:
//
//   model: sphere            # perspective, fisheye, sphere, panorama
//   width: 1280
//   height: 1024
//   fx: 330.2                # then the others of ParameterNames(kind); those
//   ...                      # of the lens may be left out and are 0 then
//   mirror: [0.03, 0.04]     # sphere: semi-axes of a hyperbolic mirror, m,
//                            # instead of xi; fx, fy are the lens's then
//   mounting:                # X_RC; may be left out: at R, looking forward
//     x: 0.1                 # m
//     y: 0.0
//     z: 0.6
//     roll_deg: 0.0          # About the robot's axes, in the order yaw, pitch,
//     pitch_deg: 12.0        # roll, of a camera that looks along x: pitch
//     yaw_deg: 0.0           # downward and yaw to the left are positive.
//     head: [0.05, 0.0, 0.6] # Of a pan-tilt head: where its axes cross, m.
//
// Throws InputError with one line (file, key, value, allowed range) where it
// cannot be read or is no camera.
[[nodiscard]] CameraDescription LoadCameraFile(const std::string& path);
// The same from text; `source` names it in errors.
[[nodiscard]] CameraDescription CameraFromYaml(const std::string& yaml,
                                               const std::string& source);
// Path of a camera by name or path; a name may be one of those that come with
// Waymark: perspective, fisheye, mirror, panorama. Throws InputError that lists
// them.
[[nodiscard]] std::string FindCameraFile(const std::string& name);
// Loads back to the same numbers, but for rounding of the mounting's angles.
[[nodiscard]] std::string YamlOfCamera(const CameraDescription& camera);

}  // namespace waymark
