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

inline constexpr int kTileSide = 8;  // Pixels.

// Pixels of a tile: (x + i % 8, y + i / 8) for each bit i.
struct TilePixels {
  std::uint64_t bits = 0;
  std::int32_t x = 0;
  std::int32_t y = 0;
};

struct LineParts {
  std::vector<LinePart> parts;
  std::vector<Eigen::Vector2f> pixels;  // Of a part: in order from a to b.
  // Instead of `pixels`, which is empty then: of each part its tile. Tiles lie
  // on a grid of kTileSide and are in the order of rows.
  std::vector<TilePixels> tiles;
  bool is_directed = false;

  void Clear() {
    parts.clear();
    tiles.clear();
    pixels.clear();
  }
};

}  // namespace waymark
