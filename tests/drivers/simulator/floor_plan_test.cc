#include "drivers/simulator/floor_plan.h"

#include "estimation/base/input_error.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace waymark {
namespace {

using Eigen::Vector2d;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kMetresPerPixel = 0.1;

cv::Mat1b Paper(int width, int height) {
  return cv::Mat1b(height, width, std::uint8_t{255});
}

FloorPlan PlanOf(const cv::Mat1b& image, double tolerance_px = 1.0) {
  FloorPlanOptions options;
  options.metres_per_pixel = kMetresPerPixel;
  options.tolerance_px = tolerance_px;
  return FloorPlanFromImage(image, options, "plan");
}

// Of the outlines: counter-clockwise is positive, so holes count as free.
double AreaOf(const FloorPlan& plan) {
  double area = 0.0;
  for (const std::vector<Vector2d>& outline : plan.outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vector2d& a = outline[i];
      const Vector2d& b = outline[(i + 1) % outline.size()];
      area += 0.5 * (a.x() * b.y() - a.y() * b.x());
    }
  }
  return area;
}

std::string ErrorOf(const cv::Mat1b& image) {
  try {
    PlanOf(image);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

// A box of 4 x 2 pixels whose upper left pixel is (3, 1), in 20 x 10.
TEST(FloorPlan, ABoxKeepsItsCornersExactly) {
  cv::Mat1b image = Paper(20, 10);
  image(cv::Rect(3, 1, 4, 2)) = 0;
  const FloorPlan plan = PlanOf(image);
  EXPECT_NEAR(plan.size.x(), 2.0, 1e-12);
  EXPECT_NEAR(plan.size.y(), 1.0, 1e-12);
  ASSERT_EQ(plan.outlines.size(), 1u);
  ASSERT_EQ(plan.outlines[0].size(), 4u);
  // y up from the lower edge of the image.
  EXPECT_THAT(
      plan.outlines[0],
      testing::UnorderedElementsAre(testing::Truly([](const Vector2d& p) {
                                      return p.isApprox(Vector2d(0.3, 0.9));
                                    }),
                                    testing::Truly([](const Vector2d& p) {
                                      return p.isApprox(Vector2d(0.7, 0.9));
                                    }),
                                    testing::Truly([](const Vector2d& p) {
                                      return p.isApprox(Vector2d(0.3, 0.7));
                                    }),
                                    testing::Truly([](const Vector2d& p) {
                                      return p.isApprox(Vector2d(0.7, 0.7));
                                    })));
  EXPECT_NEAR(AreaOf(plan), 0.08, 1e-12);  // Counter-clockwise.
  EXPECT_NEAR(plan.wall_area, 0.08, 1e-12);
  EXPECT_NEAR(plan.free_area, 1.92, 1e-12);
}

TEST(FloorPlan, KnowsWhatIsFree) {
  cv::Mat1b image = Paper(20, 10);
  image(cv::Rect(3, 1, 4, 2)) = 0;
  const FloorPlan plan = PlanOf(image);
  EXPECT_FALSE(plan.IsFree({0.5, 0.8}));
  EXPECT_TRUE(plan.IsFree({0.29, 0.8}));
  EXPECT_TRUE(plan.IsFree({0.71, 0.8}));
  EXPECT_TRUE(plan.IsFree({0.5, 0.69}));
  EXPECT_TRUE(plan.IsFree({0.5, 0.91}));
  EXPECT_FALSE(plan.IsFree({-0.01, 0.5}));
  EXPECT_FALSE(plan.IsFree({0.5, 1.01}));
  EXPECT_FALSE(plan.IsFree({std::nan(""), 0.5}));
}

TEST(FloorPlan, ARoomHasAnOutlineWithinTheOther) {
  cv::Mat1b image = Paper(40, 30);
  image(cv::Rect(2, 2, 36, 26)) = 0;
  image(cv::Rect(5, 5, 30, 20)) = 255;
  image(cv::Rect(20, 2, 4, 3)) = 255;  // A door in the upper wall.
  image(cv::Rect(10, 10, 2, 2)) = 0;   // A pillar.
  const FloorPlan plan = PlanOf(image);
  EXPECT_EQ(plan.outlines.size(), 2u);
  EXPECT_NEAR(AreaOf(plan), plan.wall_area, 1e-12);
  image(cv::Rect(20, 2, 4, 3)) = 0;  // Shut: an outer and an inner outline.
  EXPECT_EQ(PlanOf(image).outlines.size(), 3u);
  EXPECT_NEAR(AreaOf(PlanOf(image)), PlanOf(image).wall_area, 1e-12);
}

TEST(FloorPlan, WallsOfOnePixelKeepTheirWidth) {
  cv::Mat1b image = Paper(60, 60);
  image(cv::Rect(5, 30, 50, 1)) = 0;
  EXPECT_NEAR(AreaOf(PlanOf(image)), 0.5, 1e-12);
  EXPECT_EQ(PlanOf(image).outlines[0].size(), 4u);
  image(cv::Rect(20, 5, 1, 50)) = 0;  // A crossing.
  EXPECT_NEAR(AreaOf(PlanOf(image)), 0.99, 1e-12);
  EXPECT_EQ(PlanOf(image).outlines[0].size(), 12u);

  image = Paper(60, 60);
  cv::line(image, {5, 5}, {50, 40}, 0);
  const FloorPlan slanting = PlanOf(image);
  EXPECT_EQ(slanting.outlines.size(), 1u);
  // A few corners; the area within half a pixel along its 57 on either side.
  EXPECT_LT(slanting.outlines[0].size(), 12u);
  EXPECT_NEAR(AreaOf(slanting), slanting.wall_area, 0.5 * 114 * 0.01);
}

// The same room drawn at any angle has the same walls to a pixel.
TEST(FloorPlan, RotatedRoomsKeepAreaAndPlace) {
  for (const double angle : {3.0, 17.0, 30.0, 45.0, 61.0}) {
    cv::Mat1b image = Paper(400, 400);
    const auto corners = [&](float half_width, float half_height) {
      const cv::RotatedRect box({199.5f, 199.5f},
                                {2.0f * half_width, 2.0f * half_height},
                                static_cast<float>(angle));
      std::vector<cv::Point2f> points(4);
      box.points(points.data());
      return std::vector<cv::Point>(points.begin(), points.end());
    };
    cv::fillConvexPoly(image, corners(140, 90), 0);
    cv::fillConvexPoly(image, corners(130, 80), 255);
    const FloorPlan plan = PlanOf(image);
    ASSERT_EQ(plan.outlines.size(), 2u) << angle;
    // Half a pixel along both outlines, 920 and 840 pixels long.
    EXPECT_NEAR(AreaOf(plan), plan.wall_area, 0.5 * 1760 * 0.01) << angle;
    for (const std::vector<Vector2d>& outline : plan.outlines) {
      EXPECT_LE(outline.size(), 24u) << angle << ": simplified";
      for (const Vector2d& p : outline) {
        const double a = angle * std::numbers::pi / 180.0;
        // Pixel coordinates have the middle of a pixel at its number.
        const Vector2d d(p.x() / 0.1 - 200.0, 200.0 - p.y() / 0.1);
        const double along =
            std::abs(std::cos(a) * d.x() + std::sin(a) * d.y());
        const double across =
            std::abs(-std::sin(a) * d.x() + std::cos(a) * d.y());
        const double outer = std::max(along - 140.0, across - 90.0);
        const double inner = std::max(along - 130.0, across - 80.0);
        // A pixel of drawing, one of the outline.
        EXPECT_LT(std::min(std::abs(outer), std::abs(inner)), 2.0) << angle;
      }
    }
  }
}

TEST(FloorPlan, ToleranceZeroKeepsEveryStair) {
  cv::Mat1b image = Paper(20, 20);
  for (int i = 0; i < 10; ++i) image(cv::Rect(5, 5 + i, 1 + i, 1)) = 0;
  EXPECT_NEAR(AreaOf(PlanOf(image, 0.0)), PlanOf(image).wall_area, 1e-12);
  EXPECT_GE(PlanOf(image, 0.0).outlines[0].size(), 20u);
  EXPECT_LE(PlanOf(image).outlines[0].size(), 6u);
}

TEST(FloorPlan, SpecksAreLeftOut) {
  cv::Mat1b image = Paper(20, 20);
  image(cv::Rect(2, 2, 10, 10)) = 0;
  image(5, 5) = 255;
  image(15, 15) = 0;
  FloorPlanOptions options;
  EXPECT_EQ(FloorPlanFromImage(image, options, "plan").outlines.size(), 3u);
  options.min_pixels = 2;
  EXPECT_EQ(FloorPlanFromImage(image, options, "plan").outlines.size(), 1u);
}

TEST(FloorPlan, BlankAndBlackImagesAreRefused) {
  EXPECT_THAT(ErrorOf(Paper(20, 10)),
              AllOf(HasSubstr("plan: no walls"), HasSubstr("128")));
  EXPECT_THAT(ErrorOf(cv::Mat1b(10, 20, std::uint8_t{0})),
              HasSubstr("no free space"));
  EXPECT_THAT(ErrorOf(Paper(kMaxFloorPlanSide + 1, 1)), HasSubstr("8193 x 1"));
  EXPECT_THAT(ErrorOf(cv::Mat1b()), HasSubstr("0 x 0"));
  FloorPlanOptions options;
  options.metres_per_pixel = 0.0;
  EXPECT_THROW((void)FloorPlanFromImage(Paper(2, 2), options, "plan"),
               std::invalid_argument);
}

TEST(FloorPlan, LoadsColourAndTransparency) {
  const TemporaryDirectory folder;
  cv::Mat4b image(10, 10, cv::Vec4b(0, 0, 0, 0));  // Transparent.
  image(cv::Rect(2, 2, 3, 3)) = cv::Vec4b(120, 0, 0, 255);
  const std::string path = folder / "plan.png";
  cv::imwrite(path, image);
  FloorPlanOptions options;
  options.metres_per_pixel = 1.0;
  EXPECT_NEAR(LoadFloorPlan(path, options).wall_area, 9.0, 1e-12);
  try {
    (void)LoadFloorPlan(folder / "gone.png", options);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("gone.png: cannot be opened"));
  }
}

}  // namespace
}  // namespace waymark
