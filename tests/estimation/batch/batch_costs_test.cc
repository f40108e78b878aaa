#include "estimation/batch/batch_costs.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "tests/support/batch_simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace waymark {
namespace {

// Largest difference between analytic and central-difference Jacobians over
// all blocks, relative to the larger of 1 and the entry.
double JacobianGap(const ceres::CostFunction& cost,
                   std::vector<Eigen::VectorXd> blocks) {
  const int rows = cost.num_residuals();
  std::vector<
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      jacobians;
  std::vector<double*> jacobian_data;
  std::vector<double*> data;
  jacobians.reserve(blocks.size());
  for (Eigen::VectorXd& block : blocks) {
    jacobians.emplace_back(rows, block.size());
    jacobian_data.push_back(jacobians.back().data());
    data.push_back(block.data());
  }
  Eigen::VectorXd r(rows);
  EXPECT_TRUE(cost.Evaluate(data.data(), r.data(), jacobian_data.data()));
  double gap = 0.0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (Eigen::Index k = 0; k < blocks[b].size(); ++k) {
      // Small enough that a shift stays inside one reading's interval.
      constexpr double kStep = 1e-6;
      const double value = blocks[b](k);
      Eigen::VectorXd above(rows);
      Eigen::VectorXd below(rows);
      blocks[b](k) = value + kStep;
      EXPECT_TRUE(cost.Evaluate(data.data(), above.data(), nullptr));
      blocks[b](k) = value - kStep;
      EXPECT_TRUE(cost.Evaluate(data.data(), below.data(), nullptr));
      blocks[b](k) = value;
      const Eigen::VectorXd numeric = (above - below) / (2.0 * kStep);
      for (int row = 0; row < rows; ++row) {
        const double analytic = jacobians[b](row, k);
        gap = std::max(gap,
                       std::abs(analytic - numeric(row)) /
                           std::max(1.0, std::abs(analytic)));
      }
    }
  }
  return gap;
}

class BatchCosts : public testing::Test {
 protected:
  BatchCosts()
      : simulation_(SimulateBatch(Options(), MixedDriver(0.3))),
        track_(simulation_.log.encoders) {}

  static BatchSimulationOptions Options() {
    BatchSimulationOptions options;
    options.drive.duration_s = 30.0;
    return options;
  }
  Eigen::VectorXd RandomPose() {
    return Eigen::Vector3d(random_.Uniform(-3.0, 3.0),
                           random_.Uniform(-3.0, 3.0),
                           random_.Uniform(-6.0, 6.0));
  }
  Eigen::VectorXd RandomSensor() {
    return Eigen::Vector4d(random_.Uniform(-0.3, 0.3),
                           random_.Uniform(-0.3, 0.3),
                           random_.Uniform(-3.0, 3.0),
                           random_.Uniform(-0.1, 0.1));
  }
  Eigen::Matrix3d RandomCovariance() {
    Eigen::Matrix3d a;
    for (int i = 0; i < 9; ++i) a(i) = random_.Normal(0.1);
    return a * a.transpose() + 1e-2 * Eigen::Matrix3d::Identity();
  }
  KeyframeTie RandomTie() {
    KeyframeTie tie;
    tie.track = &track_;
    tie.parameters = {1e-4, 1.1e-4, 0.3};
    tie.keyframe_time = random_.Uniform(3.0, 27.0);
    // Before and after the keyframe, off the grid of readings.
    tie.sensor_time = tie.keyframe_time + random_.Uniform(-0.3, 0.3);
    return MakeTie(tie, random_.Uniform(-0.1, 0.1));
  }

  Random random_{42};
  BatchSimulation simulation_;
  TickTrack track_;
};

// Differences of step 1e-6 on whitened residuals of size 100: good to 1e-5.
constexpr double kJacobianTolerance = 1e-5;

