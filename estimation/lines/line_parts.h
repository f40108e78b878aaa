// Short straight pieces of edges, before they are joined.
#pragma once

#include "estimation/lines/line_fit.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace waymark {

struct LinePart {
  LineMoments moments;  // Of its pixels.
  // First and last pixel along it. Where the set is directed, the image is
  // brighter on the right from a to b.
  Eigen::Vector2f a = Eigen::Vector2f::Zero();
  Eigen::Vector2f b = Eigen::Vector2f::Zero();
  std::int32_t first_pixel = 0;  // Of LineParts::pixels.
  std::int32_t num_pixels = 0;
};

struct LineParts {
  std::vector<LinePart> parts;
  std::vector<Eigen::Vector2f> pixels;  // Of a part: in order from a to b.
  bool is_directed = false;

  void Clear() {
    parts.clear();
    pixels.clear();
  }
};

}  // namespace waymark
