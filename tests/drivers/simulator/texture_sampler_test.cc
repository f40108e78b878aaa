#include "drivers/simulator/texture_sampler.h"

#include "drivers/simulator/srgb.h"
#include "tests/support/box_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace waymark {
namespace {

TEST(Srgb, RoundTripOfAllValues) {
  const SrgbTable table;
  for (int i = 0; i < 256; ++i) {
    const auto value = static_cast<std::uint8_t>(i);
    EXPECT_EQ(table.FromLinear(LinearFromSrgb(value)), value);
  }
  EXPECT_EQ(table.FromLinear(-1.0f), 0);
  EXPECT_EQ(table.FromLinear(7.0f), 255);
  EXPECT_EQ(table.FromLinear(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(table.FromLinear(std::numeric_limits<float>::infinity()), 255);
  // IEC 61966-2-1: middle grey.
  EXPECT_NEAR(LinearFromSrgb(188), 0.5029f, 1e-3f);
}

cv::Mat3b AllGreys() {
  cv::Mat3b image(16, 16);
  for (int i = 0; i < 256; ++i) {
    const auto value = static_cast<std::uint8_t>(i);
    image(i / 16, i % 16) = {value, std::uint8_t(255 - i), value};
  }
  return image;
}

// Texels come out as they went in, at their centres and repetitions of them.
TEST(TextureSampler, KeepsEveryValueOfTexels) {
  const cv::Mat3b image = AllGreys();
  const TextureSampler sampler(image);
  const SrgbTable table;
  for (const float shift : {0.0f, -3.0f, 5.0f}) {
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) {
        const Float4 colour =
            sampler.Sample((static_cast<float>(x) + 0.5f) / 16.0f + shift,
                           (static_cast<float>(y) + 0.5f) / 16.0f - shift,
                           {},
                           8);
        EXPECT_EQ(table.FromLinear(colour[0]), image(y, x)[0]);
        EXPECT_EQ(table.FromLinear(colour[1]), image(y, x)[1]);
      }
    }
  }
}

TEST(TextureSampler, RepeatsWithoutASeam) {
  const TextureSampler sampler(AllGreys());
  for (const float v : {0.1f, 0.5f, 0.93f}) {
    const float tiny = 1e-6f;
    const Float4 left = sampler.Sample(-tiny, v, {}, 8);
    const Float4 right = sampler.Sample(tiny, v, {}, 8);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(left[c], right[c], 1e-3f);
  }
}

// Mean of points of the sampler's finest level over the pixel, a
// parallelogram.
Float4 BruteForce(const TextureSampler& sampler,
                  float u,
                  float v,
                  const TextureFootprint& f) {
  constexpr int kNum = 32;
  Float4 sum{};
  for (int i = 0; i < kNum; ++i) {
    for (int j = 0; j < kNum; ++j) {
      const float x = (static_cast<float>(i) + 0.5f) / kNum - 0.5f;
      const float y = (static_cast<float>(j) + 0.5f) / kNum - 0.5f;
      sum += sampler.Sample(
          u + x * f.du_dx + y * f.du_dy, v + x * f.dv_dx + y * f.dv_dy, {}, 1);
    }
  }
  return sum * Broadcast(1.0f / (kNum * kNum));
}

// Peak signal to noise of filtered samples against brute force, dB.
double Psnr(const TextureSampler& sampler, const TextureFootprint& footprint) {
  double squares = 0.0;
  constexpr int kNum = 12;
  for (int i = 0; i < kNum; ++i) {
    for (int j = 0; j < kNum; ++j) {
      const float u = 0.731f * static_cast<float>(i) / 7.0f;
      const float v = 0.417f * static_cast<float>(j) / 5.0f;
      const float error = sampler.Sample(u, v, footprint, 8)[1] -
                          BruteForce(sampler, u, v, footprint)[1];
      squares += static_cast<double>(error) * static_cast<double>(error);
    }
  }
  return -10.0 * std::log10(squares / (kNum * kNum));
}

TEST(TextureSampler, FiltersAsBruteForceDoes) {
  const TextureSampler sampler(Plaster(128, {128, 128, 128}, 3));
  const float texel = 1.0f / 128.0f;
  for (const float size : {0.5f, 1.0f, 2.0f, 11.0f, 40.0f}) {
    for (const float stretch : {1.0f, 3.0f, 7.0f}) {
      const float a = size * texel;
      const float b = size * stretch * texel;
      for (const float angle : {0.0f, 0.4f, 1.2f}) {
        const float c = std::cos(angle);
        const float s = std::sin(angle);
        const TextureFootprint footprint{a * c, a * s, -b * s, b * c};
        // Noise of all scales, the hardest texture; measured 46 to 58. Without
        // mip-maps it would be 25.
        EXPECT_GT(Psnr(sampler, footprint), 44.0)
            << size << ' ' << stretch << ' ' << angle;
      }
    }
  }
}

TEST(TextureSampler, FarAwayItIsTheMeanInLinearLight) {
  const TextureSampler sampler(Checkers(8, 4, {0, 0, 0}, {255, 255, 255}));
  const Float4 far = sampler.Sample(0.3f, 0.7f, {9.0f, 0.0f, 0.0f, 9.0f}, 8);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(far[c], 0.5f, 1e-3f);
}

TEST(TextureSampler, SurvivesAnyCoordinates) {
  const TextureSampler sampler(AllGreys());
  const float huge = std::numeric_limits<float>::max();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const float value : {huge, -huge, nan, inf, -inf, -1e6f, 1e-38f}) {
    for (const float size : {0.0f, 1e-3f, 1.0f, huge, inf, nan}) {
      const Float4 colour =
          sampler.Sample(value, -value, {size, -size, 0.0f, size}, 8);
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(colour[c], 0.0f);
        EXPECT_LE(colour[c], 1.0f);
      }
    }
  }
  EXPECT_THROW(TextureSampler{cv::Mat3b()}, std::invalid_argument);
}

TEST(TextureSampler, AnySizeOfTexture) {
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(1, 7), cv::Size(33, 5)}) {
    const TextureSampler sampler(cv::Mat3b(size, {10, 20, 30}));
    const SrgbTable table;
    for (const float footprint : {0.0f, 0.1f, 3.0f}) {
      const Float4 colour =
          sampler.Sample(0.2f, 0.9f, {footprint, 0.0f, 0.0f, footprint}, 8);
      EXPECT_EQ(table.FromLinear(colour[0]), 10);
      EXPECT_EQ(table.FromLinear(colour[2]), 30);
    }
  }
}

}  // namespace
}  // namespace waymark
