#include "estimation/batch/batch_refiner.h"

#include "tests/support/batch_simulation.h"

#include <Eigen/LU>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

// Wheels of unequal size, so that a swap shows.
const WheelParameters kTrue{1.02e-4, 0.99e-4, 0.27};
const WheelParameters kNominal{1e-4, 1e-4, 0.25};

BatchSimulationOptions Drive(std::uint64_t seed) {
  BatchSimulationOptions options;
  options.drive.parameters = kTrue;
  options.drive.duration_s = 60.0;
  options.drive.seed = seed;
  return options;
}

BatchSimulationOptions ExactDrive() {
  BatchSimulationOptions options = Drive(1);
  options.drive.noise = {0.0, 0.0};
  options.is_exact = true;
  return options;
}

BatchOptions Options() {
  BatchOptions options;
  options.initial = kNominal;
  options.tick_sigma = 0.0;  // The simulated truth follows whole ticks.
  return options;
}

BatchResult Solve(const BatchLog& log, const BatchOptions& options) {
  return RefineBatch({&log, 1}, options);
}

// Largest relative error of a wheel parameter.
double WheelError(const BatchResult& result) {
  return (result.parameters.vector().array() / kTrue.vector().array() - 1.0)
      .abs()
      .maxCoeff();
}

// A prior so wide that it pulls by less than 1e-8.
BatchOptions WideOptions() {
  BatchOptions options = Options();
  options.relative_sigma.setConstant(20.0);
  return options;
}

BatchSensorOptions EverySensor() {
  BatchSensorOptions sensor;
  sensor.position = true;
  sensor.yaw = true;
  sensor.time_offset = true;
  sensor.sigma_position_m = 10.0;
  sensor.sigma_yaw_rad = 30.0;
  sensor.sigma_time_offset_s = 10.0;
  return sensor;
}

// What is left on exact data: stopping at 1e-6 between rounds.
constexpr double kExact = 2e-6;

TEST(BatchRefiner, ExactPoseFixesGiveTheExactWheels) {
  const BatchSimulation simulation =
      SimulateBatch(ExactDrive(), MixedDriver(0.3));
  const BatchResult result = Solve(simulation.log, WideOptions());
  ASSERT_EQ(result.status, BatchStatus::kSolved) << result.reason;
  EXPECT_LT(WheelError(result), kExact);
  EXPECT_EQ(result.inlier_share, 1.0);
  EXPECT_GT(result.observability.minCoeff(), 0.999);
}

TEST(BatchRefiner, ExactPositionsGiveWheelsAndLeverArm) {
  BatchSimulationOptions drive = ExactDrive();
  drive.has_heading = false;
  drive.X_RS = {0.08, -0.03, 0.0};
  const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  BatchOptions options = WideOptions();
  options.sensors = {EverySensor()};
  options.sensors[0].yaw = false;
  options.sensors[0].time_offset = false;
  const BatchResult result = Solve(simulation.log, options);
  ASSERT_EQ(result.status, BatchStatus::kSolved) << result.reason;
  EXPECT_LT(WheelError(result), kExact);
  ASSERT_EQ(result.sensors.size(), 1u);
  EXPECT_NEAR(result.sensors[0].X_RS.x, 0.08, kExact);
  EXPECT_NEAR(result.sensors[0].X_RS.y, -0.03, kExact);
}

// The 4 values of a mounting that every kind of measurement gives back.
void ExpectMountingRecovered(BatchSimulationOptions drive, double nominal_yaw) {
  drive.X_RS = {0.08, -0.03, 0.7};
  drive.X_RS_nominal = {0.0, 0.0, nominal_yaw};
  drive.time_offset_s = 0.037;
  const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  BatchOptions options = WideOptions();
  options.sensors = {EverySensor()};
  const BatchResult result = Solve(simulation.log, options);
  ASSERT_EQ(result.status, BatchStatus::kSolved) << result.reason;
  EXPECT_LT(WheelError(result), kExact);
  ASSERT_EQ(result.sensors.size(), 1u);
  const BatchSensor& sensor = result.sensors[0];
  EXPECT_NEAR(sensor.X_RS.x, 0.08, kExact);
  EXPECT_NEAR(sensor.X_RS.y, -0.03, kExact);
  EXPECT_NEAR(sensor.X_RS.heading, 0.7, kExact);
  EXPECT_NEAR(sensor.time_offset_s, 0.037, kExact);
  EXPECT_GT(sensor.observability.minCoeff(), 0.9);
}

TEST(BatchRefiner, ExactPoseFixesGiveMountingAndTimeOffset) {
  ExpectMountingRecovered(ExactDrive(), 0.5);
}

