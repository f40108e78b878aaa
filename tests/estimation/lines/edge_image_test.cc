#include "estimation/lines/edge_image.h"

#include "estimation/base/random.h"
#include "estimation/lines/edge_rows.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

// Dark up to and including column `last`, bright after it.
cv::Mat1b UprightStep(int width, int height, int last) {
  cv::Mat1b image(height, width, std::uint8_t{50});
  image.colRange(last + 1, width).setTo(150);
  return image;
}

cv::Mat1b Noise(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat1b image(height, width);
  for (std::uint8_t& pixel : image) {
    pixel = static_cast<std::uint8_t>(random.Index(256));
  }
  cv::GaussianBlur(image, image, {}, 1.5);
  image.convertTo(image, CV_8U, 3.0, -250.0);
  return image;
}

TEST(EdgeImage, AStepIsOneColumnBetweenItsSides) {
  EdgeDetector detector;
  const EdgeImage& edges = detector.Detect(UprightStep(70, 9, 63));
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 70; ++x) {
      // Both sides of the step are equally steep; the left one is taken.
      EXPECT_EQ(edges.IsEdge(x, y), x == 63) << x << ", " << y;
    }
    EXPECT_GT(edges.dx[edges.IndexOf(63, y)], 0);
    EXPECT_EQ(edges.dy[edges.IndexOf(63, y)], 0);
    // The step is halfway between two columns.
    EXPECT_NEAR(edges.CrestOffset(63, y), 0.5f, 1e-3f);
  }
  // A step of 100 has 100 * (6 + 6 + 4) / 32 ... of the documented 0.31 each.
  EXPECT_NEAR(edges.dx[edges.IndexOf(63, 4)] / 128.0, 31.0, 0.5);
}

TEST(EdgeImage, TurnedImagesHaveTurnedEdges) {
  const cv::Mat1b image = Noise(90, 70, 3);
  cv::Mat1b turned;
  cv::transpose(image, turned);
  EdgeDetector a;
  EdgeDetector b;
  const EdgeImage& upright = a.Detect(image);
  const EdgeImage& lying = b.Detect(turned);
  int num = 0;
  int num_same = 0;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      EXPECT_EQ(upright.dx[upright.IndexOf(x, y)],
                lying.dy[lying.IndexOf(y, x)]);
      num += upright.IsEdge(x, y);
      num_same += upright.IsEdge(x, y) && lying.IsEdge(y, x);
    }
  }
  EXPECT_GT(num, 300);
  // Gradients at exactly 45 degrees are taken as along x both times.
  EXPECT_GT(num_same, 0.97 * num);
}

TEST(EdgeImage, WideAndPortableLoopsAgree) {
  for (const EdgeSuppression suppression :
       {EdgeSuppression::kTwoAxes, EdgeSuppression::kFourDirections}) {
    for (const int width : {1, 2, 15, 16, 17, 63, 64, 65, 131}) {
      EdgeImageOptions options;
      options.suppression = suppression;
      const cv::Mat1b image = Noise(width, 40, 7);
      EdgeDetector wide(options);
      options.wide = false;
      EdgeDetector portable(options);
      const EdgeImage& a = wide.Detect(image);
      const EdgeImage& b = portable.Detect(image);
      EXPECT_EQ(a.bits, b.bits) << width;
      for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < width; ++x) {
          ASSERT_EQ(a.dx[a.IndexOf(x, y)], b.dx[b.IndexOf(x, y)]);
          ASSERT_EQ(a.dy[a.IndexOf(x, y)], b.dy[b.IndexOf(x, y)]);
        }
      }
    }
  }
}

TEST(EdgeImage, BitsAreTheBytesThatAreNotZero) {
  Random random(SeedFor(9, "EdgeImage.Bits"));
  std::vector<std::uint8_t> bytes(64 * 9);
  for (std::uint8_t& byte : bytes) {
    byte = random.Uniform() < 0.5
               ? 0
               : static_cast<std::uint8_t>(1 << (random.Index(8)));
  }
  for (const EdgeRowLoops* loops : EdgeRowLoopsVariants()) {
    std::vector<std::uint64_t> bits(9);
    loops->pack_not_zero(bytes.data(), 9, bits.data());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      ASSERT_EQ(bits[i / 64] >> (i % 64) & 1, bytes[i] != 0 ? 1u : 0u);
    }
  }
}

