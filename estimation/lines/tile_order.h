// The pixels of 8 x 8 tiles in the order of a direction. Internal to the
// merging of segments.
#pragma once

#include "estimation/lines/line_parts.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace waymark {

// How bit 8 major + minor of an ordered tile lies from the tile's corner:
// x = x0 + x_major major + x_minor minor, and y.
struct TileSteps {
  float x0;
  float x_major;
  float x_minor;
  float y0;
  float y_major;
  float y_minor;
};

// Writes the pixels of the set bits of an ordered tile, from the lowest bit on,
// and maybe up to kMostListed others behind them.
inline constexpr std::int32_t kMostListed = 16;
using ListTilePixels = void (*)(std::uint64_t ordered,
                                std::int32_t num,
                                const TileSteps& steps,
                                Eigen::Vector2f* pixels);

// All that this processor can run, with the same results: the portable one
// first, the fastest last.
[[nodiscard]] std::vector<ListTilePixels> ListTilePixelsVariants();

// Column by column or row by row, whichever is more across the direction, each
// of them and its pixels in the order in which the direction passes them.
class TileOrder {
 public:
  explicit TileOrder(const Eigen::Vector2f& direction);

  // Writes the `num` pixels of the tile, and as ListTilePixels behind them;
  // returns what follows the last.
  Eigen::Vector2f* List(const TilePixels& tile,
                        std::int32_t num,
                        ListTilePixels list,
                        Eigen::Vector2f* pixels) const;

 private:
  bool is_wide_;
  bool is_left_;
  bool is_up_;
  TileSteps steps_;
};

}  // namespace waymark
