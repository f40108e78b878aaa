#include "estimation/filter/odometry_ekf.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "tests/support/drive_simulation.h"

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace waymark {
namespace {

using testing::HasSubstr;
using Matrix6 = OdometryEkf::Matrix6;
using Vector6 = OdometryEkf::Vector6;

constexpr WheelParameters kParameters{1.1e-4, 0.9e-4, 0.27};

Eigen::Matrix3d PoseCovariance() {
  return Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();
}

Eigen::Matrix3d ParameterCovariance() {
  return Eigen::Vector3d(1e-11, 1e-11, 4e-4).asDiagonal();
}

OdometryEkf MakeFilter(const OdometryEkfOptions& options = {}) {
  return {options, {}, PoseCovariance(), kParameters, ParameterCovariance()};
}

AbsoluteFix FullFix() {
  AbsoluteFix fix;
  fix.has = {true, true, true};
  fix.covariance = Eigen::Vector3d(9e-4, 9e-4, 1e-4).asDiagonal();
  return fix;
}

TEST(DriveParameters, FormsConvertAndTheirJacobiansMatchDifferences) {
  for (const ParameterForm form :
       {ParameterForm::kTravel, ParameterForm::kTurn}) {
    const Eigen::Vector3d q = FormFromParameters(kParameters, form);
    const WheelParameters back = ParametersFromForm(q, form);
    EXPECT_LT((back.vector() - kParameters.vector()).norm(), 1e-15);
    const Eigen::Matrix3d J = ParametersByForm(q, form);
    for (int k = 0; k < 3; ++k) {
      const double h = 1e-6 * q(k);
      Eigen::Vector3d d = Eigen::Vector3d::Zero();
      d(k) = h;
      const Eigen::Vector3d numeric =
          (ParametersFromForm(q + d, form).vector() -
           ParametersFromForm(q - d, form).vector()) /
          (2 * h);
      EXPECT_LT((numeric - J.col(k)).norm(), 1e-8 * (1 + J.col(k).norm()));
    }
    EXPECT_TRUE((J * FormByParameters(q, form))
                    .isApprox(Eigen::Matrix3d::Identity(), 1e-12));
  }
}

// The filter's transition by the parameters, against differences.
TEST(OdometryEkf, CovarianceOfAPredictionMatchesDifferences) {
  for (const ParameterForm form :
       {ParameterForm::kTravel, ParameterForm::kTurn}) {
    OdometryEkfOptions options;
    options.form = form;
    options.noise = {0, 0};
    OdometryEkf ekf(options,
                    {1, 2, 0.7},
                    Eigen::Matrix3d::Zero(),
                    kParameters,
                    ParameterCovariance());
    const WheelTicks ticks{3000, 1000};
    ekf.Predict(ticks, 0.1);
    Eigen::Matrix3d J;
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d d = Eigen::Vector3d::Zero();
      d(k) = 1e-6 * kParameters.vector()(k);
      const auto moved = [&](double sign) -> Eigen::Vector3d {
        return (Pose2{1, 2, 0.7} *
                IntegrateTicks(ticks,
                               WheelParameters::FromVector(
                                   kParameters.vector() + sign * d),
                               {},
                               options.integration)
                    .X_R0R1)
            .vector();
      };
      J.col(k) = (moved(1) - moved(-1)) / (2 * d(k));
    }
    const Eigen::Matrix3d expected = J * ParameterCovariance() * J.transpose();
    EXPECT_LT((ekf.pose_covariance() - expected).norm(),
              1e-6 * expected.norm());
    EXPECT_LT((ekf.parameter_covariance() - ParameterCovariance())
                  .cwiseQuotient(Eigen::Matrix3d::Constant(1e-3))
                  .norm(),
              1e-9);
  }
}

TEST(OdometryEkf, UpdateMovesTowardTheMeasurement) {
  OdometryEkf ekf = MakeFilter();
  AbsoluteFix fix = FullFix();
  fix.value = {0.02, -0.02, 0.01};
  ekf.Update(fix);
  EXPECT_GT(ekf.X_WR().x, 0);
  EXPECT_LT(ekf.X_WR().y, 0);
  EXPECT_GT(ekf.X_WR().heading, 0);
  EXPECT_LT(ekf.X_WR().x, 0.02);
  EXPECT_LT(ekf.pose_covariance()(0, 0), 1e-4);
}

// A turn that ends too far to the left means: base smaller than believed.
TEST(OdometryEkf, HeadingAfterATurnCorrectsTheBase) {
  OdometryEkf ekf = MakeFilter();
  ekf.Predict({2000, -2000}, 1);
  AbsoluteFix fix = FullFix();
  fix.has = {false, false, true};
  fix.covariance(2, 2) = 1e-6;
  fix.value(2) = ekf.X_WR().heading + 0.1;
  ekf.Update(fix);
  EXPECT_LT(ekf.parameters().wheel_base, kParameters.wheel_base);
  EXPECT_GT(ekf.observability()(2), 0.5);
}

TEST(OdometryEkf, HeadingInnovationIsWrapped) {
  OdometryEkf ekf(
      {}, {0, 0, 3.1}, PoseCovariance(), kParameters, ParameterCovariance());
  AbsoluteFix fix = FullFix();
  fix.value = {0, 0, -3.1};
  ekf.Update(fix);
  EXPECT_GT(std::abs(ekf.X_WR().heading), 3.1);
}

TEST(OdometryEkf, ConsideredParametersStay) {
  OdometryEkfOptions options;
  options.estimate_parameters = false;
  OdometryEkf ekf = MakeFilter(options);
  Random random(2);
  AbsoluteFix fix = FullFix();
  for (int i = 0; i < 200; ++i) {
    ekf.Predict({random.Uniform(0, 2000), random.Uniform(0, 2000)}, 0.1);
    fix.value = ekf.X_WR().vector() + Eigen::Vector3d::Constant(0.01);
    ekf.Update(fix);
  }
  EXPECT_EQ(ekf.fault(), "");
  EXPECT_LT((ekf.parameters().vector() - kParameters.vector()).norm(), 1e-15);
  EXPECT_NEAR(ekf.parameter_covariance()(2, 2), 4e-4, 1e-9);
}

TEST(OdometryEkf, ObservabilityIsZeroWithoutMeasurementsAndGrows) {
  OdometryEkfOptions options;
  options.walk.per_sqrt_metre = Eigen::Vector3d::Constant(1e-3);
  OdometryEkf ekf = MakeFilter(options);
  const double before = ekf.parameter_covariance()(2, 2);
  for (int i = 0; i < 100; ++i) ekf.Predict({900, 1100}, 0.1);
  // The walk widens prior and posterior alike.
  EXPECT_GT(ekf.parameter_covariance()(2, 2), before);
  EXPECT_LT(ekf.observability().maxCoeff(), 1e-9);
  // Straight ahead: the travels show, the base does not.
  OdometryEkf straight = MakeFilter();
  straight.Predict({10'000 / 1.1, 10'000 / 0.9}, 1);
  straight.Update(FullFix());
  EXPECT_GT(straight.observability()(0), 0.1);
  EXPECT_LT(straight.observability()(2), 1e-6);
}

// Must show: an update that would break the covariance stops with a fault,
// never a wrong pose.
TEST(OdometryEkf, BreakingUpdateStopsWithAFault) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* name;
    Eigen::Vector3d value;
    double variance;
  };
  for (const Case& c : {Case{"negative variance", {0.01, 0, 0}, -1e-3},
                        Case{"variance nan", {0.01, 0, 0}, nan},
                        Case{"value nan", {nan, 0, 0}, 1e-4},
                        Case{"value infinite",
                             {std::numeric_limits<double>::infinity(), 0, 0},
                             1e-4}}) {
    OdometryEkf ekf = MakeFilter();
    ekf.Predict({1000, 1000}, 0.1);
    const Pose2 before = ekf.X_WR();
    const Matrix6 covariance = ekf.covariance();
    AbsoluteFix fix = FullFix();
    fix.value = c.value;
    fix.covariance = c.variance * Eigen::Matrix3d::Identity();
    ekf.Update(fix);
    EXPECT_THAT(ekf.fault(), HasSubstr("filter stopped: update")) << c.name;
    // Nothing moves any more, not even by good measurements.
    ekf.Predict({1000, 1000}, 0.1);
    ekf.Update(FullFix());
    EXPECT_EQ(ekf.X_WR(), before) << c.name;
    EXPECT_EQ(ekf.covariance(), covariance) << c.name;
  }
}

