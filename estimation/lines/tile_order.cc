#include "estimation/lines/tile_order.h"

#include "estimation/lines/processor_targets.h"
#include "estimation/lines/tile_words.h"

#include <array>
#include <bit>
#include <cmath>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace waymark {
namespace {

constexpr float kLast = kTileSide - 1;

// Twelve without a look at whether there are as many: most pieces have a few
// more or less than eight, so a branch for each would often be guessed wrongly.
void ListTilePixelsPortably(std::uint64_t ordered,
                            std::int32_t num,
                            const TileSteps& steps,
                            Eigen::Vector2f* pixels) {
  constexpr std::int32_t kStep = 12;
  constexpr std::uint64_t kEnd = std::uint64_t{1} << 63;
  for (std::int32_t done = 0; done < num; done += kStep, pixels += kStep) {
    for (int i = 0; i < kStep; ++i, ordered &= ordered - 1) {
      const int bit = std::countr_zero(ordered | kEnd);
      const auto major = static_cast<float>(bit / kTileSide);
      const auto minor = static_cast<float>(bit % kTileSide);
      pixels[i] = {steps.x0 + (steps.x_major * major + steps.x_minor * minor),
                   steps.y0 + (steps.y_major * major + steps.y_minor * minor)};
    }
  }
}

#if defined(__x86_64__)
constexpr std::array<std::uint8_t, 64> MakeIndices() {
  std::array<std::uint8_t, 64> indices{};
  for (std::size_t i = 0; i < indices.size(); ++i) {
    indices[i] = static_cast<std::uint8_t>(i);
  }
  return indices;
}
constexpr std::array<std::uint8_t, 64> kIndices = MakeIndices();

// Sixteen pixels at a time. Masks of all lanes: without one, GCC 12 warns of
// its own header.
WAYMARK_AVX512_COMPRESS void ListByCompressing(std::uint64_t ordered,
                                               std::int32_t num,
                                               const TileSteps& steps,
                                               Eigen::Vector2f* pixels) {
  constexpr __mmask16 kAll = 0xFFFF;
  alignas(64) std::array<std::uint8_t, 64> set;
  _mm512_store_si512(
      set.data(),
      _mm512_maskz_compress_epi8(ordered, _mm512_loadu_si512(kIndices.data())));
  const __m512i first =
      _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i second = _mm512_add_epi32(first, _mm512_set1_epi32(8));
  for (std::int32_t i = 0; i < num; i += kMostListed) {
    const __m128i some =
        _mm_load_si128(reinterpret_cast<const __m128i*>(set.data() + i));
    const __m512i index = _mm512_maskz_cvtepu8_epi32(kAll, some);
    const __m512 major =
        _mm512_maskz_cvtepi32_ps(kAll, _mm512_maskz_srli_epi32(kAll, index, 3));
    const __m512 minor = _mm512_maskz_cvtepi32_ps(
        kAll, _mm512_and_si512(index, _mm512_set1_epi32(kTileSide - 1)));
    const auto at = [&](float zero,
                        float by_major,
                        float by_minor) WAYMARK_AVX512_COMPRESS {
      return _mm512_add_ps(
          _mm512_set1_ps(zero),
          _mm512_add_ps(_mm512_mul_ps(_mm512_set1_ps(by_major), major),
                        _mm512_mul_ps(_mm512_set1_ps(by_minor), minor)));
    };
    const __m512 x = at(steps.x0, steps.x_major, steps.x_minor);
    const __m512 y = at(steps.y0, steps.y_major, steps.y_minor);
    float* out = pixels[i].data();
    _mm512_storeu_ps(out, _mm512_permutex2var_ps(x, first, y));
    _mm512_storeu_ps(out + kMostListed, _mm512_permutex2var_ps(x, second, y));
  }
}
#endif

}  // namespace

std::vector<ListTilePixels> ListTilePixelsVariants() {
  std::vector<ListTilePixels> all{ListTilePixelsPortably};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512vbmi2") != 0) {
    all.push_back(ListByCompressing);
  }
#endif
  return all;
}

TileOrder::TileOrder(const Eigen::Vector2f& direction)
    : is_wide_(std::abs(direction.x()) >= std::abs(direction.y())),
      is_left_(direction.x() < 0.0f),
      is_up_(direction.y() < 0.0f) {
  const float x = is_left_ ? -1.0f : 1.0f;
  const float y = is_up_ ? -1.0f : 1.0f;
  steps_ = {is_left_ ? kLast : 0.0f,
            is_wide_ ? x : 0.0f,
            is_wide_ ? 0.0f : x,
            is_up_ ? kLast : 0.0f,
            is_wide_ ? 0.0f : y,
            is_wide_ ? y : 0.0f};
}

Eigen::Vector2f* TileOrder::List(const TilePixels& tile,
                                 std::int32_t num,
                                 ListTilePixels list,
                                 Eigen::Vector2f* pixels) const {
  std::uint64_t w = tile.bits;
  if (is_up_) w = __builtin_bswap64(w);
  if (is_left_) w = ReverseRows(w);
  if (is_wide_) w = TransposeTile(w);
  TileSteps steps = steps_;
  steps.x0 += static_cast<float>(tile.x);
  steps.y0 += static_cast<float>(tile.y);
  list(w, num, steps, pixels);
  return pixels + num;
}

}  // namespace waymark
