#include "estimation/lines/segment_merger.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numeric>
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
// Two continuations that differ by less fit equally well: the nearer one is
// taken. Mean square, px^2.
constexpr double kSameError = 1e-6;
// Ends lie within this many times the root mean square.
constexpr double kEnds = 3.0;

// As LineMoments::Fit, times n^2, and without a root or a division that only
// the best of many lines needs.
struct ScaledFit {
  explicit ScaledFit(const LineMoments& m) {
    const double a = m.n * m.xx - m.x * m.x;
    const double b = m.n * m.xy - m.x * m.y;
    const double c = m.n * m.yy - m.y * m.y;
    const double half = 0.5 * (a - c);
    const double root = std::sqrt(half * half + b * b);
    across = 0.5 * (a + c) - root;
    dx = half >= 0.0 ? root + half : b;
    dy = half >= 0.0 ? b : root - half;
  }
  [[nodiscard]] double SquaredLength() const { return dx * dx + dy * dy; }
  // Of length 1, on the side of `ahead`.
  [[nodiscard]] Eigen::Vector2f Direction(const Eigen::Vector2f& ahead) const {
    const bool is_back = dx * static_cast<double>(ahead.x()) +
                             dy * static_cast<double>(ahead.y()) <
                         0.0;
    const auto length = static_cast<float>(std::sqrt(SquaredLength()));
    return Eigen::Vector2f(static_cast<float>(dx), static_cast<float>(dy)) *
           ((is_back ? -1.0f : 1.0f) / length);
  }

  double across;
  double dx;  // Along the line, of any length.
  double dy;
};

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
  const float cell_px = std::max(
      static_cast<float>(kTileSide),
      std::ceil(std::hypot(static_cast<float>(options.max_gap_px), kSidePx)));
  cells_per_px_ = 1.0f / cell_px;
}

void SegmentMerger::Pieces::Resize(std::size_t num) {
  // What follows the last is looked at with it.
  for (auto* values : {&ax, &ay, &bx, &by}) values->resize(num + kPieceLanes);
  part.resize(num);
}

// The pieces of three cells side by side follow each other.
void SegmentMerger::FillCells(const LineParts& parts, int width, int height) {
  const std::size_t num_parts = parts.parts.size();
  num_columns_ = CellOf(static_cast<float>(width)) + 1;
  num_rows_ = CellOf(static_cast<float>(height)) + 1;
  first_.assign(static_cast<std::size_t>(num_columns_) *
                        static_cast<std::size_t>(num_rows_) +
                    1,
                0);
  entries_of_.resize(num_parts);
  const auto put = [&](std::size_t at, std::size_t i) {
    const LinePart& part = parts.parts[i];
    pieces_.ax[at] = part.a.x();
    pieces_.ay[at] = part.a.y();
    pieces_.bx[at] = part.b.x();
    pieces_.by[at] = part.b.y();
    pieces_.part[at] = static_cast<std::int32_t>(i);
    return static_cast<std::int32_t>(at);
  };
  if (!parts.tiles.empty() && AreTilesCells()) {
    // Tiles are cells, and in order.
    pieces_.Resize(num_parts);
    for (std::size_t i = 0; i < num_parts; ++i) {
      const TilePixels& tile = parts.tiles[i];
      ++first_[static_cast<std::size_t>(tile.y / kTileSide * num_columns_ +
                                        tile.x / kTileSide + 1)];
      entries_of_[i].fill(put(i, i));
    }
    std::inclusive_scan(first_.begin(), first_.end(), first_.begin());
    return;
  }
  // By counting; a piece is in the cells of both its ends.
  const auto cell_of = [&](const Eigen::Vector2f& p) {
    return static_cast<std::size_t>(CellOf(p.y()) * num_columns_ +
                                    CellOf(p.x()));
  };
  for (const LinePart& part : parts.parts) {
    const std::size_t a = cell_of(part.a);
    const std::size_t b = cell_of(part.b);
    ++first_[a];
    if (a != b) ++first_[b];
  }
  std::int32_t sum = 0;
  for (std::int32_t& first : first_) {
    sum += first;
    first = sum;
  }
  pieces_.Resize(static_cast<std::size_t>(sum));
  // From the back, so that pieces of a cell keep their order.
  for (std::size_t i = num_parts; i-- > 0;) {
    const std::size_t a = cell_of(parts.parts[i].a);
    const std::size_t b = cell_of(parts.parts[i].b);
    entries_of_[i].fill(put(static_cast<std::size_t>(--first_[a]), i));
    if (a == b) continue;
    entries_of_[i][1] = put(static_cast<std::size_t>(--first_[b]), i);
  }
}

bool SegmentMerger::AreTilesCells() const {
  return cells_per_px_ * kTileSide == 1.0f;
}

int SegmentMerger::CellOf(float value) const {
  return static_cast<int>(value * cells_per_px_);
}

void SegmentMerger::Use(std::size_t part) {
  is_used_[part] = 1;
  for (const std::int32_t entry : entries_of_[part]) {
    pieces_.ax[static_cast<std::size_t>(entry)] =
        std::numeric_limits<float>::quiet_NaN();
  }
}

