#include "estimation/lines/segmented_hough.h"

#include "estimation/base/random.h"
#include "estimation/lines/fullest_line.h"
#include "estimation/lines/segment_merger.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr HoughForm kForms[] = {HoughForm::kLiteral, HoughForm::kWords};

SegmentedHough FinderOf(HoughForm form) {
  SegmentedHoughOptions options;
  options.form = form;
  return SegmentedHough(options);
}

LineParts PartsOf(const cv::Mat1b& map, HoughForm form) {
  EdgeImage edges;
  SetEdgeBits(map, &edges);
  LineParts parts;
  FinderOf(form).Find(edges, &parts);
  return parts;
}

LineSet SegmentsOf(const cv::Mat1b& map, HoughForm form) {
  return SegmentMerger().Merge(PartsOf(map, form), map.cols, map.rows);
}

std::vector<Eigen::Vector2f> PixelsOf(const LineParts& parts, std::size_t i) {
  std::vector<Eigen::Vector2f> pixels;
  const LinePart& part = parts.parts[i];
  if (parts.tiles.empty()) {
    const auto begin = parts.pixels.begin() + part.first_pixel;
    pixels.assign(begin, begin + part.num_pixels);
    return pixels;
  }
  const TilePixels& tile = parts.tiles[i];
  for (int k = 0; k < kTileSide * kTileSide; ++k) {
    if ((tile.bits >> k & 1) == 0) continue;
    pixels.emplace_back(static_cast<float>(tile.x + k % kTileSide),
                        static_cast<float>(tile.y + k / kTileSide));
  }
  return pixels;
}

TEST(SegmentedHough, SupportingPixelsAreEdgesAndCountOnce) {
  Random random(SeedFor(2, "SegmentedHough.SupportingPixels"));
  for (const HoughForm form : kForms) {
    for (const double density : {0.05, 0.2, 0.5, 1.0}) {
      cv::Mat1b map(53, 71);
      for (std::uint8_t& pixel : map) {
        pixel = random.Uniform() < density ? 255 : 0;
      }
      const LineParts parts = PartsOf(map, form);
      std::set<std::pair<int, int>> seen;
      EXPECT_EQ(parts.tiles.size(),
                form == HoughForm::kWords ? parts.parts.size() : 0u);
      for (std::size_t i = 0; i < parts.parts.size(); ++i) {
        const LinePart& part = parts.parts[i];
        const std::vector<Eigen::Vector2f> pixels = PixelsOf(parts, i);
        EXPECT_EQ(static_cast<std::int32_t>(pixels.size()), part.num_pixels);
        EXPECT_EQ(std::count(pixels.begin(), pixels.end(), part.a), 1);
        EXPECT_EQ(std::count(pixels.begin(), pixels.end(), part.b), 1);
        LineMoments sum;
        for (const Eigen::Vector2f& p : pixels) {
          const int x = static_cast<int>(p.x());
          const int y = static_cast<int>(p.y());
          EXPECT_NE(map(y, x), 0);
          EXPECT_TRUE(seen.emplace(x, y).second);
          sum.Add(static_cast<double>(p.x()), static_cast<double>(p.y()));
        }
        // Sums of integers: exact.
        EXPECT_EQ(sum.n, part.moments.n);
        EXPECT_EQ(sum.x, part.moments.x);
        EXPECT_EQ(sum.y, part.moments.y);
        EXPECT_EQ(sum.xx, part.moments.xx);
        EXPECT_EQ(sum.xy, part.moments.xy);
        EXPECT_EQ(sum.yy, part.moments.yy);
        EXPECT_LE(part.moments.Fit().across,
                  std::pow(SegmentedHoughOptions().max_rms_px, 2) + 1e-9);
      }
    }
  }
}