TEST_F(BatchCosts, StepJacobiansAreTheNumericOnes) {
  const StepModel model{&track_, {1e-4, 1.1e-4, 0.3}, DriveIntegration::kArc};
  for (int i = 0; i < 50; ++i) {
    const double t0 = random_.Uniform(0.0, 25.0);
    const StepCost cost(
        model, t0, t0 + random_.Uniform(0.0, 3.0), RandomCovariance());
    const Eigen::VectorXd wheels = Eigen::Vector3d(random_.Uniform(0.8, 1.2),
                                                   random_.Uniform(0.8, 1.2),
                                                   random_.Uniform(0.8, 1.2));
    EXPECT_LT(JacobianGap(cost, {RandomPose(), RandomPose(), wheels}),
              kJacobianTolerance);
  }
}

TEST_F(BatchCosts, FixJacobiansAreTheNumericOnes) {
  for (int i = 0; i < 70; ++i) {
    AbsoluteFix fix;
    // Every combination of present components.
    const int mask = 1 + i % 7;
    fix.has = {(mask & 1) != 0, (mask & 2) != 0, (mask & 4) != 0};
    fix.value = RandomPose();
    fix.covariance = RandomCovariance();
    fix.X_WF = Pose2::FromVector(RandomPose());
    const FixCost cost(RandomTie(), fix);
    EXPECT_LT(JacobianGap(cost, {RandomPose(), RandomSensor()}),
              kJacobianTolerance);
  }
}

TEST_F(BatchCosts, MotionJacobiansAreTheNumericOnes) {
  for (int i = 0; i < 50; ++i) {
    RelativeMotion motion;
    motion.X_S0S1 = Pose2::FromVector(RandomPose());
    motion.covariance = RandomCovariance();
    const MotionCost cost(RandomTie(), RandomTie(), motion);
    EXPECT_LT(JacobianGap(cost, {RandomPose(), RandomPose(), RandomSensor()}),
              kJacobianTolerance);
  }
}

TEST_F(BatchCosts, PriorJacobiansAreTheNumericOnes) {
  const PriorCost cost(RandomPose(), RandomCovariance(), 2);
  EXPECT_LT(JacobianGap(cost, {RandomPose()}), kJacobianTolerance);
}

TEST_F(BatchCosts, ResidualsVanishAtTheTruth) {
  // Truth without drive noise.
  BatchSimulationOptions options = Options();
  options.drive.noise = {0.0, 0.0};
  const BatchSimulation exact = SimulateBatch(options, MixedDriver(0.3));
  const TickTrack track(exact.log.encoders);
  const StepCost cost({&track, options.drive.parameters},
                      2.0,
                      9.0,
                      Eigen::Matrix3d::Identity());
  const Eigen::Vector3d from = exact.truth[100].X_WR.vector();
  const Eigen::Vector3d to = exact.truth[450].X_WR.vector();
  const Eigen::Vector3d ones = Eigen::Vector3d::Ones();
  const double* blocks[] = {from.data(), to.data(), ones.data()};
  Eigen::Vector3d r;
  ASSERT_TRUE(cost.Evaluate(blocks, r.data(), nullptr));
  EXPECT_LT(r.norm(), 1e-9);
}

TEST_F(BatchCosts, RefuseAWheelBaseBelowZero) {
  const StepCost cost(
      {&track_, {1e-4, 1e-4, 0.3}}, 1.0, 2.0, Eigen::Matrix3d::Identity());
  const Eigen::Vector3d pose = Eigen::Vector3d::Zero();
  const Eigen::Vector3d wheels(1.0, 1.0, -0.1);
  const double* blocks[] = {pose.data(), pose.data(), wheels.data()};
  Eigen::Vector3d r;
  EXPECT_FALSE(cost.Evaluate(blocks, r.data(), nullptr));
}

TEST_F(BatchCosts, MotionBackwardsInTimeUndoesMotionForwards) {
  const WheelParameters wheels{1e-4, 1.1e-4, 0.3};
  for (int i = 0; i < 50; ++i) {
    const double a = random_.Uniform(-1.0, 31.0);  // Outside too.
    const double b = random_.Uniform(-1.0, 31.0);
    const double c = random_.Uniform(-1.0, 31.0);
    const auto motion = [&](double t0, double t1) {
      return track_.Integrate(t0, t1, wheels, {}, DriveIntegration::kArc)
          .X_R0R1;
    };
    const Pose2 loop = motion(a, b) * motion(b, c) * motion(c, a);
    EXPECT_LT(loop.vector().norm(), 1e-11);
  }
}