TEST(BatchRefiner, ExactRelativeMotionGivesMountingAndTimeOffset) {
  BatchSimulationOptions drive = ExactDrive();
  drive.fix_every = 0;
  drive.motion_every = 20;
  ExpectMountingRecovered(drive, 0.0);
}

TEST(BatchRefiner, LateralFixesInCorridorsAddToPosition) {
  // y only, in frames at two angles: as corridors give it.
  BatchSimulationOptions drive = ExactDrive();
  BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  for (std::size_t i = 0; i < simulation.log.fixes.size(); ++i) {
    AbsoluteFix& fix = simulation.log.fixes[i];
    const Pose2 X_WS = Pose2::FromVector(fix.value);
    fix.X_WF = {1.0, 2.0, i % 2 == 0 ? 0.3 : -1.2};
    fix.value = Between(fix.X_WF, X_WS).vector();
    fix.has = {false, true, i % 2 == 0};
    fix.value(0) = std::numeric_limits<double>::quiet_NaN();  // Absent.
  }
  simulation.log.start = StartPose{simulation.truth[0].time,
                                   simulation.truth[0].X_WR,
                                   1e-4 * Eigen::Matrix3d::Identity()};
  const BatchResult result = Solve(simulation.log, WideOptions());
  ASSERT_EQ(result.status, BatchStatus::kSolved) << result.reason;
  EXPECT_LT(WheelError(result), kExact);
}

// A corridor's lines: y and heading in one frame, nothing along it, no start,
// wheels assumed as far off as in Y23, and a few wild ones.
TEST(BatchRefiner, OneCorridorTeachesWheelsAndMounting) {
  BatchSimulationOptions drive = ExactDrive();
  drive.X_RS = {0.1, 0.02, 0.05};
  drive.X_RS_nominal = {0.1, 0.02, 0.0};
  drive.time_offset_s = 0.04;
  BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  for (std::size_t i = 0; i < simulation.log.fixes.size(); ++i) {
    AbsoluteFix& fix = simulation.log.fixes[i];
    const Pose2 X_WS = Pose2::FromVector(fix.value);
    fix.X_WF = {4.0, -2.0, 2.0};
    fix.value = Between(fix.X_WF, X_WS).vector();
    fix.has = {false, true, true};
    fix.value(0) = std::numeric_limits<double>::quiet_NaN();  // Absent.
    if (i % 40 == 7) fix.value(1) += 3.0;
    if (i % 40 == 8) fix.value(2) += 2.0;
  }
  simulation.log.start.reset();
  BatchOptions options = WideOptions();
  options.initial = {1.1e-4, 0.92e-4, 0.22};
  BatchSensorOptions sensor = EverySensor();
  sensor.position = false;  // A camera's place is measured by a ruler.
  options.sensors = {sensor};
  const BatchResult result = Solve(simulation.log, options);
  ASSERT_EQ(result.status, BatchStatus::kSolved) << result.reason;
  // The wild ones are left a pull of (1 / their sigmas)^2.
  EXPECT_LT(WheelError(result), 1e-4);
  ASSERT_EQ(result.sensors.size(), 1u);
  EXPECT_NEAR(result.sensors[0].X_RS.heading, 0.05, 1e-4);
  EXPECT_NEAR(result.sensors[0].time_offset_s, 0.04, 1e-4);
}

TEST(BatchRefiner, SwappedWheelsAreFoundNotHidden) {
  BatchSimulation simulation = SimulateBatch(ExactDrive(), MixedDriver(0.3));
  for (EncoderReading& reading : simulation.log.encoders) {
    std::swap(reading.left, reading.right);
  }
  const BatchResult result = Solve(simulation.log, WideOptions());
  // Turns go the wrong way: either no answer or one that fits nothing.
  EXPECT_TRUE(!HasAnswer(result.status) || result.inlier_share < 0.5)
      << NameOf(result.status) << " " << result.inlier_share;
}

TEST(BatchRefiner, ReversedWheelIsFoundNotHidden) {
  BatchSimulation simulation = SimulateBatch(ExactDrive(), MixedDriver(0.3));
  for (EncoderReading& reading : simulation.log.encoders) {
    reading.left = -reading.left;
  }
  const BatchResult result = Solve(simulation.log, WideOptions());
  EXPECT_TRUE(!HasAnswer(result.status) || result.inlier_share < 0.5)
      << NameOf(result.status) << " " << result.inlier_share;
}

