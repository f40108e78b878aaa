// Camera calibration from views of a flat board.
#pragma once

#include "estimation/camera/camera_parameters.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace waymark {

struct CalibrationOptions {
  CameraKind kind = CameraKind::kPerspective;  // Not kPanorama.
  ImageSize size;
  // The image shows the scene mirrored (a lens that looks into one mirror): fy
  // is negative then. Views of a flat board look the same either way.
  bool is_mirrored = false;
  // How many coefficients of the lens are estimated, in the order of
  // ParameterNames (perspective and sphere up to 5, fisheye up to 4); the
  // others are 0.
  int num_distortion = 4;
  std::optional<double> xi;  // Sphere: known, not estimated (1: parabolic).
  // Corners that are off by more than so many standard deviations are left out.
  double max_corner_sigmas = 5.0;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Entry i of `pixels` shows entry i of `points_B`, in m on the board.
struct BoardView {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<Eigen::Vector2d> points_B;
};

struct ViewCalibration {
  Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
  int num_used = 0;      // Corners.
  int num_left_out = 0;  // Corners that were off.
  double rms_px = 0.0;   // Root mean square of the distances, of those used.
  double max_px = 0.0;
};

struct CameraCalibration {
  CameraModel camera = PerspectiveCamera(Intrinsics{});
  // One sigma of each of ParameterNames(kind), 0 where it was not estimated;
  // from the residuals' own scatter.
  Eigen::VectorXd sigma;
  double sigma_px = 0.0;  // Of a corner's x and y each.
  double rms_px = 0.0;    // As in views, over all.
  std::vector<ViewCalibration> views;
};

struct CalibrationReport {
  std::optional<CameraCalibration> result;
  std::string reason;  // Why there is none.
};

// Least squares of all corners' pixels over the camera and a pose per view
// (Ceres, Levenberg-Marquardt). The start is linear in the poses, for a range
// of focal lengths and the principal point in the middle of the image. No
// answer where fewer than two views hold a board of four corners or more, no
// start is found, or the views do not show all parameters (boards all
// parallel, say). Throws std::invalid_argument where a view's lists differ in
// length or a value is not finite. Deterministic; some 0.1 s for 10 views of
// 48 corners.
[[nodiscard]] CalibrationReport CalibrateCamera(
    std::span<const BoardView> views, const CalibrationOptions& options);

}  // namespace waymark
