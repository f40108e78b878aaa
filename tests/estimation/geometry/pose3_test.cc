#include "estimation/geometry/pose3.h"

#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

TEST(SpatialPose, MovesPointsAsThePlanarPoseDoes) {
  const Pose2 X_AB{1.0, -2.0, 0.7};
  const Eigen::Vector2d p_BQ(0.3, 0.9);
  const Eigen::Vector3d p_AQ =
      SpatialPose(X_AB) * Eigen::Vector3d(p_BQ.x(), p_BQ.y(), 0.5);
  EXPECT_LT((p_AQ.head<2>() - X_AB * p_BQ).norm(), 1e-15);
  EXPECT_EQ(p_AQ.z(), 0.5);
}

TEST(SpatialPose, ComposesAsThePlanarPosesDo) {
  const Pose2 X_AB{1.0, -2.0, 3.0};
  const Pose2 X_BC{-0.4, 0.2, 2.0};
  const Eigen::Matrix4d difference =
      (SpatialPose(X_AB) * SpatialPose(X_BC)).matrix() -
      SpatialPose(X_AB * X_BC).matrix();
  EXPECT_LT(difference.norm(), 1e-14);
}

}  // namespace
}  // namespace waymark
