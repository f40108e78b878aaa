#include "estimation/corridor/corridor_choice.h"

#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <vector>

namespace waymark {
namespace {

// A T: one along W's x, one along its y.
std::vector<CorridorGeometry> Corridors() {
  CorridorGeometry across;
  across.name = "across";
  across.width = 2.0;
  across.x_min = 0.0;
  across.x_max = 15.0;
  across.X_WL = {0.0, 1.0, 0.0};
  CorridorGeometry stem = across;
  stem.name = "stem";
  stem.x_max = 12.0;
  stem.X_WL = {7.5, 0.0, RadiansFromDegrees(90.0)};
  return {across, stem};
}

PoseEstimate At(double x, double y, double heading_deg) {
  PoseEstimate estimate;
  estimate.is_known = true;
  estimate.X_WR = {x, y, RadiansFromDegrees(heading_deg)};
  estimate.covariance = Eigen::Vector3d(0.04, 0.01, 0.0025).asDiagonal();
  return estimate;
}

TEST(ChooseCorridor, TheOneThatTheRobotIsIn) {
  const auto corridors = Corridors();
  const CorridorChoice across = ChooseCorridor(corridors, At(3.0, 1.3, 170.0));
  ASSERT_TRUE(across.corridor);
  EXPECT_EQ(*across.corridor, 0u);
  EXPECT_NEAR(across.prior->X_LR.x, 3.0, 1e-12);
  EXPECT_NEAR(across.prior->X_LR.y, 0.3, 1e-12);

  const CorridorChoice stem = ChooseCorridor(corridors, At(7.2, 9.0, 80.0));
  ASSERT_TRUE(stem.corridor);
  EXPECT_EQ(*stem.corridor, 1u);
  // Its left is W's -x.
  EXPECT_NEAR(stem.prior->X_LR.x, 9.0, 1e-12);
  EXPECT_NEAR(stem.prior->X_LR.y, 0.3, 1e-12);
  EXPECT_NEAR(stem.prior->X_LR.heading, RadiansFromDegrees(-10.0), 1e-12);
  // So do the covariances of x and y change places.
  EXPECT_NEAR(stem.prior->covariance(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(stem.prior->covariance(1, 1), 0.04, 1e-12);
  EXPECT_NEAR(stem.prior->covariance(2, 2), 0.0025, 1e-12);
}

TEST(ChooseCorridor, WhereTheyCrossTheOneAlongWhichItLooks) {
  const auto corridors = Corridors();
  for (const double heading : {-30.0, 10.0, 170.0, -160.0}) {
    EXPECT_EQ(ChooseCorridor(corridors, At(7.5, 1.0, heading)).corridor, 0u);
  }
  for (const double heading : {60.0, 100.0, -80.0}) {
    EXPECT_EQ(ChooseCorridor(corridors, At(7.5, 1.0, heading)).corridor, 1u);
  }
}

TEST(ChooseCorridor, BesideAllOfThemThereIsNone) {
  const auto corridors = Corridors();
  const CorridorChoice choice = ChooseCorridor(corridors, At(3.0, 4.0, 0.0));
  EXPECT_FALSE(choice.corridor);
  EXPECT_FALSE(choice.reason.empty());
  // Three sigmas beyond a wall it may still be inside.
  EXPECT_TRUE(ChooseCorridor(corridors, At(3.0, 2.29, 0.0)).corridor);
  EXPECT_FALSE(ChooseCorridor(corridors, At(3.0, 2.31, 0.0)).corridor);
}

TEST(ChooseCorridor, WithoutAPoseTheOnlyOne) {
  const auto corridors = Corridors();
  EXPECT_FALSE(ChooseCorridor(corridors, std::nullopt).corridor);
  const CorridorChoice only =
      ChooseCorridor(std::span(corridors).first(1), std::nullopt);
  EXPECT_EQ(only.corridor, 0u);
  EXPECT_FALSE(only.prior);
}

}  // namespace
}  // namespace waymark
