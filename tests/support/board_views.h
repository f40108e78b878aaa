// Views of a chessboard with known truth, for calibration.
#pragma once

#include "estimation/base/random.h"
#include "estimation/camera/calibrate_camera.h"

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace waymark {

// A camera to be found again, and what a calibration of it is told.
struct CalibrationCase {
  std::string name;
  CameraModel camera;
  CalibrationOptions options;
};

// One of each model that can be calibrated: "perspective", "fisheye", "mirror"
// and "parabolic_mirror" (xi known), 1280 x 1024.
[[nodiscard]] std::vector<CalibrationCase> CalibrationCases();

// 8 x 6 corners, 42 mm apart.
[[nodiscard]] std::vector<Eigen::Vector2d> BoardPoints();

// X_CB of a board 0.35 to 0.7 m along a ray, its middle on the ray, turned at
// random about its normal and tilted up to `tilt` about its own x and y.
[[nodiscard]] Eigen::Isometry3d RandomBoard(const Eigen::Vector3d& ray_C,
                                            double tilt,
                                            Random* random);

struct BoardScene {
  std::vector<BoardView> views;
  std::vector<Eigen::Isometry3d> poses;  // X_CB of each.
};

// Boards all over the image, whole ones only, tilted up to 0.7 rad; corners
// with noise of this sigma in x and y each.
[[nodiscard]] BoardScene MakeBoardScene(const CameraModel& camera,
                                        const ImageSize& size,
                                        int num_views,
                                        double noise_px,
                                        Random* random);

}  // namespace waymark