// The definition, pixel by pixel: maxima above `low` that touch a strong one
// over others.
cv::Mat1b EdgesByDefinition(const EdgeImage& e, const EdgeImageOptions& o) {
  cv::Mat1b maxima(e.height, e.width, std::uint8_t{0});
  cv::Mat1b strong(e.height, e.width, std::uint8_t{0});
  for (int y = 0; y < e.height; ++y) {
    for (int x = 0; x < e.width; ++x) {
      const std::size_t i = e.IndexOf(x, y);
      const bool is_along = std::abs(e.dx[i]) >= std::abs(e.dy[i]);
      const int m = e.Magnitude(x, y);
      const int before =
          is_along ? e.Magnitude(x - 1, y) : e.Magnitude(x, y - 1);
      const int after =
          is_along ? e.Magnitude(x + 1, y) : e.Magnitude(x, y + 1);
      if (m <= 128.0 * o.low || m <= before || m < after) continue;
      maxima(y, x) = 255;
      if (m > 128.0 * o.high) strong(y, x) = 255;
    }
  }
  cv::Mat1i labels;
  const int num = cv::connectedComponents(maxima, labels, 8);
  std::vector<char> is_kept(static_cast<std::size_t>(num), 0);
  for (int y = 0; y < e.height; ++y) {
    for (int x = 0; x < e.width; ++x) {
      if (strong(y, x) != 0)
        is_kept[static_cast<std::size_t>(labels(y, x))] = 1;
    }
  }
  for (int y = 0; y < e.height; ++y) {
    for (int x = 0; x < e.width; ++x) {
      if (!is_kept[static_cast<std::size_t>(labels(y, x))]) maxima(y, x) = 0;
    }
  }
  return maxima;
}

TEST(EdgeImage, FollowsWeakEdgesAsFarAsTheyTouch) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    EdgeImageOptions options;
    options.low = 4.0;
    options.high = 40.0;
    const cv::Mat1b image = Noise(150 + static_cast<int>(seed), 90, seed);
    EdgeDetector detector(options);
    const EdgeImage& edges = detector.Detect(image);
    const cv::Mat1b expected = EdgesByDefinition(edges, options);
    ASSERT_GT(cv::countNonZero(expected), 100);
    EXPECT_EQ(cv::countNonZero(edges.ToMat() != expected), 0) << seed;
  }
}

// A weak line with one strong end: up and down many times, through words.
TEST(EdgeImage, FollowsASerpentine) {
  cv::Mat1b image(120, 200, std::uint8_t{100});
  for (int x = 8; x < 180; x += 8) {
    image(cv::Rect(x, 8, 2, 100)).setTo(125);
    image(cv::Rect(x, x / 8 % 2 == 0 ? 106 : 8, 10, 2)).setTo(125);
  }
  // It grows stronger and weaker again along its last stretch.
  for (int y = 20; y < 100; ++y) {
    image(cv::Rect(176, y, 2, 1)).setTo(205 - 2 * std::abs(y - 60));
  }
  EdgeImageOptions options;
  options.low = 1.0;
  options.high = 25.0;
  EdgeDetector detector(options);
  const EdgeImage& edges = detector.Detect(image);
  EXPECT_EQ(
      cv::countNonZero(edges.ToMat() != EdgesByDefinition(edges, options)), 0);
  EXPECT_GT(cv::countNonZero(edges.ToMat().colRange(0, 40)), 300);
}

TEST(EdgeImage, TwoAxesAreNoThickerThanFourDirections) {
  int two = 0;
  int four = 0;
  for (int step = -3; step <= 3; ++step) {
    cv::Mat1b image(100, 100, std::uint8_t{50});
    const std::vector<cv::Point> half{
        {50 + 12 * step, 0}, {99, 0}, {99, 99}, {50 - 12 * step, 99}};
    cv::fillConvexPoly(image, half, cv::Scalar(200), cv::LINE_AA);
    EdgeImageOptions options;
    two += cv::countNonZero(EdgeDetector(options).Detect(image).ToMat());
    options.suppression = EdgeSuppression::kFourDirections;
    four += cv::countNonZero(EdgeDetector(options).Detect(image).ToMat());
  }
  EXPECT_GT(two, 600);
  EXPECT_LE(two, four);
}

TEST(EdgeImage, BitsOfAMapAreItsPixels) {
  Random random(SeedFor(1, "EdgeImage.BitsOfAMapAreItsPixels"));
  for (const int width : {1, 7, 8, 63, 64, 65, 200}) {
    cv::Mat1b map(5, width);
    for (std::uint8_t& pixel : map) {
      // Every bit alone counts as an edge.
      pixel = static_cast<std::uint8_t>(
          random.Index(2) == 0 ? 0 : 1 << random.Index(8));
    }
    EdgeImage edges;
    SetEdgeBits(map, &edges);
    EXPECT_EQ(cv::countNonZero(edges.ToMat() != (map != 0)), 0);
  }
}

TEST(EdgeImage, RefusesThresholdsOutOfRange) {
  EdgeImageOptions options;
  options.low = -1.0;
  EXPECT_THROW(EdgeDetector{options}, std::invalid_argument);
  options = {};
  options.high = 251.0;
  EXPECT_THROW(EdgeDetector{options}, std::invalid_argument);
}

}  // namespace
}  // namespace waymark
