#include "estimation/camera/board_detector.h"

#include "estimation/geometry/angle.h"
#include "tests/support/board_image.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <stdexcept>

namespace waymark {
namespace {

const ChessBoard kBoard{.columns = 8, .rows = 6, .square = 0.04};
const ImageSize kSize{640, 480};

Eigen::Isometry3d BoardAt(const Eigen::Vector3d& p_CB, double tilt) {
  Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
  X_CB.linear() =
      Eigen::AngleAxisd(tilt, Eigen::Vector3d(1.0, 0.5, 0.3).normalized())
          .toRotationMatrix();
  X_CB.translation() = p_CB;
  return X_CB;
}

// Largest distance of a corner found from where the model has it. The list may
// start at either end of the board.
double WorstCorner(const CameraModel& camera,
                   const Eigen::Isometry3d& X_CB,
                   std::vector<Eigen::Vector2d> found) {
  std::vector<Eigen::Vector2d> wanted;
  for (const Eigen::Vector2d& corner : kBoard.Corners()) {
    wanted.push_back(
        PixelFromRay(camera,
                     X_CB * Eigen::Vector3d(corner.x(), corner.y(), 0.0))
            ->pixel);
  }
  if ((found.front() - wanted.front()).norm() >
      (found.front() - wanted.back()).norm()) {
    std::reverse(found.begin(), found.end());
  }
  double worst = 0.0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    worst = std::max(worst, (found[i] - wanted[i]).norm());
  }
  return worst;
}

TEST(FindBoardCorners, AreWhereTheModelHasThem) {
  const PerspectiveCamera straight({520.0, 520.0, 321.0, 238.0});
  const Eigen::Isometry3d ahead = BoardAt({-0.15, -0.1, 0.55}, 0.4);
  const auto found =
      FindBoardCorners(DrawBoard(straight, kSize, kBoard, ahead), kBoard);
  ASSERT_TRUE(found);
  // What steps of four samples a pixel leave along edges that are nearly
  // upright; 0.04 px on the average.
  EXPECT_LT(WorstCorner(straight, ahead, *found), 0.25);
}

TEST(FindBoardCorners, SeesBentBoards) {
  const FisheyeCamera fisheye({230.0, 230.0, 320.0, 240.0},
                              {0.03, -0.01, 0.0, 0.0});
  const Eigen::Isometry3d aside = BoardAt({-0.3, -0.14, 0.2}, 0.5);
  const auto found =
      FindBoardCorners(DrawBoard(fisheye, kSize, kBoard, aside), kBoard);
  ASSERT_TRUE(found);
  EXPECT_LT(WorstCorner(fisheye, aside, *found), 0.25);
}

TEST(FindBoardCorners, NoBoardIsNoAnswer) {
  const cv::Mat blank(120, 160, CV_8UC1, cv::Scalar(127));
  EXPECT_FALSE(FindBoardCorners(blank, kBoard));
  const cv::Mat colour(120, 160, CV_8UC3, cv::Scalar::all(127));
  EXPECT_THROW((void)FindBoardCorners(colour, kBoard), std::invalid_argument);
  EXPECT_THROW((void)FindBoardCorners(blank, {2, 6, 0.03}),
               std::invalid_argument);
  EXPECT_THROW((void)FindBoardCorners(blank, {8, 6, 0.0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace waymark
