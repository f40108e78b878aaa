#include "estimation/filter/motion_model.h"

#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <vector>

namespace waymark {
namespace {

// Over all quadrants, across +-pi, standing still, and a mounting of any yaw.
std::vector<Pose2> Grid() {
  return {{0, 0, 0},
          {1.5, -2.0, 0.7},
          {-300.0, 40.0, 3.1},
          {-0.2, 0.1, -3.1},
          {5.0, 5.0, -1.6}};
}

RelativeMotion MotionBetween(const Pose2& X_WR0,
                             const Pose2& X_WR1,
                             const Pose2& X_RS) {
  RelativeMotion motion;
  motion.X_RS = X_RS;
  motion.X_S0S1 = Between(X_WR0 * X_RS, X_WR1 * X_RS);
  return motion;
}

TEST(PredictMotion, ExactMotionLeavesNoResidual) {
  for (const Pose2& X_WR0 : Grid()) {
    for (const Pose2& X_WR1 : Grid()) {
      for (const Pose2& X_RS : Grid()) {
        const MotionPrediction p =
            PredictMotion(MotionBetween(X_WR0, X_WR1, X_RS), X_WR0, X_WR1);
        // Rounding of coordinates of some hundreds of metres.
        EXPECT_LT(p.residual.norm(), 1e-11);
      }
    }
  }
}

// The motion of a sensor is the same wherever in the world it happens.
TEST(PredictMotion, DoesNotDependOnTheWorldFrame) {
  const Pose2 X_WR0{1.0, 2.0, 0.5};
  const Pose2 X_WR1{1.4, 2.1, 0.9};
  RelativeMotion motion = MotionBetween(X_WR0, X_WR1, {0.1, -0.05, 1.6});
  motion.X_S0S1.x += 0.02;
  motion.X_S0S1.heading += 0.01;
  const Eigen::Vector3d residual = PredictMotion(motion, X_WR0, X_WR1).residual;
  EXPECT_NEAR(residual(0), 0.02, 1e-12);
  EXPECT_NEAR(residual(1), 0.0, 1e-12);
  EXPECT_NEAR(residual(2), 0.01, 1e-12);
  for (const Pose2& X_VW : Grid()) {
    const Eigen::Vector3d moved =
        PredictMotion(motion, X_VW * X_WR0, X_VW * X_WR1).residual;
    EXPECT_LT((moved - residual).norm(), 1e-11);
  }
}

TEST(PredictMotion, JacobiansMatchDifferences) {
  // Central differences of second derivatives of up to some hundreds of
  // metres: 1e-6 squared times that, and rounding over 1e-6.
  constexpr double kStep = 1e-6;
  constexpr double kTolerance = 1e-6;
  const auto moved = [](const Pose2& X, int k, double h) {
    Eigen::Vector3d v = X.vector();
    v(k) += h;
    return Pose2::FromVector(v);
  };
  for (const Pose2& X_WR0 : Grid()) {
    for (const Pose2& X_WR1 : Grid()) {
      for (const Pose2& X_RS : Grid()) {
        const RelativeMotion motion = MotionBetween(X_WR0, X_WR1, X_RS);
        const MotionPrediction p = PredictMotion(motion, X_WR0, X_WR1);
        for (int k = 0; k < 3; ++k) {
          const auto slope = [&](auto predict) {
            // The residual falls where what is expected grows.
            Eigen::Vector3d d = predict(-kStep) - predict(kStep);
            d(2) = WrapAngle(d(2));
            return Eigen::Vector3d(d / (2.0 * kStep));
          };
          const Eigen::Vector3d by_from = slope([&](double h) {
            return PredictMotion(motion, moved(X_WR0, k, h), X_WR1).residual;
          });
          const Eigen::Vector3d by_to = slope([&](double h) {
            return PredictMotion(motion, X_WR0, moved(X_WR1, k, h)).residual;
          });
          const Eigen::Vector3d by_mounting = slope([&](double h) {
            RelativeMotion turned = motion;
            turned.X_RS = moved(X_RS, k, h);
            return PredictMotion(turned, X_WR0, X_WR1).residual;
          });
          EXPECT_LT((by_from - p.d_from.col(k)).norm(), kTolerance);
          EXPECT_LT((by_to - p.d_to.col(k)).norm(), kTolerance);
          EXPECT_LT((by_mounting - p.d_mounting.col(k)).norm(), kTolerance);
        }
      }
    }
  }
}

}  // namespace
}  // namespace waymark
