#include "estimation/corridor/lateral_candidates.h"

#include "estimation/corridor/line_classification.h"
#include "estimation/geometry/angle.h"
#include "estimation/geometry/pose3.h"
#include "tests/support/corridor_lines.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr CorridorEdge kNone = CorridorEdge::kNone;
constexpr CorridorEdge kFloorLeft = CorridorEdge::kFloorLeft;
constexpr CorridorEdge kFloorRight = CorridorEdge::kFloorRight;
constexpr CorridorEdge kCeilingLeft = CorridorEdge::kCeilingLeft;
constexpr CorridorEdge kCeilingRight = CorridorEdge::kCeilingRight;

CorridorGeometry Corridor() {
  CorridorGeometry corridor;
  corridor.width = 2.0;
  corridor.height = 2.5;
  return corridor;
}

// The image of a piece of space, given in L; all of it is in front.
SeenLine See(const CorridorView& view,
             const Pose2& X_LR,
             const Eigen::Vector3d& a_L,
             const Eigen::Vector3d& b_L) {
  const Eigen::Isometry3d X_CL = (SpatialPose(X_LR) * view.X_RC).inverse();
  LineSegment segment;
  const auto pixel = [&](const Eigen::Vector3d& p_L) -> Eigen::Vector2d {
    const Eigen::Vector3d p_C = X_CL * p_L;
    const Intrinsics& k = view.intrinsics;
    return {k.fx * p_C.x() / p_C.z() + k.cx, k.fy * p_C.y() / p_C.z() + k.cy};
  };
  segment.a = pixel(a_L);
  segment.b = pixel(b_L);
  segment.sigma_px = 0.1;
  segment.sigma_rad = 1e-4;
  return SeenLineOf(segment, 0.0, 0.0);
}

const std::vector<std::pair<Eigen::Vector2d, CorridorEdge>> kCorners = {
    {{1.0, 0.0}, kFloorLeft},
    {{-1.0, 0.0}, kFloorRight},
    {{1.0, 2.5}, kCeilingLeft},
    {{-1.0, 2.5}, kCeilingRight}};

struct Look {
  CorridorView view;
  Pose2 X_LR;
};
// Poses and tilts, the camera turned on the robot or not.
std::vector<Look> Looks() {
  std::vector<Look> looks;
  for (const double tilt : {-0.15, 0.0, 0.2}) {
    for (const double yaw : {0.0, 0.25}) {
      for (const double heading : {-0.4, 0.0, 0.1, 0.4}) {
        for (const double y : {-0.7, -0.2, 0.0, 0.5}) {
          looks.push_back(
              {ViewForTests(tilt, yaw), Pose2{0.0, y, heading - yaw}});
        }
      }
    }
  }
  return looks;
}

SeenLine SeeCorner(const Look& look, const Eigen::Vector2d& corner) {
  return See(look.view,
             look.X_LR,
             {4.0, corner.x(), corner.y()},
             {11.0, corner.x(), corner.y()});
}

TEST(ClassifyLine, EachCornerIsItsEdge) {
  for (const Look& look : Looks()) {
    for (const auto& [corner, edge] : kCorners) {
      EXPECT_EQ(ClassifyLine(
                    look.view, SeeCorner(look, corner), look.X_LR.heading, {}),
                edge)
          << look.X_LR.y << " " << look.X_LR.heading;
    }
  }
}

// A camera that lies on its side sees the floor beside the vanishing point.
TEST(ClassifyLine, FollowsTheCorridorNotTheImage) {
  Look look{ViewForTests(0.1), Pose2{0.0, 0.2, 0.1}};
  look.view.X_RC.rotate(Eigen::AngleAxisd(0.5 * kPi, Eigen::Vector3d::UnitZ()));
  for (const auto& [corner, edge] : kCorners) {
    EXPECT_EQ(
        ClassifyLine(look.view, SeeCorner(look, corner), look.X_LR.heading, {}),
        edge);
  }
}

TEST(ClassifyLine, OtherLinesAreNone) {
  const CorridorView view = ViewForTests(0.1);
  const Pose2 X_LR{0.0, 0.2, 0.1};
  // A door's frame, and what lies across the floor.
  EXPECT_EQ(
      ClassifyLine(
          view, See(view, X_LR, {4.0, 1.0, 0.2}, {4.0, 1.0, 2.0}), 0.1, {}),
      kNone);
  EXPECT_EQ(
      ClassifyLine(
          view, See(view, X_LR, {4.0, -1.0, 0.0}, {4.0, 1.0, 0.0}), 0.1, {}),
      kNone);
  // An edge, at a heading that is not the robot's.
  const SeenLine edge = See(view, X_LR, {4.0, 1.0, 0.0}, {9.0, 1.0, 0.0});
  EXPECT_EQ(ClassifyLine(view, edge, 0.1, {}), kFloorLeft);
  EXPECT_EQ(ClassifyLine(view, edge, 0.2, {}), kNone);
}

