#include "estimation/lines/fullest_line.h"

#include "estimation/lines/processor_targets.h"

#include <algorithm>
#include <array>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace waymark {
namespace {

WAYMARK_INLINE FullestLine FullestOf(const std::uint64_t* lines,
                                     int num_lines,
                                     std::uint64_t tile) {
  FullestLine best;
  for (int i = 0; i < num_lines; ++i) {
    const int count = __builtin_popcountll(lines[i] & tile);
    if (count > best.count) best = {i, count};
  }
  return best;
}

FullestLine FindFullestLinePortably(const std::uint64_t* lines,
                                    int num_lines,
                                    std::uint64_t tile) {
  return FullestOf(lines, num_lines, tile);
}

#if defined(__x86_64__)
WAYMARK_POPCNT FullestLine FindByPopcnt(const std::uint64_t* lines,
                                        int num_lines,
                                        std::uint64_t tile) {
  return FullestOf(lines, num_lines, tile);
}

// Eight lines at a time. The count above the bits of the index, counted down:
// the greatest of all is the first of the fullest.
WAYMARK_AVX512_POPCNT FullestLine FindByWidePopcnt(const std::uint64_t* lines,
                                                   int num_lines,
                                                   std::uint64_t tile) {
  constexpr int kShift = 32;
  // Masks of all lanes: without one, GCC 12 warns of its own header.
  constexpr __mmask8 kAll = 0xFF;
  const __m512i tiles = _mm512_set1_epi64(static_cast<long long>(tile));
  __m512i best = _mm512_setzero_si512();
  __m512i left = _mm512_sub_epi64(_mm512_set1_epi64(num_lines - 1),
                                  _mm512_set_epi64(7, 6, 5, 4, 3, 2, 1, 0));
  for (int i = 0; i < num_lines; i += kLineBlock) {
    const __m512i line = _mm512_loadu_si512(lines + i);
    const __m512i count = _mm512_popcnt_epi64(_mm512_and_si512(line, tiles));
    const __m512i key =
        _mm512_or_si512(_mm512_maskz_slli_epi64(kAll, count, kShift), left);
    best = _mm512_maskz_max_epi64(kAll, best, key);
    left = _mm512_sub_epi64(left, _mm512_set1_epi64(kLineBlock));
  }
  alignas(64) std::array<std::int64_t, kLineBlock> keys{};
  _mm512_store_si512(keys.data(), best);
  const std::int64_t key = *std::max_element(keys.begin(), keys.end());
  const int count = static_cast<int>(key >> kShift);
  if (count == 0) return {};
  return {num_lines - 1 - static_cast<int>(key & 0xFFFFFFFF), count};
}
#endif

}  // namespace

std::vector<FindFullestLine> FindFullestLineVariants() {
  std::vector<FindFullestLine> all{FindFullestLinePortably};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("popcnt") != 0) all.push_back(FindByPopcnt);
  if (__builtin_cpu_supports("avx512vpopcntdq") != 0) {
    all.push_back(FindByWidePopcnt);
  }
#endif
  return all;
}

}  // namespace waymark
