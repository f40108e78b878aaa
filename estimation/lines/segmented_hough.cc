#include "estimation/lines/segmented_hough.h"

#include "estimation/lines/fullest_line.h"
#include "estimation/lines/tile_groups.h"
#include "estimation/lines/tile_words.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

using Word = std::uint64_t;

constexpr int kLiteralSide = 10;
constexpr int kNumLiteralPixels = kLiteralSide * kLiteralSide;
constexpr int kSide = kTileSide;
// Half a tile away two neighbours differ by a pixel at most.
constexpr int kNumLiteralAngles = 20;
constexpr int kNumAngles = 16;
// Cells are two steps wide and overlap by half: pixels lie up to half a pixel
// from their line, so one of two neighbours holds them all.
constexpr double kOffsetStep = 0.75;
// Of pixels that lie anyhow, three are on some line nearly always.
constexpr int kChance = 4;
// Offsets from the middle of a sub-image; its half diagonal is 6.4.
constexpr int kNumOffsets = 20;

// The first of the two cells, by the offset's index, of a line at this angle
// (of num_angles in half a turn) through (x, y) from the tile's middle.
int OffsetIndex(int angle, int num_angles, double x, double y) {
  const double a = angle * std::numbers::pi / num_angles;
  const double offset = x * std::cos(a) + y * std::sin(a);
  return static_cast<int>(std::floor(offset / kOffsetStep)) + kNumOffsets / 2 -
         1;
}

void AddPixel(int x, int y, LineParts* parts) {
  parts->pixels.emplace_back(static_cast<float>(x), static_cast<float>(y));
}

// The piece of all pixels from first_pixel on.
void AddPart(const LineMoments& moments,
             std::int32_t first_pixel,
             LineParts* parts) {
  LinePart part;
  part.moments = moments;
  part.first_pixel = first_pixel;
  part.num_pixels =
      static_cast<std::int32_t>(parts->pixels.size()) - first_pixel;
  part.a = parts->pixels[static_cast<std::size_t>(first_pixel)];
  part.b = parts->pixels.back();
  parts->parts.push_back(part);
}

}  // namespace

struct SegmentedHough::Tables {
  // Of each pixel of a sub-image, its two cells for each angle.
  std::array<std::array<std::uint16_t, 2 * kNumLiteralAngles>,
             kNumLiteralPixels>
      cells{};
  // Of each cell its pixels.
  std::array<std::vector<std::uint8_t>, kNumLiteralAngles * kNumOffsets> pixels;
  // Of each row of eight its n, sum of x, sum of x^2, in 16 bits each.
  std::array<Word, 256> rows{};
  // The lines of a tile of eight, one and a half pixels wide.
  std::vector<Word> lines;
  FindFullestLine fullest = FindFullestLineVariants().back();
  FindTileGroups groups = FindTileGroupsVariants().back();

  Tables() {
    for (int y = 0; y < kLiteralSide; ++y) {
      for (int x = 0; x < kLiteralSide; ++x) {
        const auto p = static_cast<std::size_t>(kLiteralSide * y + x);
        for (int angle = 0; angle < kNumLiteralAngles; ++angle) {
          const auto cell = static_cast<std::size_t>(
              angle * kNumOffsets + OffsetIndex(angle,
                                                kNumLiteralAngles,
                                                x - 0.5 * (kLiteralSide - 1),
                                                y - 0.5 * (kLiteralSide - 1)));
          for (std::size_t i = 0; i < 2; ++i) {
            cells[p][static_cast<std::size_t>(2 * angle) + i] =
                static_cast<std::uint16_t>(cell + i);
            pixels[cell + i].push_back(static_cast<std::uint8_t>(p));
          }
        }
      }
    }
    for (unsigned row = 0; row < 256; ++row) {
      for (unsigned x = 0; x < kSide; ++x) {
        if ((row >> x & 1) == 0) continue;
        rows[row] += 1 | Word{x} << 16 | Word{x * x} << 32;
      }
    }
    for (int angle = 0; angle < kNumAngles; ++angle) {
      std::array<Word, kNumOffsets> of_offset{};
      for (int i = 0; i < kSide * kSide; ++i) {
        const auto offset = static_cast<std::size_t>(
            OffsetIndex(angle,
                        kNumAngles,
                        i % kSide - 0.5 * (kSide - 1),
                        i / kSide - 0.5 * (kSide - 1)));
        of_offset[offset] |= Word{1} << i;
        of_offset[offset + 1] |= Word{1} << i;
      }
      for (const Word line : of_offset) {
        if (std::popcount(line) >= kChance) lines.push_back(line);
      }
    }
    // What is empty takes no pixel.
    while (lines.size() % kLineBlock != 0) lines.push_back(0);
  }

