// What a calibration found, for people and for programs.
#pragma once

#include "estimation/camera/calibrate_camera.h"

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace waymark {

// One image with a board in it.
struct BoardImage {
  std::string path;
  BoardView view;
};

// Parameters with sigmas, then a line per image.
[[nodiscard]] std::string CalibrationTable(
    const CameraCalibration& calibration,
    const std::vector<BoardImage>& images,
    const CalibrationOptions& options);
[[nodiscard]] std::string CalibrationJson(const CameraCalibration& calibration,
                                          const std::vector<BoardImage>& images,
                                          const CalibrationOptions& options);

// `image` (8 bits, one channel) with the corners found (circles; crosses where
// left out) and the residuals from there, 50 times as long.
[[nodiscard]] cv::Mat DrawResiduals(const cv::Mat& image,
                                    const BoardView& view,
                                    const ViewCalibration& result,
                                    const CameraModel& camera);

}  // namespace waymark
