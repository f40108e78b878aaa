#include "estimation/lines/edge_image.h"

#include "estimation/lines/edge_rows.h"
#include "estimation/lines/tile_words.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>

namespace waymark {
namespace {

// Units of the gradient in a grey level a pixel: 16 of the smoothing, 8 of
// Sobel's operator.
constexpr double kUnit = 128.0;
// Around a row buffer, so that its loops may look two pixels to each side.
constexpr int kPad = 16;

// Bits of `field` that a run of `seeds` reaches along the row. `seeds` lie in
// `field`. An addition carries a seed to the upper end of its run.
std::uint64_t FillUp(std::uint64_t seeds, std::uint64_t field) {
  return field & ((field + seeds) ^ field);
}

std::uint64_t Reverse(std::uint64_t bits) {
  return __builtin_bswap64(ReverseRows(bits));
}

std::uint64_t Fill(std::uint64_t seeds, std::uint64_t field) {
  std::uint64_t filled = seeds | FillUp(seeds, field);
  filled |= Reverse(FillUp(Reverse(filled), Reverse(field)));
  return filled & field;
}

}  // namespace

void EdgeImageOptions::Check() const {
  const auto in_range = [](double value) {
    return value >= 0.0 && value <= 250.0;
  };
  if (!in_range(low)) throw std::invalid_argument("low must be in [0, 250]");
  if (!in_range(high) || high < low) {
    throw std::invalid_argument("high must be in [low, 250]");
  }
}

int EdgeImage::Magnitude(int x, int y) const {
  if (x < 0 || y < 0 || x >= width || y >= height) return 0;
  const std::size_t i = IndexOf(x, y);
  return std::abs(dx[i]) + std::abs(dy[i]);
}

float EdgeImage::CrestOffset(int x, int y) const {
  const std::size_t i = IndexOf(x, y);
  const bool is_along = std::abs(dx[i]) >= std::abs(dy[i]);
  const int step_x = is_along ? 1 : 0;
  const int step_y = is_along ? 0 : 1;
  const int before = Magnitude(x - step_x, y - step_y);
  const int after = Magnitude(x + step_x, y + step_y);
  const int bend = 2 * Magnitude(x, y) - before - after;
  if (bend <= 0) return 0.0f;
  return std::clamp(
      0.5f * static_cast<float>(after - before) / static_cast<float>(bend),
      -0.5f,
      0.5f);
}

cv::Mat1b EdgeImage::ToMat() const {
  cv::Mat1b map(height, width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) map(y, x) = IsEdge(x, y) ? 255 : 0;
  }
  return map;
}

void SetEdgeBits(const cv::Mat1b& map, EdgeImage* edges) {
  edges->width = map.cols;
  edges->height = map.rows;
  edges->num_words = (map.cols + 63) / 64;
  edges->stride = 0;
  edges->dx.clear();
  edges->dy.clear();
  edges->bits.assign(edges->WordOf(0, map.rows), 0);
  static const EdgeRowLoops& loops = *EdgeRowLoopsVariants().back();
  for (int y = 0; y < map.rows; ++y) {
    const std::uint8_t* row = map.ptr(y);
    std::uint64_t* bits =
        edges->bits.data() + static_cast<std::ptrdiff_t>(y) * edges->num_words;
    const int num_full = map.cols / 64;
    loops.pack_not_zero(row, num_full, bits);
    for (int x = 64 * num_full; x < map.cols; ++x) {
      if (row[x] != 0) bits[x >> 6] |= std::uint64_t{1} << (x & 63);
    }
  }
}

EdgeDetector::EdgeDetector(const EdgeImageOptions& options)
    : options_(options) {
  options.Check();
  const auto variants = EdgeRowLoopsVariants();
  loops_ = options.wide ? variants.back() : variants.front();
}

void EdgeDetector::Prepare(const cv::Mat1b& image) {
  constexpr int kMostPixels = (1 << 15) - 1;
  if (image.cols > kMostPixels || image.rows > kMostPixels) {
    throw std::invalid_argument(
        "an image for edges has at most 32767 pixels "
        "a side");
  }
  edges_.width = image.cols;
  edges_.height = image.rows;
  edges_.num_words = (image.cols + 63) / 64;
  edges_.stride = (image.cols + kPad - 1) / kPad * kPad;
  const std::size_t num_pixels = static_cast<std::size_t>(edges_.stride) *
                                 static_cast<std::size_t>(image.rows);
  edges_.dx.resize(num_pixels);
  edges_.dy.resize(num_pixels);
  const std::size_t num_words = static_cast<std::size_t>(edges_.num_words) *
                                static_cast<std::size_t>(image.rows);
  edges_.bits.resize(num_words);
  candidates_.resize(num_words);
  const std::size_t row = static_cast<std::size_t>(edges_.stride) + 2 * kPad;
  column_.resize(row);
  smooth_.resize(3 * row);
  magnitude_.assign(4 * row, 0);
  marks_.assign(64 * edges_.WordOf(0, 1), 0);
}

void EdgeDetector::SmoothRow(const cv::Mat1b& image, int y) {
  const EdgeRowLoops& loops = *loops_;
  const int n = image.cols;
  const int last = image.rows - 1;
  const std::array<const std::uint8_t*, 5> rows{
      image.ptr(std::clamp(y - 2, 0, last)),
      image.ptr(std::clamp(y - 1, 0, last)),
      image.ptr(std::clamp(y, 0, last)),
      image.ptr(std::clamp(y + 1, 0, last)),
      image.ptr(std::clamp(y + 2, 0, last))};
  std::uint16_t* column = column_.data() + kPad;
  loops.smooth_down(rows.data(), n, column);
  std::fill_n(column - 2, 2, column[0]);
  std::fill_n(column + n, 2, column[n - 1]);
  std::int16_t* smooth =
      smooth_.data() +
      static_cast<std::ptrdiff_t>(y % 3) * (edges_.stride + 2 * kPad) + kPad;
  loops.smooth_along(column, n, smooth);
  smooth[-1] = smooth[0];
  smooth[n] = smooth[n - 1];
}

