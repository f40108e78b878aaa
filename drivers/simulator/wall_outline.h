// Outlines of the regions of a mask.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <vector>

namespace waymark {

// Closed outlines of the pixels that are not 0, along the edges of pixels: x
// right, y down, the corner of the top-left pixel at the origin. As one looks
// at the image, regions lie on the left of their outlines. Pixels that touch at
// a corner only are of one region. Straight parts keep their pixels' edges
// exactly; the stairs of slanting ones become lines that are at most
// `tolerance` pixels from the middles of the edges. A region one pixel wide
// keeps its width.
[[nodiscard]] std::vector<std::vector<Eigen::Vector2d>> WallOutlines(
    const cv::Mat1b& mask, double tolerance);

}  // namespace waymark