TEST(SegmentedHough, ADrawnLineIsOneSegment) {
  for (const HoughForm form : kForms) {
    for (int degrees = 0; degrees < 180; degrees += 5) {
      SCOPED_TRACE(degrees);
      const double angle = degrees * std::numbers::pi / 180.0;
      const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
      const Eigen::Vector2d middle(101.0, 87.0);
      const Eigen::Vector2d a = middle - 80.0 * d;
      const Eigen::Vector2d b = middle + 80.0 * d;
      cv::Mat1b map(180, 200, std::uint8_t{0});
      cv::line(map,
               {static_cast<int>(std::lround(a.x())),
                static_cast<int>(std::lround(a.y()))},
               {static_cast<int>(std::lround(b.x())),
                static_cast<int>(std::lround(b.y()))},
               cv::Scalar(255));
      const LineSet set = SegmentsOf(map, form);
      EXPECT_FALSE(set.has_polarity);
      ASSERT_EQ(set.segments.size(), 1u);
      const LineSegment& s = set.segments[0];
      // Up to three pixels in the corner of a tile are no piece.
      EXPECT_GT((s.b - s.a).norm(), 147.0);
      const Eigen::Vector2d along = (s.b - s.a).normalized();
      // Ends rounded to pixels: half a pixel in 160.
      EXPECT_LT(std::abs(along.x() * d.y() - along.y() * d.x()), 0.008);
      EXPECT_LT(std::abs(d.x() * (s.a.y() - middle.y()) -
                         d.y() * (s.a.x() - middle.x())),
                0.8);
      // ... nor support it: of a diagonal three of eight.
      EXPECT_GT(s.num_pixels, 0.6 * cv::countNonZero(map));
    }
  }
}

// A diagonal passes all tiles at the same distance from their corners: in
// pieces of four pixels at the worst.
TEST(SegmentedHough, ADiagonalIsOneSegmentWhereverItPasses) {
  for (const HoughForm form : kForms) {
    for (int x = 20; x < 30; ++x) {
      for (const int step : {1, -1}) {
        SCOPED_TRACE(x * step);
        cv::Mat1b map(120, 120, std::uint8_t{0});
        for (int i = 0; i < 80; ++i) {
          map(20 + i, step > 0 ? x + i : 119 - x - i) = 255;
        }
        const LineSet set = SegmentsOf(map, form);
        ASSERT_EQ(set.segments.size(), 1u);
        const LineSegment& s = set.segments[0];
        // Three pixels at both ends are no piece.
        EXPECT_GE((s.b - s.a).norm(), 73.0 * std::sqrt(2.0) - 1e-9);
      }
    }
  }
}

TEST(SegmentedHough, ACornerIsTwoSegments) {
  for (const HoughForm form : kForms) {
    cv::Mat1b map(120, 120, std::uint8_t{0});
    cv::line(map, {20, 21}, {100, 21}, cv::Scalar(255));
    cv::line(map, {20, 21}, {20, 100}, cv::Scalar(255));
    const LineSet set = SegmentsOf(map, form);
    ASSERT_EQ(set.segments.size(), 2u);
    for (const LineSegment& s : set.segments) {
      EXPECT_GT((s.b - s.a).norm(), 70.0);
      EXPECT_LT(s.sigma_px, 0.2);
    }
  }
}

TEST(SegmentedHough, PixelsBelowAPieceAreNone) {
  for (const HoughForm form : kForms) {
    cv::Mat1b map(16, 16, std::uint8_t{0});
    for (int i = 3; i < 6; ++i) map(i, i) = 255;
    EXPECT_TRUE(PartsOf(map, form).parts.empty());
    map(6, 6) = 255;
    EXPECT_EQ(PartsOf(map, form).parts.size(), 1u);
  }
}

TEST(SegmentedHough, RefusesOptionsOutOfRange) {
  SegmentedHoughOptions options;
  options.min_pixels = 9;
  EXPECT_THROW(SegmentedHough{options}, std::invalid_argument);
  options = {};
  options.max_rms_px = 0.0;
  EXPECT_THROW(SegmentedHough{options}, std::invalid_argument);
}

