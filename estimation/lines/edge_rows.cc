// The compiler vectorises these loops (see CMakeLists.txt): sixteen pixels at a
// time with AVX2, eight without. Integers alone, so both are equal.
#include "estimation/lines/edge_rows.h"

#include "estimation/lines/processor_targets.h"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <cstring>
#include <vector>

namespace waymark {
namespace {

using std::int16_t;
using std::uint16_t;
using std::uint8_t;

// At most 16 * 255.
WAYMARK_INLINE void SmoothDown(const uint8_t* const rows[5],
                               int n,
                               uint16_t* __restrict out) {
  const uint8_t* __restrict r0 = rows[0];
  const uint8_t* __restrict r1 = rows[1];
  const uint8_t* __restrict r2 = rows[2];
  const uint8_t* __restrict r3 = rows[3];
  const uint8_t* __restrict r4 = rows[4];
  for (int x = 0; x < n; ++x) {
    const auto outer = static_cast<uint16_t>(r0[x] + r4[x]);
    const auto inner = static_cast<uint16_t>(r1[x] + r3[x]);
    out[x] = static_cast<uint16_t>(outer + 4 * inner + 6 * r2[x]);
  }
}

// 256 * 255 + 8 is below 2^16.
WAYMARK_INLINE void SmoothAlong(const uint16_t* __restrict in,
                                int n,
                                int16_t* __restrict out) {
  for (int x = 0; x < n; ++x) {
    const auto outer = static_cast<uint16_t>(in[x - 2] + in[x + 2]);
    const auto inner = static_cast<uint16_t>(in[x - 1] + in[x + 1]);
    const auto sum = static_cast<uint16_t>(outer + 4 * inner + 6 * in[x] + 8);
    out[x] = static_cast<int16_t>(sum >> 4);
  }
}

// At most 4 * 4080 each, so the sum of both fits.
WAYMARK_INLINE void Differentiate(const int16_t* const rows[3],
                                  int n,
                                  const GradientRow& row) {
  const int16_t* __restrict a = rows[0];
  const int16_t* __restrict m = rows[1];
  const int16_t* __restrict b = rows[2];
  int16_t* __restrict out_x = row.dx;
  int16_t* __restrict out_y = row.dy;
  int16_t* __restrict out_m = row.magnitude;
  // Three rows written from three read are too many to be compared.
#pragma GCC ivdep
  for (int x = 0; x < n; ++x) {
    const auto dx = static_cast<int16_t>(
        a[x + 1] - a[x - 1] + 2 * (m[x + 1] - m[x - 1]) + b[x + 1] - b[x - 1]);
    const auto dy = static_cast<int16_t>(
        b[x - 1] - a[x - 1] + 2 * (b[x] - a[x]) + b[x + 1] - a[x + 1]);
    const auto ax = static_cast<int16_t>(dx < 0 ? -dx : dx);
    const auto ay = static_cast<int16_t>(dy < 0 ? -dy : dy);
    out_x[x] = dx;
    out_y[x] = dy;
    out_m[x] = static_cast<int16_t>(ax + ay);
  }
}

// Of two equal neighbours one survives: the one below or on the right.
WAYMARK_INLINE uint8_t
Mark(int16_t m, int16_t before, int16_t after, int16_t low, int16_t high) {
  const int16_t least = before > low ? before : low;
  const int keep = (m > least) & (m >= after);
  return static_cast<uint8_t>(keep ? (m > high ? 3 : 1) : 0);
}

WAYMARK_INLINE void SuppressTwoAxes(const SuppressionRow& row,
                                    int n,
                                    uint8_t* __restrict marks) {
  const int16_t* __restrict up = row.above;
  const int16_t* __restrict mid = row.middle;
  const int16_t* __restrict down = row.below;
  const int16_t* __restrict gx = row.dx;
  const int16_t* __restrict gy = row.dy;
  const int16_t low = row.low;
  const int16_t high = row.high;
  for (int x = 0; x < n; ++x) {
    const auto ax = static_cast<int16_t>(gx[x] < 0 ? -gx[x] : gx[x]);
    const auto ay = static_cast<int16_t>(gy[x] < 0 ? -gy[x] : gy[x]);
    const int16_t left = mid[x - 1];
    const int16_t right = mid[x + 1];
    const int16_t over = up[x];
    const int16_t under = down[x];
    const int16_t before = ax >= ay ? left : over;
    const int16_t after = ax >= ay ? right : under;
    marks[x] = Mark(mid[x], before, after, low, high);
  }
}

WAYMARK_INLINE void SuppressFourDirections(const SuppressionRow& row,
                                           int n,
                                           uint8_t* __restrict marks) {
  const int16_t* __restrict up = row.above;
  const int16_t* __restrict mid = row.middle;
  const int16_t* __restrict down = row.below;
  const int16_t* __restrict gx = row.dx;
  const int16_t* __restrict gy = row.dy;
  const int16_t low = row.low;
  const int16_t high = row.high;
  for (int x = 0; x < n; ++x) {
    const int ax = gx[x] < 0 ? -gx[x] : gx[x];
    const int ay = gy[x] < 0 ? -gy[x] : gy[x];
    // tan(22.5 degrees) is 106 / 256.
    const bool is_along = 256 * ay < 106 * ax;
    const bool is_down = 256 * ax < 106 * ay;
    const bool is_falling = (gx[x] ^ gy[x]) >= 0;  // Right and down.
    const int16_t left = mid[x - 1];
    const int16_t right = mid[x + 1];
    const int16_t over = up[x];
    const int16_t under = down[x];
    const int16_t first = is_falling ? up[x - 1] : up[x + 1];
    const int16_t second = is_falling ? down[x + 1] : down[x - 1];
    const int16_t before = is_along ? left : is_down ? over : first;
    const int16_t after = is_along ? right : is_down ? under : second;
    marks[x] = Mark(mid[x], before, after, low, high);
  }
}

#if defined(__SSE2__)
template <typename Mask>
std::uint64_t PackBy(const uint8_t* bytes, const Mask& mask_of) {
  std::uint64_t word = 0;
  for (int i = 0; i < 64; i += 16) {
    const __m128i sixteen =
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes + i));
    const auto mask =
        static_cast<unsigned>(_mm_movemask_epi8(mask_of(sixteen)));
    word |= static_cast<std::uint64_t>(mask) << i;
  }
  return word;
}
#else
// `bits_of` leaves the lowest bit of each of eight bytes; the product gathers
// them in its highest byte.
template <typename Bits>
std::uint64_t PackBy(const uint8_t* bytes, const Bits& bits_of) {
  std::uint64_t word = 0;
  for (int i = 0; i < 64; i += 8) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, bytes + i, sizeof(eight));
    word |= (bits_of(eight) * 0x0102040810204080ull >> 56) << i;
  }
  return word;
}
#endif

