#include "estimation/lines/line_extractor.h"

#include "estimation/base/random.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

using Eigen::Vector2d;

// The half plane to the right of d through p is bright, and each pixel has the
// share of its square that is.
cv::Mat1b HalfPlane(cv::Size size,
                    const Vector2d& p,
                    const Vector2d& d,
                    double noise = 0.0,
                    std::uint64_t seed = 1) {
  constexpr int kSamples = 16;
  constexpr double kDark = 60.0;
  constexpr double kBright = 180.0;
  Random random(seed);
  cv::Mat1b image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double distance = d.x() * (y - p.y()) - d.y() * (x - p.x());
      double share = distance > 0.0 ? 1.0 : 0.0;
      if (std::abs(distance) < 1.0) {
        int num = 0;
        for (int i = 0; i < kSamples * kSamples; ++i) {
          const double sx = x + (i % kSamples + 0.5) / kSamples - 0.5;
          const double sy = y + (i / kSamples + 0.5) / kSamples - 0.5;
          num += d.x() * (sy - p.y()) - d.y() * (sx - p.x()) > 0.0;
        }
        share = static_cast<double>(num) / (kSamples * kSamples);
      }
      image(y, x) = cv::saturate_cast<std::uint8_t>(
          kDark + share * (kBright - kDark) + noise * random.Normal());
    }
  }
  return image;
}

LineExtractorOptions OptionsOf(LineScheme scheme) {
  LineExtractorOptions options;
  options.scheme = scheme;
  return options;
}

constexpr LineScheme kSchemes[] = {LineScheme::kEdgeChains,
                                   LineScheme::kSegmentedHough};

