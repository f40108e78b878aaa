#include "estimation/corridor/axis_heading.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "tests/support/corridor_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace waymark {
namespace {

constexpr double kHeading = 0.2;

std::vector<SeenLine> LinesOf(const LineSet& set) {
  std::vector<SeenLine> lines;
  for (const LineSegment& segment : set.segments) {
    lines.push_back(SeenLineOf(segment, 0.0, 0.0));
  }
  return lines;
}

std::vector<SeenLine> CorridorLines(const CorridorView& view) {
  CorridorGeometry corridor;
  corridor.width = 2.0;
  corridor.height = 2.5;
  CorridorLinesOptions see;
  see.sigma_px = 0.3;
  return LinesOf(SeeCorridor(view, corridor, {0.0, 0.3, kHeading}, see));
}

// A line of the image towards where `direction` (in R) vanishes.
SeenLine LineTowards(const CorridorView& view,
                     const Eigen::Vector2d& middle,
                     const Eigen::Vector3d& direction) {
  const Eigen::Vector3d pixel = view.PixelOf(direction);
  SeenLine line;
  line.middle = middle;
  line.direction = (pixel.head<2>() - pixel.z() * middle).normalized().eval();
  line.length = 60.0;
  line.sigma_px = 0.2;
  line.sigma_rad = 0.005;
  return line;
}

TEST(AxisHeading, ExactLinesGiveTheHeading) {
  const CorridorView view = ViewForTests(0.1, 0.3);
  for (const double deg : {-40.0, -3.0, 0.0, 12.0, 60.0}) {
    Random random(5);
    std::vector<SeenLine> lines;
    for (int i = 0; i < 12; ++i) {
      // Below the horizon: on it lines along and across are the same.
      lines.push_back(LineTowards(
          view,
          {random.Uniform(20.0, 620.0), random.Uniform(300.0, 460.0)},
          AxisIn(RadiansFromDegrees(deg))));
    }
    const auto found = EstimateAxisHeading(
        view, lines, AxisPrior{RadiansFromDegrees(deg + 4.0), 0.1}, {});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->heading, RadiansFromDegrees(deg), 1e-9);
    EXPECT_TRUE(StandsOut(*found, {}));
  }
}

// A tiled floor has as many lines across as you like: they say the same
// heading, and are not taken for the axis.
TEST(AxisHeading, LinesAcrossDoNotBecomeTheAxis) {
  const CorridorView view = ViewForTests(0.1);
  std::vector<SeenLine> lines = CorridorLines(view);
  const std::size_t num_along = lines.size();
  Random random(6);
  for (int i = 0; i < 300; ++i) {
    lines.push_back(
        LineTowards(view,
                    {random.Uniform(20.0, 620.0), random.Uniform(250.0, 460.0)},
                    AcrossIn(kHeading)));
  }
  const auto found = EstimateAxisHeading(
      view, lines, AxisPrior{kHeading + 0.1, RadiansFromDegrees(5.0)}, {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->heading, kHeading, 1e-6);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(found->families[i],
              i < num_along ? LineFamily::kAlong : LineFamily::kAcross);
  }
}

TEST(AxisHeading, LinesAtRandomDoNotStandOut) {
  const CorridorView view = ViewForTests(0.1);
  int num_found = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    std::vector<SeenLine> lines;
    for (int i = 0; i < 120; ++i) {
      SeenLine line;
      line.middle = {random.Uniform(0.0, 639.0), random.Uniform(0.0, 479.0)};
      const double angle = random.Uniform(0.0, kPi);
      line.direction = {std::cos(angle), std::sin(angle)};
      line.length = 40.0;
      line.sigma_px = 0.3;
      line.sigma_rad = 0.01;
      lines.push_back(line);
    }
    const auto found =
        EstimateAxisHeading(view, lines, AxisPrior{0.0, 0.1}, {});
    num_found += found && StandsOut(*found, {}) ? 1 : 0;
  }
  EXPECT_EQ(num_found, 0);
  const auto corridor = EstimateAxisHeading(
      view, CorridorLines(view), AxisPrior{kHeading, 0.1}, {});
  ASSERT_TRUE(corridor);
  EXPECT_TRUE(StandsOut(*corridor, {}));
}

}  // namespace
}  // namespace waymark