TEST(BatchRefiner, OutliersLoseTheirPull) {
  BatchSimulationOptions drive = Drive(3);
  drive.drive.duration_s = 120.0;
  const BatchSimulation clean = SimulateBatch(drive, MixedDriver(0.3));
  drive.outlier_share = 0.2;
  const BatchSimulation spoilt = SimulateBatch(drive, MixedDriver(0.3));
  const BatchResult good = Solve(clean.log, Options());
  const BatchResult robust = Solve(spoilt.log, Options());
  BatchOptions plain = Options();
  plain.loss = BatchLoss::kNone;
  const BatchResult pulled = Solve(spoilt.log, plain);
  ASSERT_EQ(robust.status, BatchStatus::kSolved) << robust.reason;
  const auto moved = [&](const BatchResult& result) {
    return (result.parameters.vector() - good.parameters.vector())
        .cwiseQuotient(good.covariance.diagonal().cwiseSqrt())
        .cwiseAbs()
        .maxCoeff();
  };
  // A fifth of the data is lost: sqrt(0.25) sigma, twice that for luck.
  EXPECT_LT(moved(robust), 1.0);
  EXPECT_GT(moved(pulled), 3.0 * moved(robust));
  EXPECT_NEAR(robust.inlier_share, 0.8, 0.05);
}

TEST(BatchRefiner, StraightLineTellsThatTheBaseIsNotObservable) {
  BatchSimulationOptions drive = Drive(4);
  drive.drive.parameters = {1e-4, 1e-4, 0.27};
  const BatchSimulation simulation =
      SimulateBatch(drive, [](double, const Pose2&) {
        return DriveCommand{0.3, 0.0};
      });
  const BatchResult result = Solve(simulation.log, Options());
  EXPECT_EQ(result.status, BatchStatus::kPartly);
  EXPECT_EQ(result.reason, "not observable: wheel_base");
  EXPECT_LT(result.observability(2), 0.1);
  EXPECT_GT(result.observability(0), 0.99);
  // The prior's value, and its sigma.
  EXPECT_NEAR(result.parameters.wheel_base, 0.25, 0.02);
  EXPECT_NEAR(std::sqrt(result.covariance(2, 2)), 0.05, 0.01);
}

TEST(BatchRefiner, NoMotionGivesNoAnswer) {
  BatchSimulationOptions drive = Drive(5);
  const BatchSimulation simulation =
      SimulateBatch(drive, [](double, const Pose2&) { return DriveCommand{}; });
  const BatchResult result = Solve(simulation.log, Options());
  EXPECT_EQ(result.status, BatchStatus::kTooLittleMotion);
  EXPECT_EQ(result.parameters, kNominal);
  EXPECT_THAT(result.reason, testing::HasSubstr("less than 0.2"));
}

TEST(BatchRefiner, EmptyLogsGiveNoAnswer) {
  EXPECT_EQ(RefineBatch({}, Options()).status, BatchStatus::kNoData);
  EXPECT_EQ(Solve({}, Options()).status, BatchStatus::kNoData);
  BatchSimulation simulation = SimulateBatch(Drive(6), MixedDriver(0.3));
  BatchLog no_fixes = simulation.log;
  no_fixes.fixes.clear();
  EXPECT_EQ(Solve(no_fixes, Options()).status, BatchStatus::kNoData);
  BatchLog no_encoders = simulation.log;
  no_encoders.encoders.clear();
  const BatchResult result = Solve(no_encoders, Options());
  EXPECT_EQ(result.status, BatchStatus::kNoData);
  EXPECT_EQ(result.num_refused, static_cast<int>(no_encoders.fixes.size()));
}

TEST(BatchRefiner, OneFixTeachesNothing) {
  BatchSimulation simulation = SimulateBatch(Drive(7), MixedDriver(0.3));
  simulation.log.fixes.resize(1);
  const BatchResult result = Solve(simulation.log, Options());
  EXPECT_EQ(result.status, BatchStatus::kNotObservable);
  for (int i = 0; i < 3; ++i) {
    const double sigma =
        Options().relative_sigma(i) * Options().initial.vector()(i);
    EXPECT_DOUBLE_EQ(result.covariance(i, i), sigma * sigma);
  }
  EXPECT_EQ(result.parameters, kNominal);
  EXPECT_LT(result.observability.maxCoeff(), 1e-3);
}

