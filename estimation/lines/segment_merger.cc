#include "estimation/lines/segment_merger.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

// The smoothing ties the errors of some pixels in a row to each other.
constexpr double kPixelsOfOneError = 4.0;
// What is left for many pixels, by rendered edges: shading beside an edge and
// its neighbours move all of it, and turn it less.
constexpr double kOffsetFloorPx = 0.1;
constexpr double kTurnFloorPx = 0.05;
// A piece may start behind the end it continues by this much: the sawtooth of
// two tiles' edges.
constexpr float kOverlapPx = 2.0f;
// How far beside the end of a short trace its continuation may begin, and how
// much it may seem to turn there: the error of some pixels in a row.
constexpr float kSidePx = 2.0f;
constexpr float kTurn = 0.35f;
constexpr float kCellPx = 8.0f;
// Smaller pieces only continue others: their own direction says too little.
constexpr std::int32_t kFirstPixels = 5;
// Ends lie within this many times the root mean square.
constexpr double kEnds = 3.0;

// Four values at a time, on any processor.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
constexpr std::size_t kLanes = 4;

Float4 Load(const float* values) {
  Float4 result;
  std::memcpy(&result, values, sizeof(result));
  return result;
}

Float4 Absolute(Float4 v) {
  return std::bit_cast<Float4>(std::bit_cast<Int4>(v) & 0x7FFFFFFF);
}

int CellOf(float value) {
  return static_cast<int>(value * (1.0f / kCellPx));
}

bool IsForward(const Eigen::Vector2f& a,
               const Eigen::Vector2f& b,
               const Eigen::Vector2d& direction) {
  return direction.x() * static_cast<double>(b.x() - a.x()) +
             direction.y() * static_cast<double>(b.y() - a.y()) >=
         0.0;
}

}  // namespace

void SegmentMergerOptions::Check() const {
  if (!(max_gap_px > 0.0) || !(max_gap_px <= 64.0)) {
    throw std::invalid_argument("max_gap_px must be in (0, 64]");
  }
  if (!(max_rms_px > 0.0) || !(max_rms_px <= 10.0)) {
    throw std::invalid_argument("max_rms_px must be in (0, 10]");
  }
  if (!(min_length_px >= 1.0) || !std::isfinite(min_length_px)) {
    throw std::invalid_argument("min_length_px must be finite and at least 1");
  }
}

SegmentMerger::SegmentMerger(const SegmentMergerOptions& options)
    : options_(options) {
  options.Check();
}

void SegmentMerger::Ends::Resize(std::size_t num) {
  // What follows the last is looked at with it, and refused.
  for (auto* values : {&near_x, &near_y, &far_x, &far_y}) {
    values->resize(num + kLanes);
    std::fill(values->end() - kLanes,
              values->end(),
              std::numeric_limits<float>::infinity());
  }
  code.resize(num + kLanes);
}

// By counting: the ends of three cells side by side follow each other.
void SegmentMerger::FillCells(const LineParts& parts, int width, int height) {
  num_columns_ = CellOf(static_cast<float>(width)) + 1;
  num_rows_ = CellOf(static_cast<float>(height)) + 1;
  first_.assign(static_cast<std::size_t>(num_columns_) *
                        static_cast<std::size_t>(num_rows_) +
                    1,
                0);
  ends_.Resize(2 * parts.parts.size());
  end_of_.resize(2 * parts.parts.size());
  const auto cell_of = [&](const Eigen::Vector2f& p) {
    return static_cast<std::size_t>(CellOf(p.y())) *
               static_cast<std::size_t>(num_columns_) +
           static_cast<std::size_t>(CellOf(p.x()));
  };
  for (const LinePart& part : parts.parts) {
    ++first_[cell_of(part.a)];
    ++first_[cell_of(part.b)];
  }
  std::int32_t sum = 0;
  for (std::int32_t& first : first_) {
    sum += first;
    first = sum;
  }
  const auto put = [&](const Eigen::Vector2f& near,
                       const Eigen::Vector2f& far,
                       std::size_t code) {
    const auto at = static_cast<std::size_t>(--first_[cell_of(near)]);
    ends_.near_x[at] = near.x();
    ends_.near_y[at] = near.y();
    ends_.far_x[at] = far.x();
    ends_.far_y[at] = far.y();
    ends_.code[at] = static_cast<std::int32_t>(code);
    end_of_[code] = static_cast<std::int32_t>(at);
  };
  // From the back, so that ends of a cell keep their order.
  for (std::size_t i = parts.parts.size(); i-- > 0;) {
    const LinePart& part = parts.parts[i];
    const std::size_t code = 2 * i;
    put(part.b, part.a, code + 1);
    put(part.a, part.b, code);
  }
}