TEST(FullestLine, IsTheFirstOfTheFullestOnAnyProcessor) {
  Random random(4);
  const auto draw = [&random] {
    std::uint64_t word = 0;
    for (int i = 0; i < 64; ++i) {
      word = word << 1 | (random.Uniform() < 0.3 ? 1 : 0);
    }
    return word;
  };
  std::vector<std::uint64_t> lines(24 * kLineBlock);
  const int num = static_cast<int>(lines.size());
  for (int round = 0; round < 200; ++round) {
    for (std::uint64_t& line : lines) line = draw();
    // Some twice, and some empty.
    lines[100] = lines[7];
    lines[101] = 0;
    const std::uint64_t tile = draw();
    FullestLine expected;
    for (int i = 0; i < num; ++i) {
      const int count =
          std::popcount(lines[static_cast<std::size_t>(i)] & tile);
      if (count > expected.count) expected = {i, count};
    }
    for (const FindFullestLine find : FindFullestLineVariants()) {
      const FullestLine found = find(lines.data(), num, tile);
      EXPECT_EQ(found.index, expected.index);
      EXPECT_EQ(found.count, expected.count);
      EXPECT_EQ(find(lines.data(), num, 0).count, 0);
    }
  }
}

TEST(SegmentMerger, JoinsOverAGapButNotOverALargerOne) {
  for (const double gap : {3.0, 9.0}) {
    LineParts parts;
    for (const double start : {10.0, 39.0 + gap}) {
      LinePart part;
      part.first_pixel = static_cast<std::int32_t>(parts.pixels.size());
      part.num_pixels = 30;
      for (int i = 0; i < 30; ++i) {
        part.moments.Add(start + i, 5.0);
        parts.pixels.emplace_back(static_cast<float>(start + i), 5.0f);
      }
      part.a = parts.pixels[static_cast<std::size_t>(part.first_pixel)];
      part.b = parts.pixels.back();
      parts.parts.push_back(part);
    }
    const LineSet set = SegmentMerger().Merge(parts, 100, 10);
    ASSERT_EQ(set.segments.size(), gap < 5.0 ? 1u : 2u);
    EXPECT_EQ(set.segments[0].a, Eigen::Vector2d(10.0, 5.0));
    if (gap < 5.0) {
      EXPECT_EQ(set.segments[0].b, Eigen::Vector2d(71.0, 5.0));
    }
    // Turned round, the second continues the first only without a direction.
    std::swap(parts.parts[1].a, parts.parts[1].b);
    std::reverse(parts.pixels.begin() + 30, parts.pixels.end());
    EXPECT_EQ(SegmentMerger().Merge(parts, 100, 10).segments.size(),
              gap < 5.0 ? 1u : 2u);
    parts.is_directed = true;
    EXPECT_EQ(SegmentMerger().Merge(parts, 100, 10).segments.size(), 2u);
  }
}

// Lines and dots at random, in places crowded.
cv::Mat1b RandomMap(Random* random) {
  cv::Mat1b map(1 + static_cast<int>(random->Index(150)),
                1 + static_cast<int>(random->Index(200)),
                std::uint8_t{0});
  const auto point = [&] {
    return cv::Point(static_cast<int>(random->Index(220)) - 10,
                     static_cast<int>(random->Index(170)) - 10);
  };
  for (int i = 0; i < 25; ++i) cv::line(map, point(), point(), cv::Scalar(255));
  const double density = 0.05 * random->Uniform();
  for (std::uint8_t& pixel : map) {
    if (random->Uniform() < density) pixel = 255 - pixel;
  }
  return map;
}

