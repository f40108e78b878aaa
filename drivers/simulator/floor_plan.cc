#include "drivers/simulator/floor_plan.h"

#include "drivers/simulator/wall_outline.h"
#include "drivers/video/image_file.h"
#include "estimation/base/input_error.h"

#include <opencv2/imgproc.hpp>

#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

void CheckRange(const char* field, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw std::invalid_argument(
        std::string("floor plan: ") + field + " = " + std::to_string(value) +
        ", not in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
  }
}

// Turns the value of all 4-connected regions of `from` with fewer pixels than
// that to `to`.
void RemoveSpecks(std::uint8_t from, int min_pixels, cv::Mat1b* walls) {
  cv::Mat1i labels;
  cv::Mat1i stats;
  cv::Mat1d middles;
  const int count = cv::connectedComponentsWithStats(
      *walls == from, labels, stats, middles, 4, CV_32S);
  for (int i = 1; i < count; ++i) {
    if (stats(i, cv::CC_STAT_AREA) < min_pixels) {
      walls->setTo(255 - from, labels == i);
    }
  }
}

// Grey of a picture on white paper.
cv::Mat1b GreyOf(const cv::Mat& image) {
  cv::Mat1b grey;
  if (image.channels() != 4) {
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    return grey;
  }
  cv::cvtColor(image, grey, cv::COLOR_BGRA2GRAY);
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      const int alpha = image.at<cv::Vec4b>(y, x)[3];
      grey(y, x) = static_cast<std::uint8_t>(
          (grey(y, x) * alpha + 255 * (255 - alpha) + 127) / 255);
    }
  }
  return grey;
}

}  // namespace

void FloorPlanOptions::Check() const {
  CheckRange("metres_per_pixel", metres_per_pixel, 1e-4, 10.0);
  CheckRange("wall_below", wall_below, 1, 255);
  CheckRange("tolerance_px", tolerance_px, 0.0, 10.0);
  CheckRange("min_pixels", min_pixels, 1, 1e6);
}

bool FloorPlan::IsFree(const Eigen::Vector2d& p_W) const {
  const double x = std::floor(p_W.x() / metres_per_pixel);
  const double y = std::floor((size.y() - p_W.y()) / metres_per_pixel);
  if (!(x >= 0.0 && x < walls.cols && y >= 0.0 && y < walls.rows)) return false;
  return walls(static_cast<int>(y), static_cast<int>(x)) == 0;
}

FloorPlan FloorPlanFromImage(const cv::Mat1b& image,
                             const FloorPlanOptions& options,
                             const std::string& source) {
  options.Check();
  if (image.empty() || image.cols > kMaxFloorPlanSide ||
      image.rows > kMaxFloorPlanSide) {
    throw InputError(source + ": " + std::to_string(image.cols) + " x " +
                     std::to_string(image.rows) +
                     " pixels; each side of a floor plan must be in [1, " +
                     std::to_string(kMaxFloorPlanSide) + "]");
  }
  FloorPlan plan;
  plan.metres_per_pixel = options.metres_per_pixel;
  plan.size =
      options.metres_per_pixel * Eigen::Vector2d(image.cols, image.rows);
  plan.walls = image < options.wall_below;
  if (options.min_pixels > 1) {
    RemoveSpecks(255, options.min_pixels, &plan.walls);
    RemoveSpecks(0, options.min_pixels, &plan.walls);
  }
  const int num_wall = cv::countNonZero(plan.walls);
  if (num_wall == 0) {
    throw InputError(source + ": no walls: no pixel is darker than " +
                     std::to_string(options.wall_below));
  }
  if (num_wall == static_cast<int>(plan.walls.total())) {
    throw InputError(source + ": no free space: every pixel is darker than " +
                     std::to_string(options.wall_below));
  }
  const double pixel_area = options.metres_per_pixel * options.metres_per_pixel;
  plan.wall_area = pixel_area * num_wall;
  plan.free_area =
      pixel_area * (static_cast<double>(plan.walls.total()) - num_wall);
  plan.outlines = WallOutlines(plan.walls, options.tolerance_px);
  for (std::vector<Eigen::Vector2d>& outline : plan.outlines) {
    for (Eigen::Vector2d& corner : outline) {
      corner = {options.metres_per_pixel * corner.x(),
                options.metres_per_pixel * (image.rows - corner.y())};
    }
  }
  return plan;
}

FloorPlan LoadFloorPlan(const std::string& path,
                        const FloorPlanOptions& options) {
  options.Check();
  cv::Mat image = LoadImageFile(path, ImageFileColor::kAsStored);
  if (image.depth() != CV_8U) {  // 16 bits a channel.
    image.convertTo(image, CV_8U, 1.0 / 257.0);
  }
  return FloorPlanFromImage(
      image.channels() == 1 ? cv::Mat1b(image) : GreyOf(image), options, path);
}

}  // namespace waymark
