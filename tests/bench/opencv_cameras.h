// OpenCV's cameras and calibrations beside ours.
#pragma once

#include "estimation/camera/calibrate_camera.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace waymark {

struct OpenCvCalibration {
  CameraModel camera = PerspectiveCamera(Intrinsics{});
  double rms_px = 0.0;    // Of the distances, over the views that were used.
  std::vector<int> used;  // Indices of the views.
};

// cv::calibrateCamera, cv::fisheye::calibrate or cv::omnidir::calibrate of the
// same corners and with the same parameters to be found, where it has a way to
// say so: of a sphere it knows no fixed xi but 1 and no k3. Nullopt where it
// throws or comes to numbers that are not finite.
[[nodiscard]] std::optional<OpenCvCalibration> CalibrateWithOpenCv(
    std::span<const BoardView> views, const CalibrationOptions& options);

// cv::projectPoints and its like: pixels of points in C.
[[nodiscard]] std::vector<Eigen::Vector2d> ProjectWithOpenCv(
    const CameraModel& camera, std::span<const Eigen::Vector3d> points_C);
// cv::undistortPoints and its like: points of the plane z = 1. `num_steps` of
// the perspective camera's iteration; the others have their own.
[[nodiscard]] std::vector<Eigen::Vector2d> UndistortWithOpenCv(
    const CameraModel& camera,
    std::span<const Eigen::Vector2d> pixels,
    int num_steps);

}  // namespace waymark
