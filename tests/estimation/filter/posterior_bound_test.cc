#include "estimation/filter/posterior_bound.h"

#include "estimation/filter/odometry_ekf.h"
#include "tests/support/drive_simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

namespace waymark {
namespace {

using Matrix6 = PosteriorBound::Matrix6;

constexpr WheelParameters kTrue{1.1e-4, 0.9e-4, 0.27};

Matrix6 Prior() {
  Matrix6 P = Matrix6::Zero();
  P.diagonal() << 1e-4, 1e-4, 1e-4, 1e-11, 1e-11, 4e-4;
  return P;
}

// Lateral position and heading in a corridor that lies askew in the world.
AbsoluteFix CorridorFix() {
  AbsoluteFix fix;
  fix.has = {false, true, true};
  fix.covariance.diagonal() << 0.0, 9e-4, 1e-4;
  fix.X_WF = {0.3, -0.2, 0.4};
  fix.X_RS = {0.1, 0.0, 0.0};
  return fix;
}

// A filter that stands on the truth, and hears nothing but the truth, has its
// Jacobians there.
TEST(PosteriorBound, IsTheCovarianceOfAFilterOnTheTruth) {
  DriveSimulationOptions drive;
  drive.parameters = kTrue;
  drive.duration_s = 20.0;
  drive.noise = {0.0, 0.0};
  drive.whole_ticks = false;
  const auto readings = SimulateDrive(drive, ZigZagDriver(0.4, 0.5, 2.0, 0.6));
  const DriveNoise noise;
  OdometryEkfOptions options;
  options.noise = noise;
  options.form = ParameterForm::kTravel;
  OdometryEkf filter(options, readings.front().X_WR, kTrue, Prior());
  PosteriorBound bound(kTrue, noise, DriveIntegration::kArc, Prior());
  AbsoluteFix fix = CorridorFix();
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const WheelTicks ticks{
        readings[i].right_ticks - readings[i - 1].right_ticks,
        readings[i].left_ticks - readings[i - 1].left_ticks};
    filter.Predict(ticks, 1.0 / drive.rate_hz);
    bound.Predict(readings[i - 1].X_WR, ticks);
    if (i % 5 != 0) continue;
    const Pose2 X_FS = Inverse(fix.X_WF) * readings[i].X_WR * fix.X_RS;
    fix.value = {X_FS.x, X_FS.y, X_FS.heading};
    filter.Update(fix);
    // What was measured does not matter.
    fix.value.setConstant(7.0);
    bound.Update(readings[i].X_WR, fix);
  }
  const Eigen::Matrix<double, 6, 1> scale =
      bound.covariance().diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6 difference = scale.asDiagonal() *
                             (filter.covariance() - bound.covariance()) *
                             scale.asDiagonal();
  // Rounding alone, and what it moves the filter's state.
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-6);
  // Not of a filter that learns nothing.
  EXPECT_LT(bound.covariance()(5, 5), 0.05 * Prior()(5, 5));
}

TEST(PosteriorBound, AMeasurementAddsItsInformation) {
  AbsoluteFix fix = CorridorFix();
  fix.X_WF = fix.X_RS = {};
  PosteriorBound bound(kTrue, {}, DriveIntegration::kArc, Prior());
  bound.Update({}, fix);
  for (const int i : {1, 2}) {
    const double before = Prior()(i, i);
    const double own = fix.covariance(i, i);
    EXPECT_NEAR(
        bound.covariance()(i, i), 1.0 / (1.0 / before + 1.0 / own), 1e-15);
  }
  EXPECT_EQ(bound.covariance()(0, 0), Prior()(0, 0));
  fix.has = {};
  const Matrix6 before = bound.covariance();
  bound.Update({}, fix);
  EXPECT_EQ(bound.covariance(), before);
}

TEST(PosteriorBound, RatioVarianceIsThatOfRelativeErrors) {
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  P(0, 0) = 4e-14;
  P(1, 1) = 9e-14;
  P(0, 1) = P(1, 0) = 3e-14;
  const double r = kTrue.k_right;
  const double l = kTrue.k_left;
  const double expected =
      r * r / (l * l) *
      (P(0, 0) / (r * r) + P(1, 1) / (l * l) - 2.0 * P(0, 1) / (r * l));
  EXPECT_NEAR(RatioVariance(kTrue, P), expected, 1e-12 * expected);
}

}  // namespace
}  // namespace waymark