void SegmentMerger::Consider(const LineParts& parts,
                             std::int32_t code,
                             Continuation* best) {
  if (parts.is_directed && (code % 2 == 1) != trace_.is_turned) return;
  const LinePart& part = parts.parts[static_cast<std::size_t>(code / 2)];
  LineMoments sum = trace_.moments;
  sum += part.moments;
  const ScaledFit fit(sum);
  const double nn = sum.n * sum.n;
  if (fit.across > (best->least + kSameError) * nn) return;
  const double end_limit = kEnds * options_.max_rms_px;
  const double limit = end_limit * end_limit * nn * fit.SquaredLength();
  const auto is_off = [&](const Eigen::Vector2f& p) {
    const double offset =
        fit.dx * (sum.n * static_cast<double>(p.y()) - sum.y) -
        fit.dy * (sum.n * static_cast<double>(p.x()) - sum.x);
    return offset * offset > limit;
  };
  if (is_off(part.a) || is_off(part.b) || is_off(trace_.b)) return;
  const Eigen::Vector2f& near = code % 2 == 1 ? part.b : part.a;
  const float step = trace_.direction.dot(near - trace_.b);
  const bool is_better = fit.across < (best->least - kSameError) * nn;
  if (best->code >= 0 && !is_better && step >= best->step) return;
  best->code = code;
  best->step = step;
  best->moments = sum;
  best->least = std::max(0.0, fit.across) / nn;
  best->direction = fit.Direction(trace_.direction);
}

bool SegmentMerger::Extend(const LineParts& parts) {
  Continuation best;
  best.least = options_.max_rms_px * options_.max_rms_px;
  const float x = trace_.b.x();
  const float y = trace_.b.y();
  // Only pieces that begin in the cell of the trace's end, or beside it, are
  // near enough. The first checks are cheap, as most of them fail.
  const int column = CellOf(x);
  const int row = CellOf(y);
  const int left = std::max(0, column - 1);
  const int right = std::min(num_columns_ - 1, column + 1);
  const int top = std::max(first_row_, row - 1);
  const int bottom = std::min(num_rows_ - 1, row + 1);
  const LineEnd line{x,
                     y,
                     trace_.direction.x(),
                     trace_.direction.y(),
                     -kOverlapPx,
                     static_cast<float>(options_.max_gap_px),
                     kSidePx,
                     kTurn};
  const PieceEnds ends{pieces_.ax.data(),
                       pieces_.ay.data(),
                       pieces_.bx.data(),
                       pieces_.by.data()};
  const PieceRows rows{first_.data() + top * num_columns_ + left,
                       num_columns_,
                       right + 1 - left,
                       bottom + 1 - top};
  const std::int32_t* last = find_near_(ends, rows, line, near_.data());
  for (const std::int32_t* it = near_.data(); it != last; ++it) {
    const std::int32_t part = pieces_.part[static_cast<std::size_t>(*it / 2)];
    Consider(parts, 2 * part + *it % 2, &best);
  }
  if (best.code < 0) return false;
  const auto index = static_cast<std::size_t>(best.code / 2);
  const LinePart& part = parts.parts[index];
  trace_.moments = best.moments;
  trace_.direction = best.direction;
  trace_.ahead.push_back(best.code);
  trace_.b = best.code % 2 == 1 ? part.a : part.b;
  Use(index);
  return true;
}

// Afterwards b is the other end.
void SegmentMerger::Turn() {
  std::swap(trace_.a, trace_.b);
  std::swap(trace_.ahead, trace_.behind);
  trace_.direction = -trace_.direction;
  trace_.is_turned = !trace_.is_turned;
}

void SegmentMerger::AppendListed(const LineParts& parts,
                                 std::vector<Eigen::Vector2f>* pixels) const {
  const auto append = [&](std::int32_t end, bool is_back) {
    const LinePart& part = parts.parts[static_cast<std::size_t>(end / 2)];
    const Eigen::Vector2f* first = parts.pixels.data() + part.first_pixel;
    if ((end % 2 == 1) != is_back) {
      pixels->insert(pixels->end(),
                     std::make_reverse_iterator(first + part.num_pixels),
                     std::make_reverse_iterator(first));
    } else {
      pixels->insert(pixels->end(), first, first + part.num_pixels);
    }
  };
  for (auto it = trace_.behind.rbegin(); it != trace_.behind.rend(); ++it) {
    append(*it, true);
  }
  for (const std::int32_t end : trace_.ahead) append(end, false);
}

void SegmentMerger::AppendTiles(const LineParts& parts,
                                const Eigen::Vector2f& direction,
                                std::vector<Eigen::Vector2f>* pixels) const {
  std::size_t num = 0;
  for (const auto* codes : {&trace_.behind, &trace_.ahead}) {
    for (const std::int32_t code : *codes) {
      num += static_cast<std::size_t>(
          parts.parts[static_cast<std::size_t>(code / 2)].num_pixels);
    }
  }
  const std::size_t begin = pixels->size();
  pixels->resize(begin + num + kMostListed);
  Eigen::Vector2f* out = pixels->data() + begin;
  const TileOrder order(direction);
  const auto append = [&](std::int32_t code) {
    const auto part = static_cast<std::size_t>(code / 2);
    out = order.List(
        parts.tiles[part], parts.parts[part].num_pixels, list_pixels_, out);
  };
  std::for_each(trace_.behind.rbegin(), trace_.behind.rend(), append);
  std::for_each(trace_.ahead.begin(), trace_.ahead.end(), append);
  pixels->resize(begin + num);
}