TEST(LateralCandidate, EachCornerGivesTheOffset) {
  for (const Look& look : Looks()) {
    for (const auto& [corner, edge] : kCorners) {
      const auto y = LateralCandidate(look.view,
                                      SeeCorner(look, corner),
                                      edge,
                                      Corridor(),
                                      look.X_LR.heading);
      ASSERT_TRUE(y) << look.X_LR.y << " " << look.X_LR.heading;
      EXPECT_NEAR(*y, look.X_LR.y, 1e-9);
    }
  }
}

TEST(LateralCandidate, NoneWhereTheEdgeCannotBe) {
  const Look look{ViewForTests(0.1), Pose2{0.0, 0.2, 0.1}};
  const auto candidate = [&](const Eigen::Vector2d& corner,
                             CorridorEdge edge,
                             const CorridorGeometry& corridor) {
    return LateralCandidate(
        look.view, SeeCorner(look, corner), edge, corridor, 0.1);
  };
  CorridorGeometry corridor = Corridor();
  EXPECT_FALSE(candidate({1.0, 0.0}, kCeilingLeft, corridor));  // Below.
  EXPECT_FALSE(candidate({1.0, 0.0}, kFloorRight, corridor));   // Outside.
  EXPECT_FALSE(candidate({1.0, 0.0}, kNone, corridor));
  corridor.height.reset();
  EXPECT_TRUE(candidate({1.0, 0.0}, kFloorLeft, corridor));
  EXPECT_FALSE(candidate({1.0, 2.5}, kCeilingLeft, corridor));
  corridor.width.reset();
  EXPECT_FALSE(candidate({1.0, 0.0}, kFloorLeft, corridor));
}

class AgreeOnLateralTest : public testing::Test {
 protected:
  void Add(const Eigen::Vector2d& at, CorridorEdge edge) {
    lines_.push_back(SeeCorner(look_, at));
    edges_.push_back(edge);
  }
  [[nodiscard]] LateralConsensus Agree(
      const LateralConsensusOptions& options = {}) const {
    return AgreeOnLateral(look_.view, lines_, edges_, Corridor(), 0.1, options);
  }

  Look look_{ViewForTests(0.1), Pose2{0.0, 0.2, 0.1}};
  std::vector<SeenLine> lines_;
  std::vector<CorridorEdge> edges_;
};

TEST_F(AgreeOnLateralTest, WrongLinesAreTakenAway) {
  Add({0.6, 0.0}, kFloorLeft);  // A carpet's edge.
  for (const auto& [corner, edge] : kCorners) Add(corner, edge);
  Add({-1.0, 1.7}, kCeilingRight);  // A picture's.
  const LateralConsensus found = Agree();
  ASSERT_TRUE(found.y) << found.reason;
  EXPECT_NEAR(*found.y, 0.2, 1e-9);
  EXPECT_EQ(found.inlier_mask, (std::vector<char>{0, 1, 1, 1, 1, 0}));
}

TEST_F(AgreeOnLateralTest, LinesOfOneWallDoNot) {
  Add({1.0, 0.0}, kFloorLeft);
  Add({1.0, 2.5}, kCeilingLeft);
  LateralConsensus found = Agree();
  EXPECT_FALSE(found.y);
  EXPECT_EQ(found.reason, "of the lines that agree none is on the right wall");
  LateralConsensusOptions options;
  options.needs_both_walls = false;
  EXPECT_NEAR(Agree(options).y.value_or(9.0), 0.2, 1e-9);
  Add({-1.0, 0.0}, kFloorRight);
  EXPECT_NEAR(Agree().y.value_or(9.0), 0.2, 1e-9);
}

TEST_F(AgreeOnLateralTest, WithoutCandidatesItSaysSo) {
  Add({1.0, 0.0}, kNone);
  const LateralConsensus found = Agree();
  EXPECT_FALSE(found.y);
  EXPECT_EQ(found.reason, "no line can be an edge of the corridor");
  LateralConsensusOptions options;
  options.num_kept = 0;
  EXPECT_THROW((void)Agree(options), std::invalid_argument);
}

}  // namespace
}  // namespace waymark
