#include "estimation/lines/segment_merger.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

// The smoothing ties the errors of some pixels in a row to each other.
constexpr double kPixelsOfOneError = 4.0;
// What is left for many pixels: the shape of the edge, the crest's parabola.
constexpr double kFloorPx = 0.03;
// A piece may start behind the end it continues by this much: the sawtooth of
// two tiles' edges.
constexpr double kOverlapPx = 2.0;

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

// Cells are as wide as the gap, so that 3 x 3 of them hold all that is near.
int SegmentMerger::CellOf(float value) const {
  return static_cast<int>(static_cast<double>(value) / options_.max_gap_px);
}

// Ends 2 i (a) and 2 i + 1 (b) of piece i.
void SegmentMerger::FillCells(const LineParts& parts, int width, int height) {
  num_columns_ = CellOf(static_cast<float>(width)) + 1;
  num_rows_ = CellOf(static_cast<float>(height)) + 1;
  first_.assign(static_cast<std::size_t>(num_columns_) *
                    static_cast<std::size_t>(num_rows_),
                -1);
  next_.resize(2 * parts.parts.size());
  for (std::size_t end = 0; end < next_.size(); ++end) {
    const LinePart& part = parts.parts[end / 2];
    const Eigen::Vector2f& p = end % 2 == 0 ? part.a : part.b;
    std::int32_t& head = first_[static_cast<std::size_t>(
        CellOf(p.y()) * num_columns_ + CellOf(p.x()))];
    next_[end] = head;
    head = static_cast<std::int32_t>(end);
  }
}

bool SegmentMerger::Extend(const LineParts& parts) {
  const Eigen::Vector2f at = trace_.b;
  const float gap = static_cast<float>(options_.max_gap_px);
  const double limit = options_.max_rms_px * options_.max_rms_px;
  const double end_limit = 3.0 * options_.max_rms_px;
  std::int32_t best = -1;
  LineMoments best_moments;
  LineFit best_fit;
  double least = limit;
  const int row = CellOf(at.y());
  const int column = CellOf(at.x());
  for (int r = std::max(0, row - 1); r <= std::min(num_rows_ - 1, row + 1);
       ++r) {
    for (int c = std::max(0, column - 1);
         c <= std::min(num_columns_ - 1, column + 1);
         ++c) {
      for (std::int32_t end =
               first_[static_cast<std::size_t>(r * num_columns_ + c)];
           end >= 0;
           end = next_[static_cast<std::size_t>(end)]) {
        const auto i = static_cast<std::size_t>(end / 2);
        if (is_used_[i]) continue;
        const bool is_turned = end % 2 == 1;
        if (parts.is_directed && is_turned != trace_.is_turned) continue;
        const LinePart& part = parts.parts[i];
        const Eigen::Vector2f& near = is_turned ? part.b : part.a;
        const Eigen::Vector2f& far = is_turned ? part.a : part.b;
        const Eigen::Vector2f step = near - at;
        if (step.squaredNorm() > gap * gap) continue;
        const Eigen::Vector2d& d = trace_.fit.direction;
        if (d.dot(step.cast<double>()) < -kOverlapPx) continue;
        if (d.dot((far - at).cast<double>()) <= 0.0) continue;
        if (!IsForward(near, far, d)) continue;
        if (std::abs(trace_.fit.Distance(far.cast<double>())) >
            4.0 * end_limit) {
          continue;
        }
        LineMoments sum = trace_.moments;
        sum += part.moments;
        LineFit fit = sum.Fit();
        if (fit.across > least) continue;
        if (std::abs(fit.Distance(near.cast<double>())) > end_limit ||
            std::abs(fit.Distance(far.cast<double>())) > end_limit ||
            std::abs(fit.Distance(at.cast<double>())) > end_limit) {
          continue;
        }
        if (fit.direction.dot(d) < 0.0) fit.direction = -fit.direction;
        best = end;
        least = fit.across;
        best_moments = sum;
        best_fit = fit;
      }
    }
  }
  if (best < 0) return false;
  const LinePart& part = parts.parts[static_cast<std::size_t>(best / 2)];
  trace_.moments = best_moments;
  trace_.fit = best_fit;
  trace_.ahead.push_back(best);
  trace_.b = best % 2 == 1 ? part.a : part.b;
  is_used_[static_cast<std::size_t>(best / 2)] = 1;
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
  for (auto it = begin + 1; it != set->pixels.end(); ++it) {
    const Eigen::Vector2f pixel = *it;
    const float key = d.dot(pixel);
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
    if (is_used_[i]) continue;
    is_used_[i] = 1;
    const LinePart& part = parts.parts[i];
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
  segment->sigma_px = std::hypot(across_px / std::sqrt(num), kFloorPx);
  segment->sigma_rad = std::sqrt(12.0) * segment->sigma_px / length;
}

}  // namespace waymark