double AngleBetween(const Vector2d& a, const Vector2d& b) {
  return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

double LengthOf(const LineSegment& s) {
  return (s.b - s.a).norm();
}

const LineSegment& LongestOf(const LineSet& set) {
  return *std::max_element(set.segments.begin(),
                           set.segments.end(),
                           [](const LineSegment& s, const LineSegment& t) {
                             return LengthOf(s) < LengthOf(t);
                           });
}

TEST(LineExtractor, FindsOneExactLineAtEveryAngle) {
  const cv::Size size(96, 80);
  for (const LineScheme scheme : kSchemes) {
    LineExtractor extractor(OptionsOf(scheme));
    for (int degrees = 0; degrees < 360; degrees += 7) {
      SCOPED_TRACE("scheme " + std::to_string(static_cast<int>(scheme)) + ", " +
                   std::to_string(degrees) + " degrees");
      const double angle = degrees * std::numbers::pi / 180.0;
      const Vector2d d(std::cos(angle), std::sin(angle));
      const Vector2d p(47.3, 39.6);
      const LineSet set = extractor.Extract(HalfPlane(size, p, d));
      ASSERT_FALSE(set.segments.empty());
      EXPECT_TRUE(set.has_polarity);
      const LineSegment& s = LongestOf(set);
      // Across the whole image but for its rim.
      EXPECT_GT(LengthOf(s), 72.0);
      const Vector2d middle = 0.5 * (s.a + s.b) - p;
      // What the parabola leaves of an edge that sampling has not blurred.
      EXPECT_LT(std::abs(d.x() * middle.y() - d.y() * middle.x()), 0.06);
      // Including the sense: the brighter side is on the right.
      EXPECT_LT(AngleBetween(s.b - s.a, d), 0.003);
    }
  }
}

TEST(LineExtractor, ErrorsAreThoseItStates) {
  const cv::Size size(96, 80);
  for (const LineScheme scheme : kSchemes) {
    LineExtractor extractor(OptionsOf(scheme));
    double offset = 0.0;
    double turn = 0.0;
    int num = 0;
    Random random(SeedFor(3, "LineExtractor.ErrorsAreThoseItStates"));
    for (int i = 0; i < 60; ++i) {
      const double angle = random.Uniform(-3.1, 3.1);
      const Vector2d d(std::cos(angle), std::sin(angle));
      const Vector2d p(47.5 + random.Uniform(-5.0, 5.0),
                       39.5 + random.Uniform(-5.0, 5.0));
      const LineSet set =
          extractor.Extract(HalfPlane(size, p, d, 6.0, random.Bits()));
      ASSERT_FALSE(set.segments.empty());
      const LineSegment& s = LongestOf(set);
      const Vector2d middle = 0.5 * (s.a + s.b) - p;
      const double across = d.x() * middle.y() - d.y() * middle.x();
      offset += std::pow(across / s.sigma_px, 2);
      turn += std::pow(AngleBetween(s.b - s.a, d) / s.sigma_rad, 2);
      ++num;
    }
    // Sixty squares of one have a standard error of 0.18. Below there is no
    // bound to hold: this edge is straighter than those of scenes, for which
    // the floor of the errors stands.
    EXPECT_LT(offset / num, 1.6);
    EXPECT_LT(turn / num, 1.6);
    EXPECT_GT(turn / num, 0.02);
  }
}

cv::Mat1b Drawing(std::uint64_t seed) {
  Random random(seed);
  cv::Mat1b image(120, 160, std::uint8_t{90});
  for (int i = 0; i < 12; ++i) {
    const auto point = [&] {
      return cv::Point(static_cast<int>(random.Index(160)),
                       static_cast<int>(random.Index(120)));
    };
    const std::vector<cv::Point> corners{point(), point(), point()};
    cv::fillConvexPoly(
        image, corners, cv::Scalar(random.Uniform(0.0, 255.0)), cv::LINE_AA);
  }
  return image;
}

// Whether `set` holds most of the segment from a to b, in this sense.
bool Holds(const LineSet& set, const Vector2d& a, const Vector2d& b) {
  // Where lines meet, their ends may lie a few pixels elsewhere.
  constexpr double kAcrossPx = 0.5;
  constexpr double kAngle = 0.03;
  constexpr double kShare = 0.6;
  const Vector2d middle = 0.5 * (a + b);
  const double length = (b - a).norm();
  return std::any_of(
      set.segments.begin(), set.segments.end(), [&](const LineSegment& s) {
        const Vector2d d = (s.b - s.a).normalized();
        const Vector2d p = middle - s.a;
        return AngleBetween(d, b - a) < kAngle &&
               std::abs(d.x() * p.y() - d.y() * p.x()) < kAcrossPx &&
               d.dot(p) > 0.0 && d.dot(p) < LengthOf(s) &&
               LengthOf(s) > kShare * length;
      });
}

TEST(LineExtractor, AMirroredOrTurnedImageMirrorsOrTurnsTheSegments) {
  for (const LineScheme scheme : kSchemes) {
    LineExtractor extractor(OptionsOf(scheme));
    int num = 0;
    int num_mirrored = 0;
    int num_turned = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const cv::Mat1b image = Drawing(seed);
      cv::Mat1b mirrored;
      cv::Mat1b turned;
      cv::flip(image, mirrored, 1);
      cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
      const LineSet set = extractor.Extract(image);
      const LineSet of_mirrored = extractor.Extract(mirrored);
      const LineSet of_turned = extractor.Extract(turned);
      const double right = image.cols - 1.0;
      const double bottom = image.rows - 1.0;
      for (const LineSegment& s : set.segments) {
        if (LengthOf(s) < 20.0) continue;
        ++num;
        // A mirror exchanges left and right, so a and b change places.
        num_mirrored += Holds(of_mirrored,
                              {right - s.b.x(), s.b.y()},
                              {right - s.a.x(), s.a.y()});
        num_turned += Holds(of_turned,
                            {bottom - s.a.y(), s.a.x()},
                            {bottom - s.b.y(), s.b.x()});
      }
    }
    EXPECT_GT(num, 40);
    // Who takes pixels that lines share depends on the order of the rows, and
    // tiles lie otherwise on a turned image. A wrong sign leaves none.
    EXPECT_GT(num_mirrored, 0.8 * num);
    EXPECT_GT(num_turned, 0.8 * num);
  }
}

TEST(LineExtractor, PixelsSupportTheirSegmentInOrder) {
  for (const LineScheme scheme : kSchemes) {
    const LineExtractorOptions options = OptionsOf(scheme);
    LineExtractor extractor(options);
    const LineSet set = extractor.Extract(Drawing(7));
    ASSERT_FALSE(set.segments.empty());
    std::int32_t next = 0;
    for (const LineSegment& s : set.segments) {
      EXPECT_EQ(s.first_pixel, next);
      next += s.num_pixels;
      const Vector2d d = (s.b - s.a).normalized();
      double last = -1e-3;
      for (std::int32_t i = 0; i < s.num_pixels; ++i) {
        const Vector2d p =
            set.pixels[static_cast<std::size_t>(s.first_pixel + i)]
                .cast<double>() -
            s.a;
        // The last fit moves a little from the one that chose the pixels.
        EXPECT_LT(std::abs(d.x() * p.y() - d.y() * p.x()),
                  options.max_distance_px + 0.2);
        EXPECT_GT(d.dot(p), last - 1e-3);
        last = d.dot(p);
      }
      EXPECT_NEAR(last, LengthOf(s), 1e-3);
    }
    EXPECT_EQ(static_cast<std::size_t>(next), set.pixels.size());
  }
}

