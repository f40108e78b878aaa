#include "tests/support/board_image.h"

#include <cmath>
#include <cstdint>

namespace waymark {
namespace {

constexpr double kBlack = 30.0;
constexpr double kWhite = 220.0;
constexpr double kRoom = 110.0;

double GrayAt(const CameraModel& camera,
              const Eigen::Vector2d& pixel,
              const ChessBoard& board,
              const Eigen::Isometry3d& X_BC) {
  const auto back = RayFromPixel(camera, pixel);
  if (!back) return kRoom;
  const Eigen::Vector3d from = X_BC.translation();
  const Eigen::Vector3d along = X_BC.linear() * back->ray;
  const double distance = -from.z() / along.z();
  if (!(distance > 0.0)) return kRoom;
  // In squares; the first inner corner is at (0, 0).
  const Eigen::Vector3d hit = (from + distance * along) / board.square;
  const auto is_within = [](double x, double low, double high) {
    return x >= low && x < high;
  };
  if (!is_within(hit.x(), -2.0, board.columns + 1.0) ||
      !is_within(hit.y(), -2.0, board.rows + 1.0)) {
    return kRoom;
  }
  if (!is_within(hit.x(), -1.0, board.columns) ||
      !is_within(hit.y(), -1.0, board.rows)) {
    return kWhite;
  }
  const int parity = static_cast<int>(std::floor(hit.x())) +
                     static_cast<int>(std::floor(hit.y()));
  return parity % 2 == 0 ? kBlack : kWhite;
}

}  // namespace

cv::Mat DrawBoard(const CameraModel& camera,
                  const ImageSize& size,
                  const ChessBoard& board,
                  const Eigen::Isometry3d& X_CB) {
  constexpr int kSamples = 4;
  const Eigen::Isometry3d X_BC = X_CB.inverse();
  cv::Mat image(size.height, size.width, CV_8UC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      double sum = 0.0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const int row = i / kSamples;
        const double dx = (i % kSamples + 0.5) / kSamples - 0.5;
        const double dy = (row + 0.5) / kSamples - 0.5;
        sum += GrayAt(camera, {u + dx, v + dy}, board, X_BC);
      }
      image.at<std::uint8_t>(v, u) =
          static_cast<std::uint8_t>(std::lround(sum / (kSamples * kSamples)));
    }
  }
  return image;
}

}  // namespace waymark