void EdgeDetector::DifferentiateRow(int y) {
  const EdgeRowLoops& loops = *loops_;
  const std::ptrdiff_t stride = edges_.stride + 2 * kPad;
  const auto smooth = [&](int row) {
    return smooth_.data() + std::clamp(row, 0, edges_.height - 1) % 3 * stride +
           kPad;
  };
  const std::array<const std::int16_t*, 3> rows{
      smooth(y - 1), smooth(y), smooth(y + 1)};
  const std::size_t first = edges_.IndexOf(0, y);
  loops.differentiate(rows.data(),
                      edges_.width,
                      {edges_.dx.data() + first,
                       edges_.dy.data() + first,
                       magnitude_.data() + y % 3 * stride + kPad});
}

void EdgeDetector::SuppressRow(int y) {
  const EdgeRowLoops& loops = *loops_;
  const std::ptrdiff_t stride = edges_.stride + 2 * kPad;
  // Outside the image nothing is steep.
  const auto magnitude = [&](int row) {
    const bool is_inside = row >= 0 && row < edges_.height;
    return magnitude_.data() + (is_inside ? row % 3 : 3) * stride + kPad;
  };
  const std::size_t first = edges_.IndexOf(0, y);
  const SuppressionRow row{magnitude(y - 1),
                           magnitude(y),
                           magnitude(y + 1),
                           edges_.dx.data() + first,
                           edges_.dy.data() + first,
                           static_cast<std::int16_t>(options_.low * kUnit),
                           static_cast<std::int16_t>(options_.high * kUnit)};
  if (options_.suppression == EdgeSuppression::kTwoAxes) {
    loops.suppress_two_axes(row, edges_.width, marks_.data());
  } else {
    loops.suppress_four_directions(row, edges_.width, marks_.data());
  }
  for (int word = 0; word < edges_.num_words; ++word) {
    const std::uint8_t* marks = marks_.data() + 64 * word;
    const std::size_t at = edges_.WordOf(word, y);
    candidates_[at] = PackBit<0>(marks);
    edges_.bits[at] = PackBit<1>(marks);
  }
}

// What the rows above and below reach, then along the row. Words pass their
// ends on to the right first, then to the left.
bool EdgeDetector::FollowRow(int y) {
  const int n = edges_.num_words;
  const std::uint64_t* field =
      candidates_.data() + static_cast<std::ptrdiff_t>(y) * n;
  std::uint64_t* row = edges_.bits.data() + static_cast<std::ptrdiff_t>(y) * n;
  const std::uint64_t* above = y > 0 ? row - n : row;
  const std::uint64_t* below = y + 1 < edges_.height ? row + n : row;
  const auto reach = [&](int word) {
    return above[word] | row[word] | below[word];
  };
  bool has_changed = false;
  std::uint64_t before = 0;  // Reach of the word before.
  for (int word = 0; word < n; ++word) {
    const std::uint64_t here = reach(word);
    const std::uint64_t after = word + 1 < n ? reach(word + 1) : 0;
    const std::uint64_t wide =
        here | here << 1 | here >> 1 | before >> 63 | after << 63;
    const std::uint64_t seeds = wide & field[word];
    if (seeds != row[word]) {
      const std::uint64_t filled = Fill(seeds | row[word], field[word]);
      has_changed |= filled != row[word];
      row[word] = filled;
    }
    before = reach(word);
  }
  for (int word = n - 2; word >= 0; --word) {
    const std::uint64_t seeds =
        row[word] | ((row[word + 1] << 63) & field[word]);
    if (seeds == row[word]) continue;
    row[word] = Fill(seeds, field[word]);
    has_changed = true;
  }
  return has_changed;
}

// Down, up, and then only rows beside one that has changed. A row changes at
// most as often as it has pixels, so this ends.
void EdgeDetector::Follow() {
  const int n = edges_.height;
  waiting_.clear();
  is_waiting_.assign(static_cast<std::size_t>(n), 0);
  const auto wait = [&](int y) {
    if (y < 0 || y >= n || is_waiting_[static_cast<std::size_t>(y)]) return;
    is_waiting_[static_cast<std::size_t>(y)] = 1;
    waiting_.push_back(y);
  };
  for (int y = 0; y < n; ++y) FollowRow(y);
  for (int y = n - 1; y >= 0; --y) {
    if (FollowRow(y)) wait(y + 1);
  }
  while (!waiting_.empty()) {
    const int y = waiting_.back();
    waiting_.pop_back();
    is_waiting_[static_cast<std::size_t>(y)] = 0;
    if (!FollowRow(y)) continue;
    wait(y + 1);
    wait(y - 1);
  }
}

const EdgeImage& EdgeDetector::Detect(const cv::Mat1b& image) {
  Prepare(image);
  if (image.empty()) return edges_;
  const int n = image.rows;
  // Each step runs one row behind the one before, on rows still in the cache.
  for (int y = 0; y < n + 2; ++y) {
    if (y < n) SmoothRow(image, y);
    if (y >= 1 && y <= n) DifferentiateRow(y - 1);
    if (y >= 2) SuppressRow(y - 2);
  }
  Follow();
  return edges_;
}

}  // namespace waymark
