// Textures seen from any distance and angle, without aliasing.
#pragma once

#include "drivers/simulator/simd.h"

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <vector>

namespace waymark {

// How the texture's coordinates change from a pixel to the next one to the
// right (x) and below (y), in repetitions of the texture.
struct TextureFootprint {
  float du_dx = 0.0f;
  float dv_dx = 0.0f;
  float du_dy = 0.0f;
  float dv_dy = 0.0f;
};

// A texture with its mip-maps (each half the size of the one before, area
// filtered in linear light; sizes need not be powers of two), which repeats.
//
// A sample is the mean, in linear light, of trilinear probes along the longer
// axis of the footprint, as many as it is longer than the shorter one, up to
// `max_probes`; beyond that the texture blurs rather than aliases. Texels are
// kept as 10 bits of the square root of the light, finer than the sRGB curve
// of 8 bits: four bytes a texel, 5.3 with the mip-maps. The first column and
// row are there once more behind the last: neighbours are where they seem.
class TextureSampler {
 public:
  // 8-bit BGR, sRGB curve. Throws std::invalid_argument for an empty image and
  // for one of more than 2^28 pixels.
  explicit TextureSampler(const cv::Mat3b& image);

  // Linear BGR at (u, v) in repetitions, (0, 0) the corner of the top-left
  // texel. Coordinates beyond a million, or not finite, give some texel.
  [[nodiscard]] Float4 Sample(float u,
                              float v,
                              const TextureFootprint& footprint,
                              int max_probes) const;

  // Of the whole texture, linear BGR.
  [[nodiscard]] Float4 mean() const { return mean_; }
  [[nodiscard]] std::size_t num_bytes() const;

  // For the form of Sample that takes eight places at once.
  struct Levels {
    static constexpr int kMost = 32;  // Of a texture 2^31 wide.
    int num = 0;
    int width[kMost]{};
    int height[kMost]{};
    int first[kMost]{};  // Of its texels: height + 1 rows of width + 1.
  };
  static constexpr int kFieldBits = 10;  // Of a channel in a texel.
  static constexpr int kFieldMask = (1 << kFieldBits) - 1;
  // Interpolation between texels spreads each probe over more than one of
  // them: probes stand so much farther apart than the pixel is wide.
  static constexpr float kProbeSpacing = 1.5f;
  // So near a mip level that level alone counts: half the work, and still no
  // step from level to level.
  static constexpr float kPureLevel = 0.4f;
  [[nodiscard]] const Levels& levels() const { return levels_; }
  [[nodiscard]] const std::uint32_t* texels() const { return texels_.data(); }

 private:
  void AppendLevel(const cv::Mat3f& linear);
  [[nodiscard]] Float4 Bilinear(int level, float u, float v) const;
  [[nodiscard]] Float4 Trilinear(float level, float u, float v) const;

  Levels levels_;
  std::vector<std::uint32_t> texels_;
  Float4 mean_{};
};

}  // namespace waymark
