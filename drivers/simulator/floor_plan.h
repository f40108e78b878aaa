// Walls from the image of a floor plan.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace waymark {

struct FloorPlanOptions {
  double metres_per_pixel = 0.05;
  int wall_below = 128;  // Grey values below this are wall.
  // How far an outline may be from the wall's pixels, in pixels. Below 0.5 the
  // stairs of slanting walls stay.
  double tolerance_px = 1.0;
  // Specks of wall and holes in walls with fewer pixels are left out.
  int min_pixels = 1;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// The plan in W: x to the right and y up in the image, the corner of its
// bottom-left pixel at the origin; m.
struct FloorPlan {
  // Closed outlines of the walls, without repeating the first corner, wall on
  // the left: counter-clockwise around a wall, clockwise around free space
  // within one.
  std::vector<std::vector<Eigen::Vector2d>> outlines;
  Eigen::Vector2d size = Eigen::Vector2d::Zero();
  double wall_area = 0.0;  // m^2, of the pixels.
  double free_area = 0.0;
  cv::Mat1b walls;  // 255 where wall, as the image lies.
  double metres_per_pixel = 0.05;

  // False outside the image and in walls.
  [[nodiscard]] bool IsFree(const Eigen::Vector2d& p_W) const;
};

// `image`: 8 bits, one channel. Throws InputError naming `source` where the
// image has no wall or nothing but wall, or is larger than kMaxFloorPlanSide.
[[nodiscard]] FloorPlan FloorPlanFromImage(const cv::Mat1b& image,
                                           const FloorPlanOptions& options,
                                           const std::string& source);
// The same from an image file; colours become grey, and what is transparent is
// free. Throws InputError where it cannot be read.
[[nodiscard]] FloorPlan LoadFloorPlan(const std::string& path,
                                      const FloorPlanOptions& options);

inline constexpr int kMaxFloorPlanSide = 8192;  // Pixels.

}  // namespace waymark
