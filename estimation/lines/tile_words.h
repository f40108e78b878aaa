// Tiles of 8 x 8 pixels as words: pixel (x, y) is bit 8 y + x. Internal to the
// lines.
#pragma once

#include "estimation/lines/line_fit.h"
#include "estimation/lines/line_parts.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace waymark {

// Pixel (x, y) becomes (y, x).
inline std::uint64_t TransposeTile(std::uint64_t w) {
  std::uint64_t t = (w ^ (w >> 7)) & 0x00AA00AA00AA00AAull;
  w ^= t ^ (t << 7);
  t = (w ^ (w >> 14)) & 0x0000CCCC0000CCCCull;
  w ^= t ^ (t << 14);
  t = (w ^ (w >> 28)) & 0x00000000F0F0F0F0ull;
  return w ^ t ^ (t << 28);
}

// Pixel (x, y) becomes (7 - x, y): the bits of each byte turned round.
inline std::uint64_t ReverseRows(std::uint64_t w) {
  w = (w >> 1 & 0x5555555555555555ull) | (w & 0x5555555555555555ull) << 1;
  w = (w >> 2 & 0x3333333333333333ull) | (w & 0x3333333333333333ull) << 2;
  return (w >> 4 & 0x0F0F0F0F0F0F0F0Full) | (w & 0x0F0F0F0F0F0F0F0Full) << 4;
}

namespace tile_words {

using Word = std::uint64_t;
using Words = Word __attribute__((vector_size(16)));
using Bytes = std::uint8_t __attribute__((vector_size(16)));
using Shorts = std::uint16_t __attribute__((vector_size(16)));
using Ints = std::uint32_t __attribute__((vector_size(16)));

// clang-format off
inline Shorts Interleave(Word a, Word b) {
  return std::bit_cast<Shorts>(__builtin_shufflevector(
      std::bit_cast<Bytes>(Words{a, 0}), std::bit_cast<Bytes>(Words{b, 0}),
      0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23));
}
// clang-format on

inline Ints InterleaveLow(Shorts a, Shorts b) {
  return std::bit_cast<Ints>(
      __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11));
}

inline Ints InterleaveHigh(Shorts a, Shorts b) {
  return std::bit_cast<Ints>(
      __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15));
}

}  // namespace tile_words

// Eight tiles side by side, from the rows of their 64 pixels: byte i of row k
// becomes byte k of tile i.
inline std::array<std::uint64_t, kTileSide> TilesOf(
    const std::array<std::uint64_t, kTileSide>& rows) {
  using namespace tile_words;
  const Shorts r01 = Interleave(rows[0], rows[1]);
  const Shorts r23 = Interleave(rows[2], rows[3]);
  const Shorts r45 = Interleave(rows[4], rows[5]);
  const Shorts r67 = Interleave(rows[6], rows[7]);
  const Ints low03 = InterleaveLow(r01, r23);
  const Ints high03 = InterleaveHigh(r01, r23);
  const Ints low47 = InterleaveLow(r45, r67);
  const Ints high47 = InterleaveHigh(r45, r67);
  const std::array<Ints, 4> tiles{
      __builtin_shufflevector(low03, low47, 0, 4, 1, 5),
      __builtin_shufflevector(low03, low47, 2, 6, 3, 7),
      __builtin_shufflevector(high03, high47, 0, 4, 1, 5),
      __builtin_shufflevector(high03, high47, 2, 6, 3, 7)};
  return std::bit_cast<std::array<Word, kTileSide>>(tiles);
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
    // All three, without a branch: which of them holds is not foreseeable.
    return static_cast<int>(a <= 0.0) | static_cast<int>(c <= 0.0) |
           static_cast<int>(a * c <= b * b);
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

}  // namespace waymark
