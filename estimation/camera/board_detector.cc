#include "estimation/camera/board_detector.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace waymark {
namespace {

std::size_t IndexOf(const ChessBoard& board, int column, int row) {
  return static_cast<std::size_t>(row) *
             static_cast<std::size_t>(board.columns) +
         static_cast<std::size_t>(column);
}

// Distance of a corner's nearest neighbour along its row or column, px.
double SpacingAt(const std::vector<cv::Point2f>& corners,
                 const ChessBoard& board,
                 int column,
                 int row) {
  double least = std::numeric_limits<double>::infinity();
  constexpr std::array<std::array<int, 2>, 4> kSteps{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (const auto& [dc, dr] : kSteps) {
    const int c = column + dc;
    const int r = row + dr;
    if (c < 0 || c >= board.columns || r < 0 || r >= board.rows) continue;
    least = std::min(least,
                     cv::norm(corners[IndexOf(board, c, r)] -
                              corners[IndexOf(board, column, row)]));
  }
  return least;
}

// Each in a window that holds its own four edges, as much of them as there is,
// and no neighbour: on a bent board squares differ in size.
std::vector<Eigen::Vector2d> Refine(const cv::Mat& image,
                                    const ChessBoard& board,
                                    const std::vector<cv::Point2f>& corners) {
  constexpr double kShare = 0.45;
  constexpr int kMaxSteps = 100;
  constexpr double kLeastStep = 1e-3;  // px.
  const cv::TermCriteria until(
      cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kMaxSteps, kLeastStep);
  std::vector<Eigen::Vector2d> pixels;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const double spacing = SpacingAt(corners, board, column, row);
      const int half = std::clamp(static_cast<int>(kShare * spacing), 2, 15);
      std::vector<cv::Point2f> one{corners[IndexOf(board, column, row)]};
      cv::cornerSubPix(
          image, one, cv::Size(half, half), cv::Size(-1, -1), until);
      pixels.emplace_back(one[0].x, one[0].y);
    }
  }
  return pixels;
}

}  // namespace

void ChessBoard::Check() const {
  constexpr int kMost = 100;
  if (columns < 3 || columns > kMost || rows < 3 || rows > kMost) {
    throw std::invalid_argument(
        "a board has 3 to 100 columns and rows of inner corners");
  }
  if (!(square > 0.0) || !(square <= 10.0)) {
    throw std::invalid_argument("a board's squares are above 0 and up to 10 m");
  }
}

std::vector<Eigen::Vector2d> ChessBoard::Corners() const {
  std::vector<Eigen::Vector2d> corners;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      corners.emplace_back(square * column, square * row);
    }
  }
  return corners;
}

std::optional<std::vector<Eigen::Vector2d>> FindBoardCorners(
    const cv::Mat& image, const ChessBoard& board) {
  board.Check();
  if (image.empty() || image.type() != CV_8UC1) {
    throw std::invalid_argument("an image of 8 bits and one channel is needed");
  }
  const cv::Size size(board.columns, board.rows);
  std::vector<cv::Point2f> corners;
  const bool is_found =
      cv::findChessboardCorners(
          image,
          size,
          corners,
          cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE) ||
      cv::findChessboardCornersSB(
          image,
          size,
          corners,
          cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE);
  if (!is_found) return std::nullopt;
  return Refine(image, board, corners);
}

}  // namespace waymark
