#include "drivers/simulator/material_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

// Coarse: what is tested does not depend on the density.
PatternTexture Make(PatternKind kind,
                    std::uint64_t seed = 1,
                    double pixels_per_metre = 100.0) {
  PatternOptions options;
  options.kind = kind;
  options.seed = seed;
  options.pixels_per_metre = pixels_per_metre;
  if (kind == PatternKind::kSign) options.text = "2.14";
  return MakePattern(options);
}

std::vector<PatternKind> AllKinds() {
  std::vector<PatternKind> kinds;
  for (const std::string& name : PatternNames()) {
    kinds.push_back(PatternFromName(name).value());
  }
  return kinds;
}

// Mean reflectance: linear, of the sRGB curve.
double Reflectance(const cv::Mat3b& image) {
  double sum = 0.0;
  for (const cv::Vec3b& pixel : image) {
    for (int i = 0; i < 3; ++i) sum += std::pow(pixel[i] / 255.0, 2.2);
  }
  return sum / (3.0 * static_cast<double>(image.total()));
}

std::string ErrorOf(const PatternOptions& options) {
  try {
    (void)MakePattern(options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

TEST(MaterialPattern, NamesAndKindsBelongTogether) {
  EXPECT_EQ(PatternNames().size(), 14u);
  for (const std::string& name : PatternNames()) {
    ASSERT_TRUE(PatternFromName(name)) << name;
    EXPECT_EQ(NameOf(*PatternFromName(name)), name);
  }
  EXPECT_FALSE(PatternFromName("marble"));
}

TEST(MaterialPattern, SameOptionsGiveTheSameBytesOtherSeedsOthers) {
  for (const PatternKind kind : AllKinds()) {
    const cv::Mat3b once = Make(kind).image;
    const cv::Mat3b again = Make(kind).image;
    EXPECT_EQ(cv::norm(once, again, cv::NORM_INF), 0.0) << NameOf(kind);
    if (kind == PatternKind::kPlain || kind == PatternKind::kSign) continue;
    const cv::Mat3b other = Make(kind, 2).image;
    EXPECT_GT(cv::norm(once, other, cv::NORM_INF), 0.0) << NameOf(kind);
  }
}

// With any compiler: those below are what several draws in one expression, in
// the order of one compiler, once gave.
TEST(MaterialPattern, DrawsComeInOneOrder) {
  struct Known {
    PatternKind kind;
    std::uint64_t seed;
    cv::Scalar mean;
  };
  for (const Known& known :
       {Known{PatternKind::kNoticeboard, 1, {127.91, 114.94, 128.74}},
        Known{PatternKind::kNoticeboard, 2, {131.93, 144.42, 154.31}},
        Known{PatternKind::kPicture, 1, {146.83, 168.43, 143.30}},
        Known{PatternKind::kPicture, 3, {120.03, 114.94, 121.60}},
        Known{PatternKind::kPicture, 4, {157.20, 178.68, 133.18}},
        Known{PatternKind::kPicture, 6, {132.45, 127.96, 116.23}}}) {
    PatternOptions options;
    options.kind = known.kind;
    options.seed = known.seed;
    options.pixels_per_metre = 200.0;
    const cv::Scalar mean = cv::mean(MakePattern(options).image);
    for (int i = 0; i < 3; ++i) {
      // Other versions of OpenCV round otherwise at edges.
      EXPECT_NEAR(mean[i], known.mean[i], 0.1)
          << NameOf(known.kind) << " " << known.seed;
    }
  }
}

TEST(MaterialPattern, PlainHasNoFeatureAtAll) {
  const PatternTexture plain = Make(PatternKind::kPlain);
  EXPECT_EQ(plain.image.total(), 1u);
}

TEST(MaterialPattern, NothingIsBlackOrBurnt) {
  for (const PatternKind kind : AllKinds()) {
    double low = 0.0;
    double high = 0.0;
    cv::minMaxLoc(Make(kind, 3).image.reshape(1), &low, &high);
    EXPECT_GE(low, kMinPatternValue) << NameOf(kind);
    EXPECT_LE(high, kMaxPatternValue) << NameOf(kind);
  }
}

TEST(MaterialPattern, ReflectsAsMuchAsSuchThingsDo) {
  struct Range {
    PatternKind kind;
    double low;
    double high;
  };
  // Painted walls 0.5 to 0.8, ceilings up to 0.85, floors 0.2 to 0.5, brick and
  // cloth darker.
  for (const Range& range : {Range{PatternKind::kPlain, 0.5, 0.8},
                             Range{PatternKind::kPlaster, 0.5, 0.8},
                             Range{PatternKind::kPaint, 0.5, 0.8},
                             Range{PatternKind::kBrick, 0.2, 0.5},
                             Range{PatternKind::kPlanks, 0.2, 0.5},
                             Range{PatternKind::kParquet, 0.2, 0.5},
                             Range{PatternKind::kTiles, 0.2, 0.5},
                             Range{PatternKind::kCarpet, 0.2, 0.5},
                             Range{PatternKind::kCeilingPanels, 0.6, 0.85},
                             Range{PatternKind::kFabric, 0.1, 0.4},
                             Range{PatternKind::kDoor, 0.2, 0.5}}) {
    const double mean = Reflectance(Make(range.kind).image);
    EXPECT_GT(mean, range.low) << NameOf(range.kind);
    EXPECT_LT(mean, range.high) << NameOf(range.kind);
  }
}

// Mean difference of neighbouring rows (or columns), here and at the seam.
double StepAt(const cv::Mat3b& image, int row) {
  return cv::norm(
             image.row(row), image.row((row + 1) % image.rows), cv::NORM_L1) /
         image.cols;
}

TEST(MaterialPattern, RepeatsWithoutASeam) {
  for (const PatternKind kind : AllKinds()) {
    if (IsOnePiece(kind) || kind == PatternKind::kPlain) continue;
    cv::Mat3b image = Make(kind).image;
    for (int turned = 0; turned < 2; ++turned) {
      double largest = 0.0;
      for (int row = 0; row + 1 < image.rows; ++row) {
        largest = std::max(largest, StepAt(image, row));
      }
      // The seam is no more of a step than the largest within, which for
      // stones is the edge of one.
      EXPECT_LE(StepAt(image, image.rows - 1), 1.05 * largest)
          << NameOf(kind) << " turned " << turned;
      cv::Mat3b transposed;
      cv::transpose(image, transposed);
      image = transposed;
    }
  }
}

TEST(MaterialPattern, KeepsItsPixelsPerMetre) {
  PatternOptions options;
  options.kind = PatternKind::kPicture;
  options.size = Eigen::Vector2d(1.2, 0.8);
  options.pixels_per_metre = 100.0;
  EXPECT_EQ(MakePattern(options).image.size(), cv::Size(120, 80));
}

TEST(MaterialPattern, RefusesWhatIsOutOfRangeByName) {
  PatternOptions options;
  options.color = cv::Vec3b(0, 100, 100);
  EXPECT_THAT(ErrorOf(options), HasSubstr("color has 0, not in [10, 245]"));
  options = {};
  options.size = Eigen::Vector2d(1.0, 1.0);
  EXPECT_THAT(ErrorOf(options), HasSubstr("plain: it repeats"));
  options.kind = PatternKind::kPicture;
  options.size = Eigen::Vector2d(1.0, -1.0);
  EXPECT_THAT(ErrorOf(options), HasSubstr("size must be in"));
  options.size = Eigen::Vector2d(9.0, 9.0);
  options.pixels_per_metre = 1000.0;
  EXPECT_THAT(ErrorOf(options), HasSubstr("9000 x 9000 pixels"));
  options = {};
  options.pixels_per_metre = std::nan("");
  EXPECT_THAT(ErrorOf(options), HasSubstr("pixels_per_metre"));
  options = {};
  options.text = "A";
  EXPECT_THAT(ErrorOf(options), HasSubstr("takes no text"));
  options.kind = PatternKind::kSign;
  options.text = "\x01";
  EXPECT_THAT(ErrorOf(options), HasSubstr("printable"));
}

TEST(MaterialPattern, TinyPiecesCanBeMade) {
  for (const PatternKind kind : AllKinds()) {
    if (!IsOnePiece(kind)) continue;
    PatternOptions options;
    options.kind = kind;
    options.size = Eigen::Vector2d(0.02, 0.01);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      options.seed = seed;
      EXPECT_FALSE(MakePattern(options).image.empty());
    }
  }
}

// All kinds, then pictures and noticeboards of many seeds, for a look:
// patterns.png in the build folder.
TEST(MaterialPattern, ContactSheet) {
  constexpr int kSide = 320;
  constexpr int kColumns = 6;
  std::vector<PatternTexture> textures;
  for (const PatternKind kind : AllKinds()) {
    textures.push_back(Make(kind, 1, 0.0));
  }
  for (std::uint64_t seed = 2; seed < 18; ++seed) {
    textures.push_back(Make(PatternKind::kPicture, seed, 0.0));
  }
  for (std::uint64_t seed = 2; seed < 8; ++seed) {
    textures.push_back(Make(PatternKind::kNoticeboard, seed, 0.0));
  }
  const int rows =
      (static_cast<int>(textures.size()) + kColumns - 1) / kColumns;
  cv::Mat3b sheet(rows * kSide, kColumns * kSide, cv::Vec3b(60, 60, 60));
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const cv::Mat3b& image = textures[i].image;
    const double scale = (kSide - 10.0) / std::max(image.cols, image.rows);
    cv::Mat3b small;
    cv::resize(image,
               small,
               cv::Size(),
               scale,
               scale,
               scale < 1.0 ? cv::INTER_AREA : cv::INTER_NEAREST);
    const int column = static_cast<int>(i) % kColumns;
    const int row = static_cast<int>(i) / kColumns;
    small.copyTo(
        sheet(cv::Rect(column * kSide, row * kSide, small.cols, small.rows)));
  }
  if (const char* build = std::getenv("WAYMARK_BUILD")) {
    EXPECT_TRUE(cv::imwrite(std::string(build) + "/patterns.png", sheet));
  }
}

}  // namespace
}  // namespace waymark
