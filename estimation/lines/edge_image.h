// Edge pixels of a grey image, with their gradients.
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace waymark {

struct EdgeRowLoops;

enum class EdgeSuppression {
  // A pixel survives where it is steepest of itself and its two horizontal or
  // two vertical neighbours, by the larger part of its gradient: no diagonals,
  // hence thinner edges [1].
  kTwoAxes,
  // Horizontal, vertical and both diagonals [2].
  kFourDirections,
};

struct EdgeImageOptions {
  EdgeSuppression suppression = EdgeSuppression::kTwoAxes;
  // Of |dx| + |dy| of the smoothed image, grey levels a pixel: an upright step
  // of 1 has 0.31. Edges are above `low` and touch, over others of that kind,
  // one above `high`. Up to 250.
  double low = 1.5;
  double high = 3.0;
  // Whether AVX2 may be used; the result is the same.
  bool wide = true;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Gradients are in units of 1/128 grey level a pixel. Rows of the bits begin
// at whole words; pixel x is bit x % 64 of word x / 64, and bits beyond the
// width are 0.
struct EdgeImage {
  int width = 0;
  int height = 0;
  int num_words = 0;  // A row.
  int stride = 0;     // Of the gradients, at least the width.
  std::vector<std::uint64_t> bits;
  std::vector<std::int16_t> dx;
  std::vector<std::int16_t> dy;

  [[nodiscard]] bool IsEdge(int x, int y) const {
    return (bits[WordOf(x / 64, y)] >> (x % 64) & 1) != 0;
  }
  [[nodiscard]] std::size_t WordOf(int word, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(num_words) +
           static_cast<std::size_t>(word);
  }
  [[nodiscard]] std::size_t IndexOf(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride) +
           static_cast<std::size_t>(x);
  }
  // |dx| + |dy|; 0 outside.
  [[nodiscard]] int Magnitude(int x, int y) const;
  // Of the crest of the magnitude from (x, y) along the axis of the larger
  // part of the gradient, by a parabola, in [-0.5, 0.5] px.
  [[nodiscard]] float CrestOffset(int x, int y) const;
  // 255 on edges, 0 elsewhere.
  [[nodiscard]] cv::Mat1b ToMat() const;
};

// The bits of a map (not 0: edge) without gradients: dx and dy are empty.
void SetEdgeBits(const cv::Mat1b& map, EdgeImage* edges);

// Finds the edges of images, one after another, and keeps the memory. The
// image is smoothed by 1 4 6 4 1 both ways and differentiated by Sobel's
// operator; its border is repeated outward, gradients there are as others.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009, section III.A.
// [2] J. Canny. A computational approach to edge detection. PAMI 8, 1986.
class EdgeDetector {
 public:
  explicit EdgeDetector(const EdgeImageOptions& options = {});

  // Any size, none included; at most 2^15 - 1 pixels a side (throws
  // std::invalid_argument). Valid until the next call. 0.5 ms for 640 x 480.
  const EdgeImage& Detect(const cv::Mat1b& image);

 private:
  void Prepare(const cv::Mat1b& image);
  void SmoothRow(const cv::Mat1b& image, int y);
  void DifferentiateRow(int y);
  void SuppressRow(int y);
  // Keeps what touches a strong edge.
  void Follow();
  bool FollowRow(int y);

  EdgeImageOptions options_;
  const EdgeRowLoops* loops_;
  EdgeImage edges_;
  std::vector<std::uint16_t> column_;
  std::vector<std::int16_t> smooth_;     // Rows y % 3.
  std::vector<std::int16_t> magnitude_;  // Rows y % 3, then one of zeros.
  std::vector<std::uint8_t> marks_;
  std::vector<std::uint64_t> candidates_;
  std::vector<int> waiting_;
  std::vector<char> is_waiting_;
};

}  // namespace waymark
