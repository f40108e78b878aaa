#include "drivers/simulator/texture_sampler.h"

#include "drivers/simulator/srgb.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

constexpr int kFieldMask = TextureSampler::kFieldMask;
constexpr int kFieldBits = TextureSampler::kFieldBits;

std::uint32_t Pack(const cv::Vec3f& linear) {
  std::uint32_t packed = 0;
  for (int c = 0; c < 3; ++c) {
    const float root = std::sqrt(std::clamp(linear[c], 0.0f, 1.0f));
    const auto field = static_cast<std::uint32_t>(
        root * static_cast<float>(kFieldMask) + 0.5f);
    packed |= field << (kFieldBits * c);
  }
  return packed;
}

inline Float4 Unpack(std::uint32_t packed) {
  const auto bits = static_cast<std::int32_t>(packed);
  const Int4 fields =
      Int4{bits, bits, bits, bits} & Int4{kFieldMask,
                                          kFieldMask << kFieldBits,
                                          kFieldMask << (2 * kFieldBits),
                                          0};
  constexpr float kUnit = 1.0f / static_cast<float>(kFieldMask);
  constexpr float kUp10 = kUnit / 1024.0f;
  constexpr float kUp20 = kUp10 / 1024.0f;
  const Float4 root =
      __builtin_convertvector(fields, Float4) * Float4{kUnit, kUp10, kUp20, 0};
  return root * root;
}

// Keeps coordinates where an int holds them; NaN becomes the lower bound.
inline float Bounded(float value) {
  constexpr float kLargest = 1e6f;
  const float low = value > -kLargest ? value : -kLargest;
  return low < kLargest ? low : kLargest;
}

inline float Fraction(float value) {
  return value - static_cast<float>(FloorToInt(value));
}

cv::Mat3f Linear(const cv::Mat3b& image) {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = LinearFromSrgb(static_cast<std::uint8_t>(i));
  }
  cv::Mat3f linear(image.size());
  for (int y = 0; y < image.rows; ++y) {
    const std::uint8_t* from = image.ptr<std::uint8_t>(y);
    float* to = linear.ptr<float>(y);
    for (int i = 0; i < 3 * image.cols; ++i) to[i] = table[from[i]];
  }
  return linear;
}

}  // namespace

TextureSampler::TextureSampler(const cv::Mat3b& image) {
  if (image.empty()) throw std::invalid_argument("texture: it is empty");
  // So that indices of texels fit into 31 bits, mip-maps included.
  constexpr std::size_t kMostPixels = std::size_t{1} << 28;
  if (image.total() > kMostPixels) {
    throw std::invalid_argument("texture: it has more than 2^28 pixels");
  }
  cv::Mat3f linear = Linear(image);
  AppendLevel(linear);
  while (linear.cols > 1 || linear.rows > 1) {
    cv::Mat3f half;
    cv::resize(linear,
               half,
               {std::max(1, linear.cols / 2), std::max(1, linear.rows / 2)},
               0.0,
               0.0,
               cv::INTER_AREA);
    linear = half;
    AppendLevel(linear);
  }
  const cv::Vec3f last = linear(0, 0);
  mean_ = Float4{last[0], last[1], last[2], 0.0f};
}

void TextureSampler::AppendLevel(const cv::Mat3f& linear) {
  levels_.width[levels_.num] = linear.cols;
  levels_.height[levels_.num] = linear.rows;
  levels_.first[levels_.num] = static_cast<int>(texels_.size());
  ++levels_.num;
  const auto stride = static_cast<std::size_t>(linear.cols) + 1;
  const std::size_t first = texels_.size();
  texels_.resize(first + stride * (static_cast<std::size_t>(linear.rows) + 1));
  std::uint32_t* to = texels_.data() + first;
  for (int y = 0; y < linear.rows; ++y) {
    const cv::Vec3f* row = linear.ptr<cv::Vec3f>(y);
    for (int x = 0; x < linear.cols; ++x) *to++ = Pack(row[x]);
    *to++ = Pack(row[0]);
  }
  std::copy_n(texels_.data() + first, stride, to);
}

std::size_t TextureSampler::num_bytes() const {
  return texels_.size() * sizeof(texels_[0]);
}