// Nearly sorted already: an insertion sort takes few steps.
void SegmentMerger::SortAlong(const Eigen::Vector2f& direction,
                              Eigen::Vector2f* pixels,
                              std::size_t num) {
  places_.resize(num);
  const float dx = direction.x();
  const float dy = direction.y();
  float* places = places_.data();
  for (std::size_t i = 0; i < num; ++i) {
    places[i] = dx * pixels[i].x() + dy * pixels[i].y();
  }
  int num_back = 0;
  for (std::size_t i = 1; i < num; ++i) {
    num_back += places[i] < places[i - 1] ? 1 : 0;
  }
  if (num_back == 0) return;
  for (std::size_t i = 1; i < num; ++i) {
    const float place = places[i];
    if (place >= places[i - 1]) continue;
    const Eigen::Vector2f pixel = pixels[i];
    std::size_t at = i;
    for (; at > 0 && places[at - 1] > place; --at) {
      places[at] = places[at - 1];
      pixels[at] = pixels[at - 1];
    }
    places[at] = place;
    pixels[at] = pixel;
  }
}

void SegmentMerger::Emit(const LineParts& parts, LineSet* set) {
  // Pixels of the pieces may reach a little beyond the ends of the trace.
  const float least =
      static_cast<float>(options_.min_length_px) - 2.0f * kOverlapPx;
  if (least > 0.0f && (trace_.b - trace_.a).squaredNorm() < least * least) {
    return;
  }
  LineSegment segment;
  segment.first_pixel = static_cast<std::int32_t>(set->pixels.size());
  LineFit fit = trace_.moments.Fit();
  const Eigen::Vector2d along = trace_.direction.cast<double>();
  if (fit.direction.dot(along) < 0.0) fit.direction = -fit.direction;
  const Eigen::Vector2f d = fit.direction.cast<float>();
  if (parts.tiles.empty()) {
    AppendListed(parts, &set->pixels);
  } else {
    AppendTiles(parts, d, &set->pixels);
  }
  segment.num_pixels =
      static_cast<std::int32_t>(set->pixels.size()) - segment.first_pixel;
  const auto begin = set->pixels.begin() + segment.first_pixel;
  SortAlong(d, &*begin, static_cast<std::size_t>(segment.num_pixels));
  const double first = fit.Along(begin->cast<double>());
  const double last = fit.Along(set->pixels.back().cast<double>());
  if (last - first < options_.min_length_px) {
    set->pixels.resize(static_cast<std::size_t>(segment.first_pixel));
    return;
  }
  segment.a = fit.mean + first * fit.direction;
  segment.b = fit.mean + last * fit.direction;
  SetSegmentErrors(fit.across, last - first, &segment);
  set->segments.push_back(segment);
}

LineSet SegmentMerger::Merge(const LineParts& parts, int width, int height) {
  LineSet set;
  set.has_polarity = parts.is_directed;
  if (parts.parts.empty()) return set;
  std::size_t num_pixels = 0;
  for (const LinePart& part : parts.parts) {
    num_pixels += static_cast<std::size_t>(part.num_pixels);
  }
  set.pixels.reserve(num_pixels + kMostListed);
  FillCells(parts, width, height);
  near_.resize(pieces_.part.size());
  is_used_.assign(parts.parts.size(), 0);
  const bool is_ordered = !parts.tiles.empty() && AreTilesCells();
  has_unused_.assign(static_cast<std::size_t>(num_rows_), 0);
  for (std::size_t i = 0; i < parts.parts.size(); ++i) {
    const LinePart& part = parts.parts[i];
    if (is_used_[i] != 0) continue;
    const int row = CellOf(part.a.y());
    const ScaledFit fit(part.moments);
    if (!(fit.SquaredLength() > 0.0)) {
      // A square, say: it has no direction, and only continues others.
      has_unused_[static_cast<std::size_t>(row)] = 1;
      continue;
    }
    Use(i);
    trace_.moments = part.moments;
    trace_.direction = fit.Direction(part.b - part.a);
    // Of tiles, in order, all other pieces above are used.
    first_row_ = is_ordered ? row : 0;
    while (first_row_ > 0 &&
           has_unused_[static_cast<std::size_t>(first_row_ - 1)] != 0) {
      --first_row_;
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
void SetSegmentErrors(double across, double length, LineSegment* segment) {
  const double num = std::max(1.0, segment->num_pixels / kPixelsOfOneError);
  const double error = across / num;
  segment->sigma_px = std::sqrt(error + kOffsetFloorPx * kOffsetFloorPx);
  segment->sigma_rad = std::sqrt(12.0 * (error + kTurnFloorPx * kTurnFloorPx)) /
                       std::max(1.0, length);
}

}  // namespace waymark
