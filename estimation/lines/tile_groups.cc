#include "estimation/lines/tile_groups.h"

#include "estimation/lines/processor_targets.h"

#include <cstddef>
#include <cstring>

namespace waymark {
namespace {

using Tiles = std::array<std::uint64_t, kTileBlock>;
// Eight tiles on any processor, in one register or several.
using Block = std::uint64_t __attribute__((vector_size(64)));
using Half = std::uint64_t __attribute__((vector_size(32)));

// One pixel farther within the field, in all directions.
WAYMARK_INLINE void Grow(const Block& field, Block* seed) {
  constexpr std::uint64_t kNotFirst = 0xFEFEFEFEFEFEFEFEull;
  constexpr std::uint64_t kNotLast = 0x7F7F7F7F7F7F7F7Full;
  const Block row =
      *seed | ((*seed << 1) & kNotFirst) | ((*seed >> 1) & kNotLast);
  *seed = (row | row << 8 | row >> 8) & field;
}

WAYMARK_INLINE bool IsAnySet(const Block& block) {
  std::array<Half, 2> halves;
  std::memcpy(halves.data(), &block, sizeof(block));
  const Half half = halves[0] | halves[1];
  std::array<std::uint64_t, 4> words;
  std::memcpy(words.data(), &half, sizeof(half));
  return (words[0] | words[1] | words[2] | words[3]) != 0;
}

WAYMARK_INLINE void FindGroups(const Tiles& tiles, TileGroups* groups) {
  // From end to end of a line across the tile.
  constexpr int kFirstSteps = 7;
  constexpr int kMoreSteps = 3;
  Block left;
  std::memcpy(&left, tiles.data(), sizeof(left));
  for (auto& group : groups->of_rank) {
    Block seed = left & -left;
    for (int i = 0; i < kFirstSteps; ++i) Grow(left, &seed);
    while (true) {
      const Block before = seed;
      Grow(left, &seed);
      if (!IsAnySet(seed ^ before)) break;
      for (int i = 0; i < kMoreSteps; ++i) Grow(left, &seed);
    }
    std::memcpy(group.data(), &seed, sizeof(seed));
    left &= ~seed;
    if (!IsAnySet(seed)) break;
  }
}

void FindTileGroupsPortably(const Tiles& tiles, TileGroups* groups) {
  FindGroups(tiles, groups);
}

#if defined(__x86_64__)
WAYMARK_AVX2 void FindByAvx2(const Tiles& tiles, TileGroups* groups) {
  FindGroups(tiles, groups);
}

WAYMARK_AVX512 void FindByAvx512(const Tiles& tiles, TileGroups* groups) {
  FindGroups(tiles, groups);
}
#endif

}  // namespace

std::vector<FindTileGroups> FindTileGroupsVariants() {
  std::vector<FindTileGroups> all{FindTileGroupsPortably};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") != 0) all.push_back(FindByAvx2);
  if (__builtin_cpu_supports("avx512f") != 0) all.push_back(FindByAvx512);
#endif
  return all;
}

}  // namespace waymark
