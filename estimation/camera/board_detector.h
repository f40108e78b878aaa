// Corners of a chessboard in an image.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <optional>
#include <vector>

namespace waymark {

// Inner corners of a chessboard: `columns` x `rows`, both at least 3, squares
// of this side, m.
struct ChessBoard {
  int columns = 8;
  int rows = 6;
  double square = 0.03;

  // Throws std::invalid_argument naming the field.
  void Check() const;
  // Row by row, from the origin.
  [[nodiscard]] std::vector<Eigen::Vector2d> Corners() const;
};

// Pixels of the inner corners in the order of ChessBoard::Corners, refined to
// a fraction of a pixel; nullopt where the board is not seen whole. `image`:
// 8 bits, one channel. Straight edges may be bent, as a mirror or a fisheye
// does. 20 ms where the quick search finds it, seconds where only the thorough
// one does or neither (1280 x 1024).
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> FindBoardCorners(
    const cv::Mat& image, const ChessBoard& board);

}  // namespace waymark
