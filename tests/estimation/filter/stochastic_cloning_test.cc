// Relative motions in the bare Kalman filter: consistency, mountings.
#include "estimation/base/random.h"
#include "estimation/filter/odometry_ekf.h"
#include "estimation/geometry/angle.h"
#include "tests/support/motion_scene.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

using Vector6 = OdometryEkf::Vector6;
using Matrix6 = OdometryEkf::Matrix6;

// The bare filter over readings and motions, which start and end at readings.
void FeedEkf(const BatchLog& log, OdometryEkf* ekf) {
  auto next = log.motions.begin();
  for (std::size_t i = 0; i < log.encoders.size(); ++i) {
    const EncoderReading& now = log.encoders[i];
    if (i > 0) {
      const EncoderReading& last = log.encoders[i - 1];
      ekf->Predict({static_cast<double>(now.right - last.right),
                    static_cast<double>(now.left - last.left)},
                   Seconds(now.time - last.time));
    }
    if (next != log.motions.end() && next->time == now.time) {
      ekf->Update(*next++);
    }
    ekf->DropClones(now.time + Duration(1));
    if (next != log.motions.end() && next->from == now.time) {
      ekf->AddClone(now.time, next->time);
    }
  }
  EXPECT_TRUE(next == log.motions.end());
}

double NormalisedErrorSquared(const OdometryEkf& ekf, const Pose2& X_WR) {
  Vector6 e;
  e << ekf.X_WR().vector() - X_WR.vector(),
      ekf.parameters().vector() - kMotionWheels.vector();
  e(2) = WrapAngle(e(2));
  // Scaled: metres and micrometres do not share a factorisation.
  const Matrix6 P = ekf.covariance();
  const Vector6 scale = P.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6 C = scale.asDiagonal() * P * scale.asDiagonal();
  return e.cwiseProduct(scale).dot(C.ldlt().solve(e.cwiseProduct(scale)));
}

// Must show: normalised error squared of (pose, parameters) in its 95 % band,
// with a mounting that is exact and with one that is off by what is stated.
TEST(StochasticCloning, IsConsistentOver100Seeds) {
  constexpr int kSeeds = 100;
  const Eigen::Vector3d share(0.02, 0.02, 0.05);
  for (const double mounting_sigma : {0.0, 1.0}) {
    double sum = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const auto hashed = Random(static_cast<std::uint64_t>(seed)).Bits();
      Random random(hashed + 1);
      BatchSimulationOptions drive = MotionDrive(hashed);
      drive.drive.duration_s = 24.0;
      OdometryEkfOptions options;
      options.mounting_position_sigma *= mounting_sigma;
      options.mounting_yaw_sigma *= mounting_sigma;
      drive.X_RS.x += random.Normal(options.mounting_position_sigma);
      drive.X_RS.y += random.Normal(options.mounting_position_sigma);
      drive.X_RS.heading += random.Normal(options.mounting_yaw_sigma);
      const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
      // The start is where the simulation starts, but for this error.
      const Pose2 start{
          random.Normal(0.01), random.Normal(0.01), random.Normal(0.01)};
      Eigen::Vector3d scale;
      for (int k = 0; k < 3; ++k) scale(k) = 1.0 + random.Normal(share(k));
      OdometryEkf ekf(
          options,
          start,
          1e-4 * Eigen::Matrix3d::Identity(),
          Scaled(kMotionWheels, scale),
          kMotionWheels.vector().cwiseProduct(share).cwiseAbs2().asDiagonal());
      if (mounting_sigma > 0.0) ekf.AddMounting(drive.source);
      FeedEkf(simulation.log, &ekf);
      ASSERT_EQ(ekf.fault(), "") << seed;
      sum += NormalisedErrorSquared(ekf, simulation.truth.back().X_WR);
    }
    // Chi-square of 600 degrees over 600, 95 %.
    EXPECT_GT(sum / (6 * kSeeds), 0.890) << mounting_sigma;
    EXPECT_LT(sum / (6 * kSeeds), 1.116) << mounting_sigma;
  }
}

OdometryEkf MountingEkf(const WheelParameters& parameters,
                        double share,
                        bool is_estimated) {
  OdometryEkfOptions options;
  options.noise = {1e-9, 1e-11};
  OdometryEkf ekf(options,
                  {},
                  1e-8 * Eigen::Matrix3d::Identity(),
                  parameters,
                  (share * parameters.vector()).cwiseAbs2().asDiagonal());
  if (is_estimated) ekf.AddMounting(BatchSimulationOptions{}.source);
  return ekf;
}

TEST(StochasticCloning, ExactMotionsTeachTheMounting) {
  BatchSimulationOptions drive = ExactMotionDrive();
  const Pose2 off{0.006, -0.004, 0.03};
  drive.X_RS = Pose2::FromVector(kMotionMounting.vector() + off.vector());
  const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  const WheelParameters& truth = drive.drive.parameters;
  OdometryEkf ekf = MountingEkf(Scaled(truth, {1.05, 0.96, 0.92}), 0.05, true);
  FeedEkf(simulation.log, &ekf);
  ASSERT_EQ(ekf.fault(), "");
  // What the linearisation of the first motions leaves of 8 % and 6 mm.
  EXPECT_LT((ekf.parameters().vector() - truth.vector())
                .cwiseQuotient(truth.vector())
                .cwiseAbs()
                .maxCoeff(),
            2e-3);
  const Eigen::Vector3d error = ekf.mounting_error(drive.source) - off.vector();
  EXPECT_LT(error.cwiseAbs().maxCoeff(), 5e-4);
}

// Always to the left, a sensor 6 mm ahead of its stated place looks like one
// wheel larger and one smaller: what cannot be told must stay uncertain.
TEST(StochasticCloning, MountingIsNotTakenForWheels) {
  BatchSimulationOptions drive = ExactMotionDrive();
  drive.X_RS.y += 0.006;
  const BatchSimulation simulation =
      SimulateBatch(drive, CircleDriver(0.1, 0.2));
  const WheelParameters& truth = drive.drive.parameters;
  for (const bool is_estimated : {true, false}) {
    OdometryEkf ekf = MountingEkf(truth, 0.05, is_estimated);
    FeedEkf(simulation.log, &ekf);
    ASSERT_EQ(ekf.fault(), "");
    const double sigmas = std::abs(ekf.parameters().k_right - truth.k_right) /
                          std::sqrt(ekf.parameter_covariance()(0, 0));
    if (is_estimated) {
      EXPECT_LT(sigmas, 2.0);
    } else {
      EXPECT_GT(sigmas, 3.0);
    }
  }
}

}  // namespace
}  // namespace waymark
