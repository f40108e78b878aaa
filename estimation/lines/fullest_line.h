// Which line of a table takes the most pixels of a tile.
#pragma once

#include <cstdint>
#include <vector>

namespace waymark {

// Tiles and lines of 8 x 8 pixels, bit 8 y + x.
struct FullestLine {
  int index = 0;
  int count = 0;
};

// The fullest of `num_lines` lines, the first of equal ones; count 0 where none
// takes a pixel. num_lines is a multiple of kLineBlock.
using FindFullestLine = FullestLine (*)(const std::uint64_t* lines,
                                        int num_lines,
                                        std::uint64_t tile);
inline constexpr int kLineBlock = 8;

// All that this processor can run, with the same results: the portable one
// first, the fastest last.
[[nodiscard]] std::vector<FindFullestLine> FindFullestLineVariants();

}  // namespace waymark