TEST(BatchRefiner, BadMeasurementsAreCountedAndLeftOut) {
  const BatchSimulation simulation = SimulateBatch(Drive(8), MixedDriver(0.3));
  BatchLog spoilt = simulation.log;
  const auto spoil = [&](auto change) {
    AbsoluteFix fix = simulation.log.fixes[5];
    change(&fix);
    spoilt.fixes.push_back(fix);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  spoil([&](AbsoluteFix* fix) { fix->value(1) = kNan; });
  spoil([&](AbsoluteFix* fix) { fix->covariance(0, 0) = kNan; });
  spoil([](AbsoluteFix* fix) { fix->covariance.setZero(); });
  spoil([](AbsoluteFix* fix) { fix->has = {false, false, false}; });
  spoil([&](AbsoluteFix* fix) { fix->X_RS.x = kNan; });
  spoil([](AbsoluteFix* fix) { fix->time += DurationFromSeconds(1e4); });
  // By a head that was turned.
  spoil([](AbsoluteFix* fix) { fix->X_RS.heading += 0.3; });
  RelativeMotion backwards;
  backwards.source = "sensor";
  backwards.from = simulation.log.encoders[20].time;
  backwards.time = simulation.log.encoders[10].time;
  spoilt.motions.push_back(backwards);
  // A reading that goes back in time.
  EncoderReading reading = spoilt.encoders[3];
  reading.left += 100000;
  spoilt.encoders.insert(spoilt.encoders.begin() + 50, reading);
  const BatchResult clean = Solve(simulation.log, Options());
  const BatchResult result = Solve(spoilt, Options());
  EXPECT_EQ(result.num_refused, 9);
  EXPECT_EQ(result.parameters, clean.parameters);  // To the bit.
}

TEST(BatchRefiner, DuplicateTimesKeepTheLaterReading) {
  BatchSimulation simulation = SimulateBatch(ExactDrive(), MixedDriver(0.3));
  const BatchResult clean = Solve(simulation.log, Options());
  EncoderReading stale = simulation.log.encoders[100];
  stale.left -= 40;
  simulation.log.encoders.insert(simulation.log.encoders.begin() + 100, stale);
  EXPECT_EQ(Solve(simulation.log, Options()).parameters, clean.parameters);
}

TEST(BatchRefiner, ImpossibleOptionsAreNamed) {
  BatchOptions options = Options();
  options.initial.wheel_base = -0.1;
  EXPECT_THAT([&] { (void)RefineBatch({}, options); },
              testing::ThrowsMessage<std::invalid_argument>(
                  "batch: initial.wheel_base = -0.1 is not above 0"));
  options = Options();
  options.relative_sigma(1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)RefineBatch({}, options), std::invalid_argument);
}

TEST(BatchRefiner, TwoLogsShareWheelsAndKeepTheirMountings) {
  BatchSimulationOptions a = ExactDrive();
  a.X_RS = {0.08, -0.03, 0.2};
  a.source = "laser";
  BatchSimulationOptions b = ExactDrive();
  b.drive.start = {4.0, -2.0, 2.0};
  b.X_RS = {-0.05, 0.01, -1.4};
  b.source = "laser";
  b.fix_every = 0;
  b.motion_every = 20;
  const std::vector<BatchLog> logs{SimulateBatch(a, MixedDriver(0.3)).log,
                                   SimulateBatch(b, MixedDriver(0.25)).log};
  BatchOptions options = WideOptions();
  options.sensors = {EverySensor()};
  options.sensors[0].shared = false;
  const BatchResult result = RefineBatch(logs, options);
  ASSERT_EQ(result.status, BatchStatus::kSolved) << result.reason;
  EXPECT_LT(WheelError(result), kExact);
  ASSERT_EQ(result.sensors.size(), 2u);
  EXPECT_EQ(result.sensors[0].log, 0);
  EXPECT_EQ(result.sensors[1].log, 1);
  EXPECT_NEAR(result.sensors[0].X_RS.heading, 0.2, kExact);
  EXPECT_NEAR(result.sensors[1].X_RS.heading, -1.4, kExact);
  EXPECT_NEAR(result.sensors[1].X_RS.x, -0.05, kExact);
}

TEST(BatchRefiner, TwoLogsTellMoreThanOne) {
  std::vector<BatchLog> logs;
  for (std::uint64_t seed = 20; seed < 22; ++seed) {
    logs.push_back(SimulateBatch(Drive(seed), MixedDriver(0.3)).log);
  }
  const BatchResult one = Solve(logs[0], Options());
  const BatchResult both = RefineBatch(logs, Options());
  // Twice the data, half the variance.
  EXPECT_NEAR(both.covariance(2, 2) / one.covariance(2, 2), 0.5, 0.1);
}

