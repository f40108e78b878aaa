// Connected pixels of 8 x 8 tiles, several tiles at a time. Internal to the
// segmented Hough transform.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace waymark {

// A tile is a word: pixel (x, y) is bit 8 y + x.
inline constexpr int kTileBlock = 8;
// Pixels of two groups are at least two apart.
inline constexpr int kMostTileGroups = 16;

// Of each tile of a block its groups, diagonals included, in the order of their
// first pixels; 0 after the last.
struct TileGroups {
  alignas(64) std::array<std::array<std::uint64_t, kTileBlock>,
                         kMostTileGroups + 1> of_rank;
};

using FindTileGroups = void (*)(
    const std::array<std::uint64_t, kTileBlock>& tiles, TileGroups* groups);

// All that this processor can run, with the same results: the portable one
// first, the fastest last.
[[nodiscard]] std::vector<FindTileGroups> FindTileGroupsVariants();

}  // namespace waymark
