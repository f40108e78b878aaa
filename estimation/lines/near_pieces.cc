#include "estimation/lines/near_pieces.h"

#include "estimation/lines/processor_targets.h"

#include <array>
#include <bit>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace waymark {
namespace {

// Eight values on any processor, in one register or several.
using Floats = float __attribute__((vector_size(32)));
using Ints = std::int32_t __attribute__((vector_size(32)));

constexpr int kLanes = static_cast<int>(kPieceLanes);

constexpr Ints kLane{0, 1, 2, 3, 4, 5, 6, 7};
constexpr Ints kBit{1, 2, 4, 8, 16, 32, 64, 128};

WAYMARK_INLINE std::uint32_t AllBits(const Ints& lanes) {
  std::array<std::uint64_t, 4> words;
  std::memcpy(words.data(), &lanes, sizeof(lanes));
  const std::uint64_t all = words[0] | words[1] | words[2] | words[3];
  return static_cast<std::uint32_t>(all | all >> 32);
}

// Of some pieces in a row, lane by lane.
struct Near {
  Ints is_near;
  Ints is_a;  // Whether a is the nearer end.
};

WAYMARK_INLINE void Look(const PieceEnds& ends,
                         const LineEnd& line,
                         std::int32_t first,
                         std::int32_t num,
                         Near* near) {
  Floats ax;
  Floats ay;
  Floats bx;
  Floats by;
  std::memcpy(&ax, ends.ax + first, sizeof(ax));
  std::memcpy(&ay, ends.ay + first, sizeof(ay));
  std::memcpy(&bx, ends.bx + first, sizeof(bx));
  std::memcpy(&by, ends.by + first, sizeof(by));
  ax -= line.x;
  ay -= line.y;
  bx -= line.x;
  by -= line.y;
  const Floats along_a = line.dx * ax + line.dy * ay;
  const Floats along_b = line.dx * bx + line.dy * by;
  const Floats beside_a = line.dx * ay - line.dy * ax;
  const Floats beside_b = line.dx * by - line.dy * bx;
  near->is_a = along_a < along_b;
  const Floats step = near->is_a ? along_a : along_b;
  const Floats reach = near->is_a ? along_b : along_a;
  const Floats beside = near->is_a ? beside_a : beside_b;
  const Floats turned = near->is_a ? beside_b : beside_a;
  const Floats most_turned = line.aside + line.turn * reach;
  near->is_near = (kLane < num) & (beside <= line.aside) &
                  (beside >= -line.aside) & (step >= line.least_step) &
                  (step <= line.most_step) & (reach > 0.0f) & (reach > step) &
                  (turned <= most_turned) & (turned >= -most_turned);
}

WAYMARK_INLINE std::int32_t* FindNear(const PieceEnds& ends,
                                      const PieceRows& rows,
                                      const LineEnd& line,
                                      std::int32_t* found) {
  const std::int32_t* row = rows.first;
  for (int r = 0; r < rows.num_rows; ++r, row += rows.stride) {
    const std::int32_t last = row[rows.num_columns];
    for (std::int32_t i = row[0]; i < last; i += kLanes) {
      Near near;
      Look(ends, line, i, last - i, &near);
      std::uint32_t bits = AllBits(near.is_near & kBit);
      if (bits == 0) continue;
      const std::uint32_t is_a = AllBits(near.is_a & kBit);
      for (; bits != 0; bits &= bits - 1) {
        const int j = std::countr_zero(bits);
        *found++ = 2 * (i + j) + static_cast<std::int32_t>(~is_a >> j & 1);
      }
    }
  }
  return found;
}

std::int32_t* FindNearPiecesPortably(const PieceEnds& ends,
                                     const PieceRows& rows,
                                     const LineEnd& line,
                                     std::int32_t* found) {
  return FindNear(ends, rows, line, found);
}

#if defined(__x86_64__)
WAYMARK_AVX2 std::int32_t* FindByAvx2(const PieceEnds& ends,
                                      const PieceRows& rows,
                                      const LineEnd& line,
                                      std::int32_t* found) {
  return FindNear(ends, rows, line, found);
}

// As Look, sixteen pieces at a time.
struct WideNear {
  std::uint32_t is_near;
  std::uint32_t is_a;
};
constexpr int kWideLanes = 16;

WAYMARK_INLINE WAYMARK_AVX512 WideNear WideLook(const PieceEnds& ends,
                                                const LineEnd& line,
                                                std::int32_t first,
                                                std::int32_t num) {
  const auto lanes =
      static_cast<__mmask16>(num >= kWideLanes ? 0xFFFFu : (1u << num) - 1);
  const __m512 x = _mm512_set1_ps(line.x);
  const __m512 y = _mm512_set1_ps(line.y);
  const __m512 dx = _mm512_set1_ps(line.dx);
  const __m512 dy = _mm512_set1_ps(line.dy);
  const __m512 aside = _mm512_set1_ps(line.aside);
  const __m512 ax =
      _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, ends.ax + first), x);
  const __m512 ay =
      _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, ends.ay + first), y);
  const __m512 bx =
      _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, ends.bx + first), x);
  const __m512 by =
      _mm512_sub_ps(_mm512_maskz_loadu_ps(lanes, ends.by + first), y);
  const __m512 along_a =
      _mm512_add_ps(_mm512_mul_ps(dx, ax), _mm512_mul_ps(dy, ay));
  const __m512 along_b =
      _mm512_add_ps(_mm512_mul_ps(dx, bx), _mm512_mul_ps(dy, by));
  const __m512 beside_a =
      _mm512_sub_ps(_mm512_mul_ps(dx, ay), _mm512_mul_ps(dy, ax));
  const __m512 beside_b =
      _mm512_sub_ps(_mm512_mul_ps(dx, by), _mm512_mul_ps(dy, bx));
  const __mmask16 is_a = _mm512_cmp_ps_mask(along_a, along_b, _CMP_LT_OQ);
  const __m512 step = _mm512_mask_blend_ps(is_a, along_b, along_a);
  const __m512 reach = _mm512_mask_blend_ps(is_a, along_a, along_b);
  const __m512 beside =
      _mm512_abs_ps(_mm512_mask_blend_ps(is_a, beside_b, beside_a));
  const __m512 turned =
      _mm512_abs_ps(_mm512_mask_blend_ps(is_a, beside_a, beside_b));
  const __m512 most_turned =
      _mm512_add_ps(aside, _mm512_mul_ps(_mm512_set1_ps(line.turn), reach));
  const std::uint32_t is_near =
      lanes & _mm512_cmp_ps_mask(beside, aside, _CMP_LE_OQ) &
      _mm512_cmp_ps_mask(step, _mm512_set1_ps(line.least_step), _CMP_GE_OQ) &
      _mm512_cmp_ps_mask(step, _mm512_set1_ps(line.most_step), _CMP_LE_OQ) &
      _mm512_cmp_ps_mask(reach, _mm512_setzero_ps(), _CMP_GT_OQ) &
      _mm512_cmp_ps_mask(reach, step, _CMP_GT_OQ) &
      _mm512_cmp_ps_mask(turned, most_turned, _CMP_LE_OQ);
  return {is_near, is_a};
}

WAYMARK_AVX512 std::int32_t* FindByAvx512(const PieceEnds& ends,
                                          const PieceRows& rows,
                                          const LineEnd& line,
                                          std::int32_t* found) {
  const std::int32_t* row = rows.first;
  for (int r = 0; r < rows.num_rows; ++r, row += rows.stride) {
    const std::int32_t last = row[rows.num_columns];
    for (std::int32_t i = row[0]; i < last; i += kWideLanes) {
      const WideNear near = WideLook(ends, line, i, last - i);
      for (std::uint32_t bits = near.is_near; bits != 0; bits &= bits - 1) {
        const int j = std::countr_zero(bits);
        *found++ = 2 * (i + j) + static_cast<std::int32_t>(~near.is_a >> j & 1);
      }
    }
  }
  return found;
}
#endif

}  // namespace

std::vector<FindNearPieces> FindNearPiecesVariants() {
  std::vector<FindNearPieces> all{FindNearPiecesPortably};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") != 0) all.push_back(FindByAvx2);
  if (__builtin_cpu_supports("avx512f") != 0) all.push_back(FindByAvx512);
#endif
  return all;
}

}  // namespace waymark
