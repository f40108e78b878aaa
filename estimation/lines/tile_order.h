// The pixels of 8 x 8 tiles in the order of a direction. Internal to the
// merging of segments.
#pragma once

#include "estimation/lines/line_parts.h"
#include "estimation/lines/tile_words.h"

#include <Eigen/Core>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace waymark {

// Column by column or row by row, whichever is more across the direction, each
// of them and its pixels in the order in which the direction passes them.
class TileOrder {
 public:
  explicit TileOrder(const Eigen::Vector2f& direction)
      : is_wide_(std::abs(direction.x()) >= std::abs(direction.y())),
        is_left_(direction.x() < 0.0f),
        is_up_(direction.y() < 0.0f),
        steps_(kSteps[(is_wide_ ? 4 : 0) + (is_left_ ? 2 : 0) +
                      (is_up_ ? 1 : 0)]) {}

  // What List may write beyond its pixels.
  static constexpr std::int32_t kStep = 12;

  // Writes the `num` pixels; returns what follows the last.
  Eigen::Vector2f* List(const TilePixels& tile,
                        std::int32_t num,
                        Eigen::Vector2f* out) const {
    std::uint64_t w = tile.bits;
    if (is_up_) w = __builtin_bswap64(w);
    if (is_left_) {
      w = (w >> 1 & 0x5555555555555555ull) | (w & 0x5555555555555555ull) << 1;
      w = (w >> 2 & 0x3333333333333333ull) | (w & 0x3333333333333333ull) << 2;
      w = (w >> 4 & 0x0F0F0F0F0F0F0F0Full) | (w & 0x0F0F0F0F0F0F0F0Full) << 4;
    }
    if (is_wide_) w = TransposeTile(w);
    const Pair corner{static_cast<float>(tile.x), static_cast<float>(tile.y)};
    // Twelve without a look at whether there are as many: most pieces have a
    // few more or less, so a branch for each would often be guessed wrongly.
    constexpr std::uint64_t kEnd = std::uint64_t{1} << 63;
    for (; num > 0; num -= kStep, out += kStep) {
      for (int i = 0; i < kStep; ++i, w &= w - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(w | kEnd));
        const auto xy =
            std::bit_cast<std::array<float, 2>>(corner + steps_[bit]);
        out[i] = {xy[0], xy[1]};
      }
    }
    return out + num;
  }

 private:
  using Pair = float __attribute__((vector_size(8)));
  using Steps = std::array<Pair, 64>;

  static constexpr std::array<Steps, 8> MakeSteps() {
    std::array<Steps, 8> all{};
    for (unsigned order = 0; order < 8; ++order) {
      for (unsigned i = 0; i < 64; ++i) {
        const unsigned x = (order & 4) != 0 ? i / 8 : i % 8;
        const unsigned y = (order & 4) != 0 ? i % 8 : i / 8;
        all[order][i] = Pair{static_cast<float>((order & 2) != 0 ? 7 - x : x),
                             static_cast<float>((order & 1) != 0 ? 7 - y : y)};
      }
    }
    return all;
  }
  // Of each order and bit, from the corner of the tile.
  static const std::array<Steps, 8> kSteps;

  bool is_wide_;
  bool is_left_;
  bool is_up_;
  const Steps& steps_;
};

inline const std::array<TileOrder::Steps, 8> TileOrder::kSteps = MakeSteps();

}  // namespace waymark
