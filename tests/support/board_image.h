// Pictures of a chessboard through any camera model.
#pragma once

#include "estimation/camera/board_detector.h"
#include "estimation/camera/camera_model.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

namespace waymark {

// Gray, 8 bits: black and white squares with a white rim of one square before
// a gray room. 4 x 4 samples a pixel, so that edges lie where the model has
// them to a small part of a pixel.
[[nodiscard]] cv::Mat DrawBoard(const CameraModel& camera,
                                const ImageSize& size,
                                const ChessBoard& board,
                                const Eigen::Isometry3d& X_CB);

}  // namespace waymark
