// Inner loops of the edge image: one row at a time, in 16-bit integers.
// Internal to the edge image.
#pragma once

#include <cstdint>
#include <vector>

namespace waymark {

struct GradientRow {
  std::int16_t* dx;
  std::int16_t* dy;
  std::int16_t* magnitude;  // |dx| + |dy|.
};

// Magnitudes of three rows, each with one more on both sides, and the
// gradient of the middle one.
struct SuppressionRow {
  const std::int16_t* above;
  const std::int16_t* middle;
  const std::int16_t* below;
  const std::int16_t* dx;
  const std::int16_t* dy;
  std::int16_t low;
  std::int16_t high;
};

// Marks: 0 no edge, 1 a maximum above `low`, 3 one above `high`.
struct EdgeRowLoops {
  // 1 4 6 4 1 down five rows of `n` pixels.
  void (*smooth_down)(const std::uint8_t* const rows[5],
                      int n,
                      std::uint16_t* out);
  // 1 4 6 4 1 along in[x - 2, x + 2], over 16: grey levels times 16.
  void (*smooth_along)(const std::uint16_t* in, int n, std::int16_t* out);
  // Sobel of the pixels x - 1, x, x + 1 of three rows.
  void (*differentiate)(const std::int16_t* const rows[3],
                        int n,
                        const GradientRow& out);
  // Against the two neighbours along the gradient's larger part.
  void (*suppress_two_axes)(const SuppressionRow& row,
                            int n,
                            std::uint8_t* marks);
  // Against the two neighbours nearest to the gradient's direction, of eight.
  void (*suppress_four_directions)(const SuppressionRow& row,
                                   int n,
                                   std::uint8_t* marks);
  // Of num_words times 64 bytes one bit each, the first the lowest: whether it
  // is not 0.
  void (*pack_not_zero)(const std::uint8_t* bytes,
                        int num_words,
                        std::uint64_t* bits);
};

// All that this processor can run, with the same results: the portable ones
// first, the fastest last. They live for ever.
[[nodiscard]] std::vector<const EdgeRowLoops*> EdgeRowLoopsVariants();

// Of 64 bytes one bit each, the first the lowest: its bit `Bit`.
template <int Bit>
[[nodiscard]] std::uint64_t PackBit(const std::uint8_t* bytes);
extern template std::uint64_t PackBit<0>(const std::uint8_t* bytes);
extern template std::uint64_t PackBit<1>(const std::uint8_t* bytes);

}  // namespace waymark