TEST(OdometryEkf, ParametersThatTurnNegativeAreAFault) {
  OdometryEkf ekf({},
                  {},
                  PoseCovariance(),
                  kParameters,
                  Eigen::Vector3d(1e-8, 1e-8, 1).asDiagonal());
  ekf.Predict({10'000, 10'000}, 1);
  AbsoluteFix fix = FullFix();
  fix.value = {-50, 0, 0};
  ekf.Update(fix);
  EXPECT_THAT(ekf.fault(), HasSubstr("not positive"));
  EXPECT_GT(ekf.parameters().k_right, 0);
}

TEST(OdometryEkf, CovarianceFaultNamesWhatIsWrong) {
  Matrix6 P = Matrix6::Identity();
  EXPECT_EQ(CovarianceFault(P), "");
  EXPECT_EQ(CovarianceFault(Matrix6::Zero()), "");
  P(1, 0) = 0.5;
  EXPECT_THAT(CovarianceFault(P), HasSubstr("symmetric"));
  P(0, 1) = 0.5;
  EXPECT_EQ(CovarianceFault(P), "");
  P(0, 1) = P(1, 0) = 1.01;
  EXPECT_THAT(CovarianceFault(P), HasSubstr("not positive"));
  P(2, 2) = -1e-12;
  EXPECT_THAT(CovarianceFault(P), HasSubstr("negative"));
  P(3, 3) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(CovarianceFault(P), HasSubstr("finite"));
}