bool IsSame(const LineSet& a, const LineSet& b) {
  if (a.segments.size() != b.segments.size() || a.pixels != b.pixels) {
    return false;
  }
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    const LineSegment& s = a.segments[i];
    const LineSegment& t = b.segments[i];
    if (s.a != t.a || s.b != t.b || s.sigma_px != t.sigma_px ||
        s.sigma_rad != t.sigma_rad || s.first_pixel != t.first_pixel ||
        s.num_pixels != t.num_pixels) {
      return false;
    }
  }
  return true;
}

TEST(LineExtractor, SameImageSameSegmentsWhateverCameBefore) {
  for (const LineScheme scheme : kSchemes) {
    LineExtractorOptions options = OptionsOf(scheme);
    LineExtractor extractor(options);
    const LineSet first = extractor.Extract(Drawing(5));
    (void)extractor.Extract(cv::Mat1b(200, 33, std::uint8_t{7}));
    (void)extractor.Extract(Drawing(6));
    EXPECT_TRUE(IsSame(first, extractor.Extract(Drawing(5))));
    options.edges.wide = false;
    EXPECT_TRUE(IsSame(first, LineExtractor(options).Extract(Drawing(5))));
  }
}

TEST(LineExtractor, HostileImagesAreSurvived) {
  Random random(SeedFor(1, "LineExtractor.HostileImagesAreSurvived"));
  std::vector<cv::Mat1b> images;
  images.emplace_back();
  for (const cv::Size size : {cv::Size(1, 1),
                              cv::Size(1, 90),
                              cv::Size(90, 1),
                              cv::Size(2, 3),
                              cv::Size(64, 64),
                              cv::Size(65, 17)}) {
    images.emplace_back(size, std::uint8_t{128});
    cv::Mat1b noise(size);
    cv::Mat1b checkers(size);
    cv::Mat1b stripes(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        noise(y, x) = static_cast<std::uint8_t>(random.Index(256));
        checkers(y, x) = (x + y) % 2 == 0 ? 0 : 255;
        stripes(y, x) = x / 2 % 2 == 0 ? 0 : 255;
      }
    }
    images.push_back(noise);
    images.push_back(checkers);
    images.push_back(stripes);
  }
  // A serpentine, up and down through the whole image.
  cv::Mat1b serpentine(120, 160, std::uint8_t{255});
  for (int x = 4; x < 150; x += 6) {
    serpentine(cv::Rect(x, 4, 2, 110)).setTo(0);
    serpentine(cv::Rect(x, x / 6 % 2 == 0 ? 4 : 112, 8, 2)).setTo(0);
  }
  images.push_back(serpentine);
  for (const LineScheme scheme : kSchemes) {
    LineExtractorOptions options = OptionsOf(scheme);
    options.edges.low = 0.0;
    options.edges.high = 0.0;
    LineExtractor all(options);
    LineExtractor usual(OptionsOf(scheme));
    for (const cv::Mat1b& image : images) {
      for (const LineSet& set : {all.Extract(image), usual.Extract(image)}) {
        EXPECT_LE(set.pixels.size(), image.total());
        for (const LineSegment& s : set.segments) {
          EXPECT_TRUE(s.a.allFinite() && s.b.allFinite());
          EXPECT_GT(s.sigma_px, 0.0);
          EXPECT_GT(s.sigma_rad, 0.0);
          EXPECT_GE(LengthOf(s), options.merger.min_length_px);
        }
      }
    }
    EXPECT_TRUE(
        usual.Extract(cv::Mat1b(64, 64, std::uint8_t{9})).segments.empty());
    EXPECT_GT(usual.Extract(serpentine).segments.size(), 20u);
  }
}

TEST(LineExtractor, OptionsOutOfRangeAreRefused) {
  LineExtractorOptions options;
  options.max_distance_px = 0.0;
  EXPECT_THROW(LineExtractor{options}, std::invalid_argument);
  options = {};
  options.min_support = 1.5;
  EXPECT_THROW(LineExtractor{options}, std::invalid_argument);
  options = {};
  options.edges.high = 0.5 * options.edges.low;
  EXPECT_THROW(LineExtractor{options}, std::invalid_argument);
}

}  // namespace
}  // namespace waymark
