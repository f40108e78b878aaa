// Line segments of an image, as values.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace waymark {

// A straight edge of an image: pixels x right, y down, the centre of the
// top-left one is (0, 0). Errors of the offset across the line, at the middle
// of a and b, and of its direction do not depend on each other.
struct LineSegment {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();  // Ends, on the fitted line, px.
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  double sigma_px = 0.5;    // Of the offset, 1 sigma.
  double sigma_rad = 0.01;  // Of the direction.
  // Supporting pixels: LineSet::pixels[first_pixel, first_pixel + num_pixels).
  std::int32_t first_pixel = 0;
  std::int32_t num_pixels = 0;
};

struct LineSet {
  std::vector<LineSegment> segments;
  std::vector<Eigen::Vector2f> pixels;  // Edge pixels, those of a segment in
                                        // their order from a to b.
  // Whether the image is brighter on the right of each segment as one walks
  // from a to b on the screen. False: the direction says nothing (an edge map
  // without gradients).
  bool has_polarity = false;
};

}  // namespace waymark