void SegmentMerger::Use(std::size_t part) {
  is_used_[part] = 1;
  for (const std::size_t code : {2 * part, 2 * part + 1}) {
    ends_.near_x[static_cast<std::size_t>(end_of_[code])] =
        std::numeric_limits<float>::infinity();
  }
}

void SegmentMerger::Consider(const LineParts& parts,
                             std::size_t end,
                             Continuation* best) {
  const std::int32_t code = ends_.code[end];
  if (parts.is_directed && (code % 2 == 1) != trace_.is_turned) return;
  LineMoments sum = trace_.moments;
  sum += parts.parts[static_cast<std::size_t>(code / 2)].moments;
  if (!sum.IsStraight(best->least)) return;
  LineFit fit = sum.Fit();
  if (fit.across > best->least) return;
  const double end_limit = kEnds * options_.max_rms_px;
  const auto is_off = [&](float x, float y) {
    return std::abs(fit.Distance(
               {static_cast<double>(x), static_cast<double>(y)})) > end_limit;
  };
  if (is_off(ends_.near_x[end], ends_.near_y[end]) ||
      is_off(ends_.far_x[end], ends_.far_y[end]) ||
      is_off(trace_.b.x(), trace_.b.y())) {
    return;
  }
  if (fit.direction.dot(trace_.fit.direction) < 0.0) {
    fit.direction = -fit.direction;
  }
  *best = {code, sum, fit, fit.across};
}

bool SegmentMerger::Extend(const LineParts& parts) {
  Continuation best;
  best.least = options_.max_rms_px * options_.max_rms_px;
  // Ends that may continue the trace lie in a small box ahead of it; the first
  // checks are cheap, as most of them fail.
  const auto gap = static_cast<float>(options_.max_gap_px);
  const float bx = trace_.b.x();
  const float by = trace_.b.y();
  const auto dx = static_cast<float>(trace_.fit.direction.x());
  const auto dy = static_cast<float>(trace_.fit.direction.y());
  const auto range = [gap](float at, float along, float aside, int num) {
    const float one = -kOverlapPx * along;
    const float other = gap * along;
    const float side = kSidePx * std::abs(aside);
    return std::pair(
        std::max(0, CellOf(at + std::min(one, other) - side)),
        std::min(num - 1, CellOf(at + std::max(one, other) + side)));
  };
  const auto [left, right] = range(bx, dx, dy, num_columns_);
  const auto [top, bottom] = range(by, dy, dx, num_rows_);
  for (int r = top; r <= bottom; ++r) {
    const std::int32_t* cells = first_.data() + r * num_columns_;
    const auto first = static_cast<std::size_t>(cells[left]);
    const auto last = static_cast<std::size_t>(cells[right + 1]);
    for (std::size_t i = first; i < last; i += kLanes) {
      const Float4 step_x = Load(&ends_.near_x[i]) - bx;
      const Float4 step_y = Load(&ends_.near_y[i]) - by;
      const Float4 reach_x = Load(&ends_.far_x[i]) - bx;
      const Float4 reach_y = Load(&ends_.far_y[i]) - by;
      const Float4 step = dx * step_x + dy * step_y;
      const Float4 reach = dx * reach_x + dy * reach_y;
      // Nothing holds of what is infinite.
      const Int4 is_near =
          (Absolute(dx * step_y - dy * step_x) <= kSidePx) &
          (step >= -kOverlapPx) & (step <= gap) & (reach > 0.0f) &
          (reach > step) &
          (Absolute(dx * reach_y - dy * reach_x) <= kSidePx + kTurn * reach);
      const auto any = std::bit_cast<std::array<std::uint64_t, 2>>(is_near);
      if ((any[0] | any[1]) == 0) continue;
      for (std::size_t k = 0; k < kLanes && i + k < last; ++k) {
        if (is_near[k] != 0) Consider(parts, i + k, &best);
      }
    }
  }
  if (best.code < 0) return false;
  const auto index = static_cast<std::size_t>(best.code / 2);
  const LinePart& part = parts.parts[index];
  trace_.moments = best.moments;
  trace_.fit = best.fit;
  trace_.ahead.push_back(best.code);
  trace_.b = best.code % 2 == 1 ? part.a : part.b;
  Use(index);
  return true;
}