inline Float4 TextureSampler::Bilinear(int level, float u, float v) const {
  const int width = levels_.width[level];
  const int height = levels_.height[level];
  // Texel centres are at half numbers; u and v are in [0, 1].
  const float x = u * static_cast<float>(width) - 0.5f;
  const float y = v * static_cast<float>(height) - 0.5f;
  int x0 = FloorToInt(x);
  int y0 = FloorToInt(y);
  const Float4 fx = Broadcast(x - static_cast<float>(x0));
  const Float4 fy = Broadcast(y - static_cast<float>(y0));
  x0 = x0 < 0 ? width - 1 : std::min(x0, width - 1);
  y0 = y0 < 0 ? height - 1 : std::min(y0, height - 1);
  const int stride = width + 1;
  const std::uint32_t* top =
      texels_.data() + levels_.first[level] + y0 * stride + x0;
  const std::uint32_t* bottom = top + stride;
  const Float4 a = Unpack(top[0]);
  const Float4 b = Unpack(top[1]);
  const Float4 c = Unpack(bottom[0]);
  const Float4 d = Unpack(bottom[1]);
  const Float4 upper = a + fx * (b - a);
  const Float4 lower = c + fx * (d - c);
  return upper + fy * (lower - upper);
}

inline Float4 TextureSampler::Trilinear(float level, float u, float v) const {
  u = Fraction(u);
  v = Fraction(v);
  if (level <= 0.0f) return Bilinear(0, u, v);
  const auto finer = static_cast<int>(level);
  if (finer >= levels_.num - 1) return mean_;
  const float share = (level - static_cast<float>(finer) - kPureLevel) /
                      (1.0f - 2.0f * kPureLevel);
  if (share <= 0.0f) return Bilinear(finer, u, v);
  if (share >= 1.0f) return Bilinear(finer + 1, u, v);
  const Float4 fine = Bilinear(finer, u, v);
  const Float4 coarse = Bilinear(finer + 1, u, v);
  return fine + Broadcast(share) * (coarse - fine);
}

Float4 TextureSampler::Sample(float u,
                              float v,
                              const TextureFootprint& footprint,
                              int max_probes) const {
  if (levels_.num == 1) return mean_;
  u = Bounded(u);
  v = Bounded(v);
  const auto width = static_cast<float>(levels_.width[0]);
  const auto height = static_cast<float>(levels_.height[0]);
  const float ux = footprint.du_dx * width;
  const float vx = footprint.dv_dx * height;
  const float uy = footprint.du_dy * width;
  const float vy = footprint.dv_dy * height;
  const float square_x = ux * ux + vx * vx;
  const float square_y = uy * uy + vy * vy;
  const bool is_x_longer = square_x > square_y;
  const float longer = is_x_longer ? square_x : square_y;
  // Not even one texel: nothing to filter. NaN ends here too.
  if (!(longer > 1.0f)) return Trilinear(0.0f, u, v);
  if (longer > 1e12f) return mean_;  // Wider than any texture.
  // The pixel's area over its length is its width, however it is skewed.
  const float area = std::abs(ux * vy - uy * vx);
  const float narrower = std::max(area * area / longer, 1.0f);  // Squared.
  int num_probes = 1;
  while (num_probes < max_probes &&
         longer > static_cast<float>(num_probes * num_probes) * kProbeSpacing *
                      kProbeSpacing * narrower) {
    ++num_probes;
  }
  const float per_probe = 1.0f / static_cast<float>(num_probes);
  // Texels as wide as the pixel; wider only where the probes do not suffice.
  const float spaced =
      longer * per_probe * per_probe / (kProbeSpacing * kProbeSpacing);
  const float level = 0.5f * RoughLog2(std::max(narrower, spaced));
  if (num_probes == 1) return Trilinear(level, u, v);
  const float step_u =
      per_probe * (is_x_longer ? footprint.du_dx : footprint.du_dy);
  const float step_v =
      per_probe * (is_x_longer ? footprint.dv_dx : footprint.dv_dy);
  const float first = 0.5f * static_cast<float>(1 - num_probes);
  u += first * step_u;
  v += first * step_v;
  Float4 sum{};
  for (int i = 0; i < num_probes; ++i) {
    sum += Trilinear(level,
                     u + static_cast<float>(i) * step_u,
                     v + static_cast<float>(i) * step_v);
  }
  return sum * Broadcast(per_probe);
}

}  // namespace waymark