TEST(BatchRefiner, WorldFrameDoesNotMatter) {
  BatchSimulationOptions drive = Drive(9);
  const BatchResult a =
      Solve(SimulateBatch(drive, MixedDriver(0.3)).log, Options());
  BatchLog turned = SimulateBatch(drive, MixedDriver(0.3)).log;
  const Pose2 X_VW{100.0, -50.0, 2.5};
  for (AbsoluteFix& fix : turned.fixes) {
    fix.value = (X_VW * Pose2::FromVector(fix.value)).vector();
  }
  const BatchResult b = Solve(turned, Options());
  // Up to where the rounds stop.
  EXPECT_LT((a.parameters.vector() - b.parameters.vector())
                .cwiseQuotient(a.parameters.vector())
                .cwiseAbs()
                .maxCoeff(),
            kExact);
}

TEST(BatchRefiner, SameInputGivesTheSameBits) {
  const BatchSimulation simulation = SimulateBatch(Drive(10), MixedDriver(0.3));
  const BatchResult a = Solve(simulation.log, Options());
  const BatchResult b = Solve(simulation.log, Options());
  EXPECT_EQ(a.parameters, b.parameters);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.final_cost, b.final_cost);
}

TEST(BatchRefiner, ErrorsAreAsLargeAsPredicted) {
  // A quick form of bench batch-sim: the sum of n normalised squares of three
  // parameters is chi-squared with 3 n degrees of freedom.
  constexpr int kNumSeeds = 16;
  double squares = 0.0;
  Eigen::Vector3d ratio = Eigen::Vector3d::Zero();
  for (std::uint64_t seed = 100; seed < 100 + kNumSeeds; ++seed) {
    const BatchSimulationOptions drive = Drive(seed);
    const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
    const BatchOptions options = Options();
    const BatchResult result = Solve(simulation.log, options);
    ASSERT_EQ(result.status, BatchStatus::kSolved);
    const Eigen::Vector3d error = result.parameters.vector() - kTrue.vector();
    squares += error.dot(result.covariance.inverse() * error);
    const Eigen::Vector3d prior =
        options.relative_sigma.cwiseProduct(kNominal.vector());
    const Eigen::Vector3d bound =
        CramerRaoBound(drive, simulation, prior, {}).diagonal().head<3>();
    ratio += error.cwiseAbs2().cwiseQuotient(bound);
  }
  // The 99.9 % band of chi-squared with 48 degrees of freedom: one of these
  // tests in a thousand fails by bad luck, and seeds are fixed.
  EXPECT_GT(squares, 22.7);
  EXPECT_LT(squares, 85.6);
  ratio = (ratio / kNumSeeds).cwiseSqrt();
  // The relative spread of an RMS over 16 seeds is 18 %.
  EXPECT_LT(ratio.maxCoeff(), 1.5) << ratio.transpose();
  EXPECT_GT(ratio.minCoeff(), 0.5) << ratio.transpose();
}

TEST(BatchRefiner, StatedCovarianceOfRelativeMotionIsTheBound) {
  // With mounting and time offset asked for, whose keyframes move while it is
  // solved: a measurement tied to the wrong keyframe shows here at once.
  BatchSimulationOptions drive = Drive(0);
  drive.fix_every = 0;
  drive.motion_every = 17;
  drive.sigma_m = 0.002;
  drive.sigma_rad = 0.002;
  drive.X_RS = {0.08, -0.03, 0.7};
  drive.X_RS_nominal = {0.0, 0.0, 0.6};
  drive.time_offset_s = 0.03;
  BatchOptions options = Options();
  BatchSensorOptions sensor;
  sensor.position = true;
  sensor.yaw = true;
  sensor.time_offset = true;
  options.sensors = {sensor};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    drive.drive.seed = seed;
    const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
    const BatchResult result = Solve(simulation.log, options);
    ASSERT_EQ(result.status, BatchStatus::kSolved) << result.reason;
    const Eigen::Matrix<double, 7, 7> bound =
        CramerRaoBound(drive,
                       simulation,
                       options.relative_sigma.cwiseProduct(kNominal.vector()),
                       options.sensors[0]);
    Eigen::Matrix<double, 7, 1> stated;
    stated << result.covariance.diagonal(),
        result.sensors.at(0).covariance.diagonal();
    for (int i = 0; i < 7; ++i) {
      // Linearised about the estimate here, about the truth there.
      EXPECT_NEAR(stated(i) / bound(i, i), 1.0, 0.05) << i << ", " << seed;
    }
    // 528 degrees of freedom: three sigmas of their mean square are 0.19.
    EXPECT_NEAR(result.variance_factor, 1.0, 0.19) << seed;
    // Of 70 motions less than one in ten runs lies beyond the gate.
    EXPECT_GT(result.sensors[0].num_inliers,
              result.sensors[0].num_measurements - 3);
  }
}

}  // namespace
}  // namespace waymark
