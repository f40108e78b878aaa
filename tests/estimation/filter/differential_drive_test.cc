#include "estimation/filter/differential_drive.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "tests/support/drive_simulation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

constexpr WheelParameters kParameters{1.1e-4, 0.9e-4, 0.27};

TEST(IntegrateTicks, RightWheelAheadTurnsLeft) {
  for (const auto integration :
       {DriveIntegration::kMidpoint, DriveIntegration::kArc}) {
    const DriveStep step =
        IntegrateTicks({2000, 1000}, kParameters, {}, integration);
    EXPECT_GT(step.X_R0R1.heading, 0);
    EXPECT_GT(step.X_R0R1.x, 0);
    EXPECT_GT(step.X_R0R1.y, 0);
  }
}

TEST(IntegrateTicks, MidpointIsEquationFour) {
  const double l_r = 2000 * kParameters.k_right;
  const double l_l = 1500 * kParameters.k_left;
  const DriveStep step = IntegrateTicks(
      {2000, 1500}, kParameters, {}, DriveIntegration::kMidpoint);
  const double turn = (l_r - l_l) / kParameters.wheel_base;
  EXPECT_DOUBLE_EQ(step.X_R0R1.heading, turn);
  EXPECT_DOUBLE_EQ(step.X_R0R1.x, (l_r + l_l) / 2 * std::cos(turn / 2));
  EXPECT_DOUBLE_EQ(step.X_R0R1.y, (l_r + l_l) / 2 * std::sin(turn / 2));
}

TEST(IntegrateTicks, ArcIsTheLimitOfManyMidpointSteps) {
  const WheelTicks ticks{4000, 1000};
  const DriveStep arc =
      IntegrateTicks(ticks, kParameters, {}, DriveIntegration::kArc);
  constexpr int kSteps = 2000;
  Pose2 X;
  for (int i = 0; i < kSteps; ++i) {
    X = X * IntegrateTicks({ticks.right / kSteps, ticks.left / kSteps},
                           kParameters,
                           {},
                           DriveIntegration::kMidpoint)
                .X_R0R1;
  }
  // The midpoint rule's error falls with the square of the step.
  EXPECT_NEAR(arc.X_R0R1.x, X.x, 1e-7);
  EXPECT_NEAR(arc.X_R0R1.y, X.y, 1e-7);
  EXPECT_NEAR(arc.X_R0R1.heading, X.heading, 1e-10);
}

TEST(IntegrateTicks, ParameterJacobianMatchesDifferences) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const WheelTicks ticks{random.Uniform(-3000, 3000),
                           random.Uniform(-3000, 3000)};
    for (const auto integration :
         {DriveIntegration::kMidpoint, DriveIntegration::kArc}) {
      const DriveStep step =
          IntegrateTicks(ticks, kParameters, {}, integration);
      for (int k = 0; k < 3; ++k) {
        const double h = 1e-6 * kParameters.vector()(k);
        Eigen::Vector3d d = Eigen::Vector3d::Zero();
        d(k) = h;
        const auto moved = [&](double sign) {
          return IntegrateTicks(ticks,
                                WheelParameters::FromVector(
                                    kParameters.vector() + sign * d),
                                {},
                                integration)
              .X_R0R1.vector();
        };
        const Eigen::Vector3d numeric = (moved(1) - moved(-1)) / (2 * h);
        const Eigen::Vector3d column = step.d_parameters.col(k);
        EXPECT_LT((numeric - column).norm(), 1e-7 * (1 + column.norm()));
      }
    }
  }
}

// Row Y13: the covariance of a path does not depend on the sampling rate.
TEST(IntegrateTicks, CovarianceIsIndependentOfTheSamplingRate) {
  const auto covariance_after = [](int num_steps, const WheelTicks& total) {
    Pose2 X;
    Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
    for (int i = 0; i < num_steps; ++i) {
      const DriveStep step =
          IntegrateTicks({total.right / num_steps, total.left / num_steps},
                         kParameters,
                         DriveNoise{2e-4, 3e-5},
                         DriveIntegration::kArc);
      const ComposeJacobians j = JacobiansOfCompose(X, step.X_R0R1);
      P = j.d_AB * P * j.d_AB.transpose() +
          j.d_BC * step.covariance * j.d_BC.transpose();
      X = X * step.X_R0R1;
    }
    return P;
  };
  for (const WheelTicks total : {WheelTicks{60000, 60000},
                                 WheelTicks{40000, 20000},
                                 WheelTicks{8000, -8000}}) {
    const Eigen::Matrix3d coarse = covariance_after(200, total);
    const Eigen::Matrix3d fine = covariance_after(3200, total);
    // Heading is exact; position differs by the step's own lever, of the
    // order of 1 / number of steps.
    EXPECT_NEAR(coarse(2, 2), fine(2, 2), 1e-9 * fine(2, 2));
    EXPECT_LT((coarse - fine).norm(), 0.01 * fine.norm());
    EXPECT_GT(fine(2, 2), 0);
  }
}

// The generator and the model agree: the scatter of the truth about the path
// that the ticks describe is the predicted covariance.
TEST(SimulateDrive, ScatterOfTheTruthIsThePredictedCovariance) {
  constexpr int kSeeds = 400;
  DriveSimulationOptions options;
  options.noise = {1e-4, 2e-5};
  options.duration_s = 5;
  options.rate_hz = 20;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d predicted = Eigen::Matrix3d::Zero();
  // A driver who does not look, so that every seed turns the same ticks.
  const Driver blind = [](double t, const Pose2&) {
    return DriveCommand{0.3, t < 2.5 ? 0.6 : -0.2};
  };
  for (int seed = 0; seed < kSeeds; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    const auto readings = SimulateDrive(options, blind);
    Pose2 X;
    Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
    for (std::size_t i = 1; i < readings.size(); ++i) {
      const DriveStep step =
          IntegrateTicks({readings[i].right_ticks - readings[i - 1].right_ticks,
                          readings[i].left_ticks - readings[i - 1].left_ticks},
                         options.parameters,
                         options.noise,
                         options.integration);
      const ComposeJacobians j = JacobiansOfCompose(X, step.X_R0R1);
      P = j.d_AB * P * j.d_AB.transpose() +
          j.d_BC * step.covariance * j.d_BC.transpose();
      X = X * step.X_R0R1;
    }
    Eigen::Vector3d e = readings.back().X_WR.vector() - X.vector();
    e.z() = WrapAngle(e.z());
    scatter += e * e.transpose() / kSeeds;
    predicted = P;
  }
  for (int k = 0; k < 3; ++k) {
    // The variance of 400 draws scatters by sqrt(2 / 400) = 7 %; four sigma.
    EXPECT_NEAR(scatter(k, k) / predicted(k, k), 1.0, 0.28) << "state " << k;
  }
}

TEST(IntegrateTicks, RejectsImpossibleParameters) {
  EXPECT_THROW(
      (void)IntegrateTicks({1, 1}, {1e-4, 1e-4, 0}, {}, DriveIntegration::kArc),
      std::logic_error);
  EXPECT_THROW((void)IntegrateTicks(
                   {std::nan(""), 1}, kParameters, {}, DriveIntegration::kArc),
               std::logic_error);
}

}  // namespace
}  // namespace waymark