// Of num_words times 64 bytes one bit each: whether it is not 0.
void PackNotZero(const uint8_t* bytes, int num_words, std::uint64_t* bits) {
  for (int i = 0; i < num_words; ++i, bytes += 64) {
#if defined(__SSE2__)
    bits[i] = ~PackBy(bytes, [](__m128i v) {
      return _mm_cmpeq_epi8(v, _mm_setzero_si128());
    });
#else
    bits[i] = PackBy(bytes, [](std::uint64_t v) {
      v |= v >> 4 & 0x0F0F0F0F0F0F0F0Full;
      v |= v >> 2 & 0x3333333333333333ull;
      v |= v >> 1 & 0x7F7F7F7F7F7F7F7Full;
      return v & 0x0101010101010101ull;
    });
#endif
  }
}

constexpr EdgeRowLoops kPortable{
    [](const uint8_t* const rows[5], int n, uint16_t* out) {
      SmoothDown(rows, n, out);
    },
    [](const uint16_t* in, int n, int16_t* out) { SmoothAlong(in, n, out); },
    [](const int16_t* const rows[3], int n, const GradientRow& out) {
      Differentiate(rows, n, out);
    },
    [](const SuppressionRow& row, int n, uint8_t* marks) {
      SuppressTwoAxes(row, n, marks);
    },
    [](const SuppressionRow& row, int n, uint8_t* marks) {
      SuppressFourDirections(row, n, marks);
    },
    PackNotZero};