TEST_F(BatchCosts, CovarianceOfAMotionDoesNotDependOnItsPieces) {
  const WheelParameters wheels{1e-4, 1e-4, 0.3};
  const DriveNoise noise;
  const auto motion = [&](double t0, double t1) {
    return track_.Integrate(t0, t1, wheels, noise, DriveIntegration::kArc);
  };
  const TrackMotion whole = motion(2.0, 8.0);
  const TrackMotion first = motion(2.0, 4.567);
  const TrackMotion second = motion(4.567, 8.0);
  const ComposeJacobians compose =
      JacobiansOfCompose(first.X_R0R1, second.X_R0R1);
  const Eigen::Matrix3d pieced =
      compose.d_AB * first.covariance * compose.d_AB.transpose() +
      compose.d_BC * second.covariance * compose.d_BC.transpose();
  // Splitting one reading's step in two moves its lateral part by less than
  // this share.
  EXPECT_LT((whole.covariance - pieced).norm(), 1e-3 * pieced.norm());
}

TEST(TickTrack, VelocityAndTicksComeFromTheInterval) {
  std::vector<EncoderReading> readings(3);
  for (int i = 0; i < 3; ++i) {
    readings[static_cast<std::size_t>(i)].time =
        TimeFromMicroseconds(1'000'000 + 500'000 * i);
  }
  readings[1].right = 100;
  readings[1].left = 50;
  readings[2].right = 100;
  readings[2].left = 250;
  const TickTrack track(readings);
  const WheelParameters wheels{0.01, 0.01, 0.5};
  // 200 and 100 ticks a second of 0.01 m.
  EXPECT_DOUBLE_EQ(track.VelocityAt(0.2, wheels).forward, 1.5);
  EXPECT_DOUBLE_EQ(track.VelocityAt(0.2, wheels).turn_rate, 2.0);
  EXPECT_DOUBLE_EQ(track.VelocityAt(0.6, wheels).turn_rate, -8.0);
  // Beyond the readings as beside them.
  EXPECT_DOUBLE_EQ(track.VelocityAt(-0.1, wheels).forward, 1.5);
  EXPECT_DOUBLE_EQ(track.VelocityAt(1.1, wheels).turn_rate, -8.0);
  const auto turn = [&](double t0, double t1) {
    return track.Integrate(t0, t1, wheels, {}, DriveIntegration::kArc)
        .X_R0R1.heading;
  };
  EXPECT_DOUBLE_EQ(turn(-0.25, 0.0), 0.5);
  EXPECT_DOUBLE_EQ(turn(1.0, 1.25), -2.0);
  EXPECT_DOUBLE_EQ(turn(1.25, 1.0), 2.0);
  EXPECT_DOUBLE_EQ(turn(-0.25, 1.25), 0.5 + 1.0 - 4.0 - 2.0 + 2.0 * kPi);
  EXPECT_DOUBLE_EQ(track.duration(), 1.0);
  EXPECT_DOUBLE_EQ(track.Travel(wheels), 0.5 * (1.0 + 2.5));
}

TEST(TickTrack, JitterOfTheLastStampsMakesUpNoSpeed) {
  std::vector<EncoderReading> readings;
  for (int i = 0; i <= 20; ++i) {  // 20 Hz, 10 ticks each.
    readings.push_back({.time = TimeFromMicroseconds(50'000 * i),
                        .seq = i,
                        .right = 10 * i,
                        .left = 10 * i});
  }
  // The last reading's stamp lies just behind that of the one before.
  readings.back().time = readings[19].time + Duration(10);
  const TickTrack track(readings);
  const double speed =
      track.VelocityAt(2.0, WheelParameters{1e-3, 1e-3, 0.3}).forward;
  EXPECT_NEAR(speed, 0.2, 0.06);
}

}  // namespace
}  // namespace waymark