  // 7^2 * 140 < 2^16, so no field runs over.
  [[nodiscard]] TileSums SumsOf(Word tile) const {
    Word a = 0;
    Word b = 0;
    Word c = 0;
    for (Word y = 0; y < kSide; ++y) {
      const Word row = rows[tile >> (8 * y) & 0xFF];
      a += row;
      b += row * y;
      c += (row & 0xFFFF) * (y * y);
    }
    const auto field = [](Word w, int i) {
      return static_cast<std::int32_t>(w >> (16 * i) & 0xFFFF);
    };
    return {field(a, 0),
            field(a, 1),
            field(b, 0),
            field(a, 2),
            field(b, 1),
            static_cast<std::int32_t>(c)};
  }
};

void SegmentedHoughOptions::Check() const {
  if (min_pixels < 2 || min_pixels > 8) {
    throw std::invalid_argument("min_pixels must be in [2, 8]");
  }
  if (!(max_rms_px > 0.0) || !(max_rms_px <= 2.0)) {
    throw std::invalid_argument("max_rms_px must be in (0, 2]");
  }
}

SegmentedHough::SegmentedHough(const SegmentedHoughOptions& options)
    : options_(options) {
  options.Check();
  tables_ = std::make_unique<const Tables>();
}

SegmentedHough::~SegmentedHough() = default;
SegmentedHough::SegmentedHough(SegmentedHough&&) noexcept = default;
SegmentedHough& SegmentedHough::operator=(SegmentedHough&&) noexcept = default;

void SegmentedHough::Find(const EdgeImage& edges, LineParts* parts) const {
  parts->Clear();
  parts->is_directed = false;
  if (options_.form == HoughForm::kLiteral) {
    FindLiteral(edges, parts);
  } else {
    FindWords(edges, parts);
  }
}

namespace {

// Pixels of one sub-image, and the votes of those that are left.
struct SubImage {
  std::array<std::uint16_t, kNumLiteralAngles * kNumOffsets> votes;
  std::array<char, kNumLiteralPixels> is_set;
  int num_left = 0;
};

}  // namespace

void SegmentedHough::FindLiteral(const EdgeImage& edges,
                                 LineParts* parts) const {
  SubImage sub;
  std::vector<std::uint8_t> on_line;
  const double limit = options_.max_rms_px * options_.max_rms_px;
  for (int oy = 0; oy < edges.height; oy += kLiteralSide) {
    for (int ox = 0; ox < edges.width; ox += kLiteralSide) {
      sub.votes.fill(0);
      sub.is_set.fill(0);
      sub.num_left = 0;
      for (int y = oy; y < std::min(oy + kLiteralSide, edges.height); ++y) {
        for (int x = ox; x < std::min(ox + kLiteralSide, edges.width); ++x) {
          if (!edges.IsEdge(x, y)) continue;
          const auto p =
              static_cast<std::size_t>(kLiteralSide * (y - oy) + x - ox);
          sub.is_set[p] = 1;
          ++sub.num_left;
          for (const std::uint16_t cell : tables_->cells[p]) ++sub.votes[cell];
        }
      }
      while (sub.num_left >= options_.min_pixels) {
        const auto best = std::max_element(sub.votes.begin(), sub.votes.end());
        if (*best < options_.min_pixels) break;
        on_line.clear();
        TileSums sums;
        for (const std::uint8_t p :
             tables_
                 ->pixels[static_cast<std::size_t>(best - sub.votes.begin())]) {
          if (sub.is_set[p] == 0) continue;
          on_line.push_back(p);
          sums.Add(p % kLiteralSide, p / kLiteralSide);
        }
        for (const std::uint8_t p : on_line) {
          sub.is_set[p] = 0;
          --sub.num_left;
          for (const std::uint16_t cell : tables_->cells[p]) --sub.votes[cell];
        }
        if (!sums.IsStraight(limit)) continue;
        if (sums.Sxx() >= sums.Syy()) {
          // In the order of columns: tables list pixels row by row.
          std::stable_sort(on_line.begin(),
                           on_line.end(),
                           [](std::uint8_t a, std::uint8_t b) {
                             return a % kLiteralSide < b % kLiteralSide;
                           });
        }
        const auto first = static_cast<std::int32_t>(parts->pixels.size());
        for (const std::uint8_t p : on_line) {
          AddPixel(ox + p % kLiteralSide, oy + p / kLiteralSide, parts);
        }
        AddPart(sums.At(ox, oy), first, parts);
      }
    }
  }
}

