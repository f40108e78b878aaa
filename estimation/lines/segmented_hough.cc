#include "estimation/lines/segmented_hough.h"

#include "estimation/lines/fullest_line.h"

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
constexpr int kSide = 8;
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

Word Transpose(Word w) {
  Word t = (w ^ (w >> 7)) & 0x00AA00AA00AA00AAull;
  w ^= t ^ (t << 7);
  t = (w ^ (w >> 14)) & 0x0000CCCC0000CCCCull;
  w ^= t ^ (t << 14);
  t = (w ^ (w >> 28)) & 0x00000000F0F0F0F0ull;
  return w ^ t ^ (t << 28);
}

// What is connected to `seed` in `field`, diagonals included, one step farther.
Word Grow(Word seed, Word field) {
  constexpr Word kNotFirst = 0xFEFEFEFEFEFEFEFEull;
  constexpr Word kNotLast = 0x7F7F7F7F7F7F7F7Full;
  const Word row = seed | ((seed << 1) & kNotFirst) | ((seed >> 1) & kNotLast);
  return (row | row << 8 | row >> 8) & field;
}

// What `seed` is connected to in `field`, diagonals included.
Word Connected(Word seed, Word field) {
  Word before = 0;
  while (seed != before) {
    before = Grow(Grow(Grow(seed, field), field), field);
    seed = Grow(before, field);
  }
  return seed;
}

// Sums of the set pixels of a tile about its first pixel.
struct TileSums {
  std::int32_t n = 0;
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t xx = 0;
  std::int32_t xy = 0;
  std::int32_t yy = 0;

  void Add(std::int32_t px, std::int32_t py) {
    ++n;
    x += px;
    y += py;
    xx += px * px;
    xy += px * py;
    yy += py * py;
  }
  // n^2 times the second moments.
  [[nodiscard]] std::int32_t Sxx() const { return n * xx - x * x; }
  [[nodiscard]] std::int32_t Sxy() const { return n * xy - x * y; }
  [[nodiscard]] std::int32_t Syy() const { return n * yy - y * y; }
  // Whether the mean square across the best line is at most `limit`: M - limit
  // I has a negative or no determinant, or is negative as a whole.
  [[nodiscard]] bool IsStraight(double limit) const {
    const double t = limit * n * n;
    const double a = Sxx() - t;
    const double c = Syy() - t;
    const double b = Sxy();
    return a <= 0.0 || c <= 0.0 || a * c <= b * b;
  }
  [[nodiscard]] LineMoments At(int ox, int oy) const {
    LineMoments m;
    m.n = n;
    m.x = x + static_cast<double>(n) * ox;
    m.y = y + static_cast<double>(n) * oy;
    m.xx = xx + 2.0 * ox * x + static_cast<double>(n) * ox * ox;
    m.yy = yy + 2.0 * oy * y + static_cast<double>(n) * oy * oy;
    m.xy = xy + static_cast<double>(ox) * y + static_cast<double>(oy) * x +
           static_cast<double>(n) * ox * oy;
    return m;
  }
};

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
  FindFullestLine fullest = ChooseFindFullestLine();

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

void SegmentedHough::FindWords(const EdgeImage& edges, LineParts* parts) const {
  const double limit = options_.max_rms_px * options_.max_rms_px;
  const auto emit = [&](Word pixels, const TileSums& sums, int ox, int oy) {
    const std::size_t begin = parts->pixels.size();
    const auto first = static_cast<std::int32_t>(begin);
    parts->pixels.resize(begin + static_cast<std::size_t>(sums.n));
    Eigen::Vector2f* out = parts->pixels.data() + begin;
    if (sums.Sxx() >= sums.Syy()) {
      for (Word w = Transpose(pixels); w != 0; w &= w - 1) {
        const int i = std::countr_zero(w);
        *out++ = {static_cast<float>(ox + i / kSide),
                  static_cast<float>(oy + i % kSide)};
      }
    } else {
      for (Word w = pixels; w != 0; w &= w - 1) {
        const int i = std::countr_zero(w);
        *out++ = {static_cast<float>(ox + i % kSide),
                  static_cast<float>(oy + i / kSide)};
      }
    }
    AddPart(sums.At(ox, oy), first, parts);
  };
  const auto scan = [&](Word tile, int ox, int oy) {
    while (tile != 0) {
      Word group = Connected(tile & -tile, tile);
      tile &= ~group;
      TileSums sums = tables_->SumsOf(group);
      if (sums.n < options_.min_pixels) continue;
      if (sums.IsStraight(limit)) {
        emit(group, sums, ox, oy);
        continue;
      }
      while (true) {
        const FullestLine best =
            tables_->fullest(tables_->lines.data(),
                             static_cast<int>(tables_->lines.size()),
                             group);
        if (best.count < std::max(options_.min_pixels, kChance)) break;
        const Word line =
            group & tables_->lines[static_cast<std::size_t>(best.index)];
        group &= ~line;
        sums = tables_->SumsOf(line);
        if (sums.IsStraight(limit)) emit(line, sums, ox, oy);
      }
    }
  };
  for (int oy = 0; oy < edges.height; oy += kSide) {
    const int num_rows = std::min(kSide, edges.height - oy);
    const Word* row =
        edges.bits.data() + static_cast<std::ptrdiff_t>(oy) * edges.num_words;
    for (int word = 0; word < edges.num_words; ++word) {
      Word any = 0;
      for (int y = 0; y < num_rows; ++y) any |= row[y * edges.num_words + word];
      for (; any != 0;) {
        const int shift = std::countr_zero(any) / kSide * kSide;
        Word tile = 0;
        for (int y = 0; y < num_rows; ++y) {
          tile |= (row[y * edges.num_words + word] >> shift & 0xFF)
                  << (kSide * y);
        }
        any &= ~(Word{0xFF} << shift);
        scan(tile, 64 * word + shift, oy);
      }
    }
  }
}

}  // namespace waymark