// Row Y13: what is believed after a path does not depend on how often the
// wheels were read.
TEST(OdometryEkf, ReadingRateDoesNotMatter) {
  OdometryEkfOptions options;
  options.walk.per_sqrt_metre = Eigen::Vector3d::Constant(1e-3);
  options.walk.per_sqrt_second = Eigen::Vector3d::Constant(1e-3);
  const auto run = [&](int steps_per_leg) {
    OdometryEkf ekf = MakeFilter(options);
    for (int leg = 0; leg < 40; ++leg) {
      const WheelTicks ticks{leg % 2 == 0 ? 9000.0 : 5000.0, 7000.0};
      for (int i = 0; i < steps_per_leg; ++i) {
        ekf.Predict({ticks.right / steps_per_leg, ticks.left / steps_per_leg},
                    1.0 / steps_per_leg);
      }
      AbsoluteFix fix = FullFix();
      fix.value = {0.3 * leg, 0.1, 0.2};
      fix.covariance *= 100;
      ekf.Update(fix);
    }
    return ekf;
  };
  const OdometryEkf coarse = run(20);
  const OdometryEkf fine = run(500);
  // The first-order covariance of a step of 20 to the leg is off by the
  // step's own lever, some hundredths of what a leg adds.
  const Matrix6 a = coarse.covariance();
  const Matrix6 b = fine.covariance();
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(a(i, i) / b(i, i), 1, 0.02) << i;
  }
  EXPECT_LT((coarse.X_WR().position() - fine.X_WR().position()).norm(), 0.002);
}