// Afterwards b is the other end.
void SegmentMerger::Turn() {
  std::swap(trace_.a, trace_.b);
  std::swap(trace_.ahead, trace_.behind);
  trace_.fit.direction = -trace_.fit.direction;
  trace_.is_turned = !trace_.is_turned;
}

void SegmentMerger::Emit(const LineParts& parts, LineSet* set) {
  // Pixels of the pieces may reach a little beyond the ends of the trace.
  if ((trace_.b - trace_.a).norm() + 2.0f * kOverlapPx <
      static_cast<float>(options_.min_length_px)) {
    return;
  }
  LineSegment segment;
  segment.first_pixel = static_cast<std::int32_t>(set->pixels.size());
  const auto append = [&](std::int32_t end, bool is_back) {
    const LinePart& part = parts.parts[static_cast<std::size_t>(end / 2)];
    const Eigen::Vector2f* first = parts.pixels.data() + part.first_pixel;
    if ((end % 2 == 1) != is_back) {
      set->pixels.insert(set->pixels.end(),
                         std::make_reverse_iterator(first + part.num_pixels),
                         std::make_reverse_iterator(first));
    } else {
      set->pixels.insert(set->pixels.end(), first, first + part.num_pixels);
    }
  };
  for (auto it = trace_.behind.rbegin(); it != trace_.behind.rend(); ++it) {
    append(*it, true);
  }
  for (const std::int32_t end : trace_.ahead) append(end, false);
  const auto begin = set->pixels.begin() + segment.first_pixel;
  segment.num_pixels =
      static_cast<std::int32_t>(set->pixels.size()) - segment.first_pixel;
  const Eigen::Vector2f d = trace_.fit.direction.cast<float>();
  // Nearly sorted already: an insertion sort takes few steps.
  float before = d.dot(*begin);
  for (auto it = begin + 1; it != set->pixels.end(); ++it) {
    const Eigen::Vector2f pixel = *it;
    const float key = d.dot(pixel);
    if (key >= before) {
      before = key;
      continue;
    }
    auto at = it;
    for (; at != begin && d.dot(*(at - 1)) > key; --at) *at = *(at - 1);
    *at = pixel;
  }
  const auto on_line = [&](const Eigen::Vector2f& p) -> Eigen::Vector2d {
    return trace_.fit.mean +
           trace_.fit.Along(p.cast<double>()) * trace_.fit.direction;
  };
  segment.a = on_line(*begin);
  segment.b = on_line(set->pixels.back());
  if ((segment.b - segment.a).norm() < options_.min_length_px) {
    set->pixels.resize(static_cast<std::size_t>(segment.first_pixel));
    return;
  }
  SetSegmentErrors(std::sqrt(trace_.fit.across), &segment);
  set->segments.push_back(segment);
}

LineSet SegmentMerger::Merge(const LineParts& parts, int width, int height) {
  LineSet set;
  set.has_polarity = parts.is_directed;
  if (parts.parts.empty()) return set;
  set.pixels.reserve(parts.pixels.size());
  FillCells(parts, width, height);
  is_used_.assign(parts.parts.size(), 0);
  for (std::size_t i = 0; i < parts.parts.size(); ++i) {
    const LinePart& part = parts.parts[i];
    if (is_used_[i] || part.num_pixels < kFirstPixels) continue;
    Use(i);
    trace_.moments = part.moments;
    trace_.fit = part.moments.Fit();
    if (!IsForward(part.a, part.b, trace_.fit.direction)) {
      trace_.fit.direction = -trace_.fit.direction;
    }
    trace_.ahead.assign(1, static_cast<std::int32_t>(2 * i));
    trace_.behind.clear();
    trace_.a = part.a;
    trace_.b = part.b;
    trace_.is_turned = false;
    while (Extend(parts)) {
    }
    Turn();
    while (Extend(parts)) {
    }
    Turn();
    Emit(parts, &set);
  }
  return set;
}

// A uniform row of n independent errors s across a length L: s / sqrt(n) at
// the middle, s sqrt(12 / n) / L in direction.
void SetSegmentErrors(double across_px, LineSegment* segment) {
  const double length = std::max(1.0, (segment->b - segment->a).norm());
  const double num = std::max(1.0, segment->num_pixels / kPixelsOfOneError);
  const double error = across_px / std::sqrt(num);
  segment->sigma_px =
      std::sqrt(error * error + kOffsetFloorPx * kOffsetFloorPx);
  segment->sigma_rad = std::sqrt(12.0) *
                       std::sqrt(error * error + kTurnFloorPx * kTurnFloorPx) /
                       length;
}

}  // namespace waymark
