#include "estimation/corridor/edge_evidence.h"

#include "estimation/geometry/angle.h"
#include "tests/support/corridor_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace waymark {
namespace {

CorridorGeometry Corridor() {
  CorridorGeometry corridor;
  corridor.width = 2.0;
  corridor.height = 2.5;
  corridor.x_min = -20.0;
  corridor.x_max = 20.0;
  return corridor;
}

constexpr double kHeading = 0.1;

// Lines of the corridor for a robot at y, all said to be along it.
struct Scene {
  Scene(double y, const CorridorLinesOptions& see) : view(ViewForTests(0.1)) {
    const LineSet set = SeeCorridor(view, Corridor(), {0.0, y, kHeading}, see);
    for (const LineSegment& segment : set.segments) {
      lines.push_back(SeenLineOf(segment, 0.0, 0.0));
    }
    heading.heading = kHeading;
    heading.families.assign(lines.size(), LineFamily::kAlong);
  }

  // A line along the corridor, through (y, z) of its cross-section.
  void AddLine(double y_robot, double y, double z, double from, double to) {
    const auto ends = VisibleEdge(view, {y, z}, y_robot, kHeading, from, to);
    ASSERT_TRUE(ends);
    LineSegment segment;
    segment.a = ends->first;
    segment.b = ends->second;
    segment.sigma_px = 1e-3;
    segment.sigma_rad = 1e-5;
    lines.push_back(SeenLineOf(segment, 0.0, 0.0));
    heading.families.push_back(LineFamily::kAlong);
  }

  [[nodiscard]] LateralPeak Find(
      const std::optional<LateralPrior>& prior = {}) const {
    return FindLateralPeak(view,
                           Corridor(),
                           lines,
                           FindEdgeCandidates(view, Corridor(), lines, heading),
                           kHeading,
                           prior,
                           {});
  }

  CorridorView view;
  std::vector<SeenLine> lines;
  AxisHeading heading;
};

CorridorLinesOptions AllAround() {
  CorridorLinesOptions see;
  see.x_from = -15.0;
  return see;
}

TEST(EdgeEvidence, FindsTheRobotWhereAllEdgesAre) {
  for (const double y : {-0.7, -0.2, 0.0, 0.4}) {
    const LateralPeak peak = Scene(y, AllAround()).Find();
    EXPECT_NEAR(peak.y, y, 1e-6);
    EXPECT_GT(peak.evidence, peak.rival + 5.0);
    // Floor left and right: all of what is in view.
    EXPECT_NEAR(peak.coverage[0], 1.0, 1e-3);
    EXPECT_NEAR(peak.coverage[1], 1.0, 1e-3);
    EXPECT_LT(peak.coverage[4], 0.0) << "no skirting board is known";
  }
}

// Courses of bricks, 8 cm apart, as long as the edges: more lines than edges,
// and each of them in the right place for an edge at some other y.
TEST(EdgeEvidence, BricksDoNotOutvoteEdges) {
  constexpr double kY = 0.2;
  Scene scene(kY, AllAround());
  for (double z = 0.08; z < 0.55; z += 0.08) {
    scene.AddLine(kY, -1.0, z, 0.5, 8.0);
  }
  const LateralPeak peak = scene.Find();
  EXPECT_NEAR(peak.y, kY, 1e-6);
  EXPECT_GT(peak.evidence, peak.rival + 2.0);
}

TEST(EdgeEvidence, PiecesOfALineCountNoMoreThanTheLine) {
  constexpr double kY = 0.2;
  Scene whole(kY, {});
  whole.lines.clear();
  whole.heading.families.clear();
  Scene pieces = whole;
  whole.AddLine(kY, 1.0, 0.0, 2.0, 8.0);
  for (double x = 2.0; x < 8.0; x += 0.5) {
    pieces.AddLine(kY, 1.0, 0.0, x, x + 0.5);
  }
  EXPECT_NEAR(whole.Find().evidence, pieces.Find().evidence, 1e-6);
}

TEST(EdgeEvidence, AnEdgeThatShouldBeSeenCountsAgainst) {
  constexpr double kY = 0.2;
  const Scene both(kY, AllAround());
  Scene left = both;
  left.lines.clear();
  left.heading.families.clear();
  left.AddLine(kY, 1.0, 0.0, 0.5, 8.0);
  const LateralPeak peak = left.Find(LateralPrior{kY, 0.1, 0.0, 0.1});
  EXPECT_NEAR(peak.y, kY, 1e-6);
  EXPECT_EQ(peak.coverage[1], 0.0);
  EXPECT_LT(peak.evidence,
            both.Find(LateralPrior{kY, 0.1, 0.0, 0.1}).evidence - 6.0);
}

// Where the corridor has ended, nothing is missed.
TEST(EdgeEvidence, NothingIsLookedForBeyondTheEnds) {
  constexpr double kY = 0.2;
  CorridorLinesOptions see = AllAround();
  see.x_to = 3.0;
  const Scene scene(kY, see);
  const LateralPeak inside = scene.Find(LateralPrior{kY, 0.1, 0.0, 0.0});
  const LateralPeak at_end = scene.Find(LateralPrior{kY, 0.1, 17.0, 0.0});
  EXPECT_LT(inside.coverage[0], 0.95);
  EXPECT_NEAR(at_end.coverage[0], 1.0, 1e-3);
  EXPECT_GT(at_end.evidence, inside.evidence);
}

TEST(EdgeEvidence, ThePriorChoosesBetweenEquals) {
  constexpr double kY = 0.2;
  Scene scene(kY, {});
  scene.lines.clear();
  scene.heading.families.clear();
  // Two lines; either may be the left floor's edge.
  scene.AddLine(kY, 1.0, 0.0, 0.5, 8.0);
  scene.AddLine(kY, 0.7, 0.0, 0.5, 8.0);
  EXPECT_NEAR(scene.Find(LateralPrior{0.2, 0.05, 0.0, 0.1}).y, 0.2, 1e-6);
  EXPECT_NEAR(scene.Find(LateralPrior{0.5, 0.05, 0.0, 0.1}).y, 0.5, 1e-6);
}

TEST(EdgeEvidence, WithoutLinesThereIsNoPeak) {
  Scene scene(0.0, {});
  scene.lines.clear();
  scene.heading.families.clear();
  EXPECT_EQ(scene.Find().evidence, -std::numeric_limits<double>::infinity());
}

// An edge that lies across the image is cut off at its borders, and one behind
// the camera is not in view.
TEST(EdgeEvidence, VisibleEdgeEndsAtTheBorders) {
  const CorridorView view = ViewForTests(0.1);
  const auto ends = VisibleEdge(view, {1.0, 0.0}, 0.0, 0.0, -8.0, 8.0);
  ASSERT_TRUE(ends);
  for (const Eigen::Vector2d& end : {ends->first, ends->second}) {
    EXPECT_GE(end.x(), -1e-9);
    EXPECT_LE(end.x(), view.size.width - 1 + 1e-9);
    EXPECT_LE(end.y(), view.size.height - 1 + 1e-9);
    // On the edge's image.
    const auto line = ImageOfEdge(view, {1.0, 0.0}, 0.0, 0.0);
    EXPECT_NEAR(line->dot(end.homogeneous()), 0.0, 1e-9);
  }
  EXPECT_NEAR(ends->first.x(), 0.0, 1e-9) << "the left border";
  EXPECT_FALSE(VisibleEdge(view, {1.0, 0.0}, 0.0, 0.0, -8.0, -0.5));
}

}  // namespace
}  // namespace waymark