// Consistency over drives: 95 % bands of the mean normalised error squared of
// 200 seeds hold at 90 % of the time steps or more.
TEST(OdometryEkf, NormalisedErrorsStayInTheirBand) {
  constexpr int kSeeds = 200;
  constexpr int kReadingsPerFix = 5;
  std::vector<double> pose_nees;
  std::vector<double> state_nees;
  for (int seed = 0; seed < kSeeds; ++seed) {
    DriveSimulationOptions drive;
    drive.parameters = kParameters;
    drive.noise = {1e-5, 1e-7};
    drive.rate_hz = 10;
    drive.duration_s = 60;
    drive.seed = 1000 + static_cast<std::uint64_t>(seed);
    // No look at the truth: ticks that answer the noise between two fixes
    // would tell more than the model says.
    const auto readings = SimulateDrive(drive, [](double t, const Pose2&) {
      return DriveCommand{0.4, std::sin(0.7 * t)};
    });
    Random random(drive.seed * 7919);
    const Eigen::Matrix3d P = ParameterCovariance();
    const auto drawn = [&](const Eigen::Matrix3d& C) {
      return Eigen::Vector3d(random.Normal(std::sqrt(C(0, 0))),
                             random.Normal(std::sqrt(C(1, 1))),
                             random.Normal(std::sqrt(C(2, 2))));
    };
    const WheelParameters start =
        WheelParameters::FromVector(kParameters.vector() + drawn(P));
    OdometryEkfOptions options;
    options.noise = drive.noise;
    OdometryEkf ekf(options,
                    Pose2::FromVector(drawn(PoseCovariance())),
                    PoseCovariance(),
                    start,
                    P);
    pose_nees.resize(readings.size() - 1);
    state_nees.resize(readings.size() - 1);
    AbsoluteFix fix = FullFix();
    for (std::size_t i = 1; i < readings.size(); ++i) {
      ekf.Predict({readings[i].right_ticks - readings[i - 1].right_ticks,
                   readings[i].left_ticks - readings[i - 1].left_ticks},
                  0.1);
      if (i % kReadingsPerFix == 0) {
        fix.value = readings[i].X_WR.vector() + drawn(fix.covariance);
        ekf.Update(fix);
      }
      Vector6 e;
      e.head<3>() = ekf.X_WR().vector() - readings[i].X_WR.vector();
      e(2) = WrapAngle(e(2));
      e.tail<3>() = ekf.parameters().vector() - kParameters.vector();
      const Matrix6 C = ekf.covariance();
      pose_nees[i - 1] +=
          e.head<3>().dot(C.topLeftCorner<3, 3>().ldlt().solve(e.head<3>()));
      const Vector6 s = C.diagonal().cwiseSqrt().cwiseInverse();
      const Matrix6 scaled = s.asDiagonal() * C * s.asDiagonal();
      const Vector6 e_scaled = s.cwiseProduct(e);
      state_nees[i - 1] += e_scaled.dot(scaled.ldlt().solve(e_scaled));
    }
    ASSERT_EQ(ekf.fault(), "") << "seed " << drive.seed;
  }
  // Mean of n chi-squares of k degrees is normal to k +- sqrt(2 k / n).
  const auto share_inside = [&](const std::vector<double>& sums, double k) {
    const double half = 1.96 * std::sqrt(2.0 * k / kSeeds);
    int inside = 0;
    for (const double sum : sums) {
      if (std::abs(sum / kSeeds - k) <= half) ++inside;
    }
    return static_cast<double>(inside) / static_cast<double>(sums.size());
  };
  const double pose = share_inside(pose_nees, 3);
  const double state = share_inside(state_nees, 6);
  RecordProperty("pose_share", std::to_string(pose));
  RecordProperty("state_share", std::to_string(state));
  std::printf(
      "inside the band: pose %.3f, state %.3f of the steps\n", pose, state);
  EXPECT_GE(pose, 0.90);
  EXPECT_GE(state, 0.90);
}

}  // namespace
}  // namespace waymark