// Tiles are cells, in order, so that much is not looked at. Without them, all
// is, and the segments are the same.
TEST(SegmentMerger, TilesAreMergedAsTheirPixelsAre) {
  Random random(SeedFor(5, "SegmentMerger.Tiles"));
  std::size_t num_segments = 0;
  for (int round = 0; round < 60; ++round) {
    const cv::Mat1b map = RandomMap(&random);
    const LineParts tiles = PartsOf(map, HoughForm::kWords);
    LineParts plain = tiles;
    plain.tiles.clear();
    for (std::size_t i = 0; i < plain.parts.size(); ++i) {
      LinePart& part = plain.parts[i];
      part.first_pixel = static_cast<std::int32_t>(plain.pixels.size());
      std::vector<Eigen::Vector2f> pixels = PixelsOf(tiles, i);
      const bool is_wide = std::abs(part.b.x() - part.a.x()) >=
                           std::abs(part.b.y() - part.a.y());
      std::stable_sort(pixels.begin(), pixels.end(), [&](auto& a, auto& b) {
        return is_wide ? a.x() < b.x() : a.y() < b.y();
      });
      plain.pixels.insert(plain.pixels.end(), pixels.begin(), pixels.end());
    }
    for (const double gap : {6.0, 20.0, 64.0}) {
      SegmentMergerOptions options;
      options.max_gap_px = gap;
      SegmentMerger merger(options);
      const LineSet expected = merger.Merge(plain, map.cols, map.rows);
      const LineSet found = merger.Merge(tiles, map.cols, map.rows);
      ASSERT_EQ(found.segments.size(), expected.segments.size());
      std::set<std::pair<int, int>> seen;
      for (std::size_t i = 0; i < found.segments.size(); ++i) {
        const LineSegment& s = found.segments[i];
        EXPECT_LT((s.a - expected.segments[i].a).norm(), 1e-4);
        EXPECT_LT((s.b - expected.segments[i].b).norm(), 1e-4);
        ASSERT_EQ(s.num_pixels, expected.segments[i].num_pixels);
        const Eigen::Vector2f d = (s.b - s.a).normalized().cast<float>();
        float before = -1e9f;
        for (std::int32_t k = 0; k < s.num_pixels; ++k) {
          const Eigen::Vector2f& p =
              found.pixels[static_cast<std::size_t>(s.first_pixel + k)];
          const int x = static_cast<int>(p.x());
          const int y = static_cast<int>(p.y());
          ASSERT_NE(map(y, x), 0);
          ASSERT_TRUE(seen.emplace(x, y).second);
          EXPECT_GE(d.dot(p), before - 1e-3f);
          before = d.dot(p);
        }
      }
      num_segments += found.segments.size();
    }
  }
  EXPECT_GT(num_segments, 1000u);
}

// A square has no direction of its own: it lengthens the line beside it.
TEST(SegmentMerger, SquaresOnlyContinueOthers) {
  cv::Mat1b map(64, 80, std::uint8_t{0});
  map(cv::Rect(6, 8, 2, 2)).setTo(255);
  map(cv::Rect(8, 8, 52, 1)).setTo(255);
  for (const bool is_upright : {false, true}) {
    cv::Mat1b turned = map;
    if (is_upright) turned = map.t();
    const LineSet set = SegmentsOf(turned, HoughForm::kWords);
    ASSERT_EQ(set.segments.size(), 1u);
    EXPECT_EQ(set.segments[0].num_pixels, 56);
  }
  map.setTo(0);
  map(cv::Rect(6, 8, 2, 2)).setTo(255);
  EXPECT_TRUE(SegmentsOf(map, HoughForm::kWords).segments.empty());
}

TEST(SegmentMerger, RefusesOptionsOutOfRange) {
  SegmentMergerOptions options;
  options.max_gap_px = 0.0;
  EXPECT_THROW(SegmentMerger{options}, std::invalid_argument);
  options = {};
  options.min_length_px = 0.0;
  EXPECT_THROW(SegmentMerger{options}, std::invalid_argument);
}

}  // namespace
}  // namespace waymark