#if defined(__x86_64__)
WAYMARK_AVX2 void WideSmoothDown(const uint8_t* const rows[5],
                                 int n,
                                 uint16_t* out) {
  SmoothDown(rows, n, out);
}
WAYMARK_AVX2 void WideSmoothAlong(const uint16_t* in, int n, int16_t* out) {
  SmoothAlong(in, n, out);
}
WAYMARK_AVX2 void WideDifferentiate(const int16_t* const rows[3],
                                    int n,
                                    const GradientRow& out) {
  Differentiate(rows, n, out);
}
WAYMARK_AVX2 void WideTwoAxes(const SuppressionRow& row,
                              int n,
                              uint8_t* marks) {
  SuppressTwoAxes(row, n, marks);
}
WAYMARK_AVX2 void WideFourDirections(const SuppressionRow& row,
                                     int n,
                                     uint8_t* marks) {
  SuppressFourDirections(row, n, marks);
}
WAYMARK_AVX2 void WidePackNotZero(const uint8_t* bytes,
                                  int num_words,
                                  std::uint64_t* bits) {
  for (int i = 0; i < num_words; ++i, bytes += 64) {
    std::uint64_t zero = 0;
    for (int half = 0; half < 64; half += 32) {
      const __m256i v =
          _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes + half));
      const auto mask = static_cast<unsigned>(
          _mm256_movemask_epi8(_mm256_cmpeq_epi8(v, _mm256_setzero_si256())));
      zero |= static_cast<std::uint64_t>(mask) << half;
    }
    bits[i] = ~zero;
  }
}
constexpr EdgeRowLoops kWide{WideSmoothDown,
                             WideSmoothAlong,
                             WideDifferentiate,
                             WideTwoAxes,
                             WideFourDirections,
                             WidePackNotZero};

WAYMARK_AVX512BW void WidestPackNotZero(const uint8_t* bytes,
                                        int num_words,
                                        std::uint64_t* bits) {
  for (int i = 0; i < num_words; ++i, bytes += 64) {
    const __m512i v = _mm512_loadu_si512(bytes);
    bits[i] = _mm512_test_epi8_mask(v, v);
  }
}
constexpr EdgeRowLoops kWidest{WideSmoothDown,
                               WideSmoothAlong,
                               WideDifferentiate,
                               WideTwoAxes,
                               WideFourDirections,
                               WidestPackNotZero};
#endif

}  // namespace

template <int Bit>
std::uint64_t PackBit(const std::uint8_t* bytes) {
#if defined(__SSE2__)
  return PackBy(bytes, [](__m128i v) { return _mm_slli_epi16(v, 7 - Bit); });
#else
  return PackBy(
      bytes, [](std::uint64_t v) { return v >> Bit & 0x0101010101010101ull; });
#endif
}
template std::uint64_t PackBit<0>(const std::uint8_t* bytes);
template std::uint64_t PackBit<1>(const std::uint8_t* bytes);

std::vector<const EdgeRowLoops*> EdgeRowLoopsVariants() {
  std::vector<const EdgeRowLoops*> all{&kPortable};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") != 0) all.push_back(&kWide);
  if (__builtin_cpu_supports("avx512bw") != 0) all.push_back(&kWidest);
#endif
  return all;
}

}  // namespace waymark