// Flat: its steps are short, and a call for each costs a tenth.
__attribute__((flatten)) void SegmentedHough::FindWords(
    const EdgeImage& edges, LineParts* parts) const {
  const double limit = options_.max_rms_px * options_.max_rms_px;
  const auto emit = [&](Word pixels, const TileSums& sums, int ox, int oy) {
    const bool is_wide = sums.Sxx() >= sums.Syy();
    // Its pixels column by column, or row by row.
    const Word ordered = is_wide ? TransposeTile(pixels) : pixels;
    const int i = std::countr_zero(ordered);
    const int k = 63 - std::countl_zero(ordered);
    const auto corner = [&](int bit) {
      const int major = bit / kSide;
      const int minor = bit % kSide;
      return Eigen::Vector2f(
          static_cast<float>(ox + (is_wide ? major : minor)),
          static_cast<float>(oy + (is_wide ? minor : major)));
    };
    LinePart& part = parts->parts.emplace_back();
    part.moments = sums.At(ox, oy);
    part.num_pixels = sums.n;
    part.a = corner(i);
    part.b = corner(k);
    parts->tiles.push_back({pixels, ox, oy});
  };
  const auto scan = [&](Word group, int ox, int oy) {
    TileSums sums = tables_->SumsOf(group);
    if (sums.n < options_.min_pixels) return;
    if (sums.IsStraight(limit)) {
      emit(group, sums, ox, oy);
      return;
    }
    const int least = std::max(options_.min_pixels, kChance);
    for (int left = sums.n; left >= least;) {
      const FullestLine best =
          tables_->fullest(tables_->lines.data(),
                           static_cast<int>(tables_->lines.size()),
                           group);
      if (best.count < least) break;
      const Word line =
          group & tables_->lines[static_cast<std::size_t>(best.index)];
      group &= ~line;
      left -= best.count;
      sums = tables_->SumsOf(line);
      if (sums.IsStraight(limit)) emit(line, sums, ox, oy);
    }
  };
  // Tiles with edges, until there are enough for a block.
  struct Corner {
    int x;
    int y;
  };
  std::array<Word, 2 * kTileBlock> tiles{};
  std::array<Corner, 2 * kTileBlock> corners{};
  std::size_t num = 0;
  TileGroups groups;
  const auto scan_block = [&] {
    std::array<Word, kTileBlock> block;
    std::copy_n(tiles.begin(), kTileBlock, block.begin());
    tables_->groups(block, &groups);
    for (std::size_t k = 0; k < std::min<std::size_t>(num, kTileBlock); ++k) {
      for (const auto& of_rank : groups.of_rank) {
        if (of_rank[k] == 0) break;
        scan(of_rank[k], corners[k].x, corners[k].y);
      }
    }
  };
  std::array<Word, kSide> rows{};
  for (int oy = 0; oy < edges.height; oy += kSide) {
    const int num_rows = std::min(kSide, edges.height - oy);
    const Word* row =
        edges.bits.data() + static_cast<std::ptrdiff_t>(oy) * edges.num_words;
    // Below the image there is nothing: its last row again, without pixels.
    std::array<const Word*, kSide> row_of;
    std::array<Word, kSide> mask;
    for (int y = 0; y < kSide; ++y) {
      const auto k = static_cast<std::size_t>(y);
      row_of[k] = row + static_cast<std::ptrdiff_t>(std::min(y, num_rows - 1)) *
                            edges.num_words;
      mask[k] = y < num_rows ? ~Word{0} : 0;
    }
    for (int word = 0; word < edges.num_words; ++word) {
      Word any = 0;
      for (std::size_t k = 0; k < kSide; ++k) {
        rows[k] = row_of[k][word] & mask[k];
        any |= rows[k];
      }
      if (any == 0) continue;
      const std::array<Word, kSide> side_by_side = TilesOf(rows);
      for (int i = 0; i < kSide; ++i) {
        const Word tile = side_by_side[static_cast<std::size_t>(i)];
        tiles[num] = tile;
        corners[num] = {64 * word + kSide * i, oy};
        num += tile != 0 ? 1 : 0;
      }
      if (num < kTileBlock) continue;
      scan_block();
      num -= kTileBlock;
      std::copy_n(tiles.begin() + kTileBlock, kTileBlock, tiles.begin());
      std::copy_n(corners.begin() + kTileBlock, kTileBlock, corners.begin());
    }
  }
  std::fill(tiles.begin() + static_cast<std::ptrdiff_t>(num), tiles.end(), 0);
  if (num > 0) scan_block();
}

}  // namespace waymark
