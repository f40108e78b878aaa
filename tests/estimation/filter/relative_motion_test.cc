// What relative motions do to the filter: stochastic cloning, the gate, the
// wheel parameters without any absolute fix.
#include "estimation/base/random.h"
#include "estimation/filter/odometry_filter.h"
#include "estimation/geometry/angle.h"
#include "tests/support/batch_simulation.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <vector>

namespace waymark {
namespace {

using Vector6 = OdometryEkf::Vector6;
using Matrix6 = OdometryEkf::Matrix6;

constexpr WheelParameters kTrue{1.03e-4, 0.97e-4, 0.27};
const Pose2 kMounting{0.1, -0.04, 1.2};

BatchSimulationOptions Drive(std::uint64_t seed) {
  BatchSimulationOptions options;
  options.drive.parameters = kTrue;
  options.drive.rate_hz = 20.0;
  options.drive.duration_s = 48.0;
  options.drive.seed = seed;
  options.fix_every = 0;
  options.motion_every = 10;
  options.X_RS = options.nominal_X_RS = kMounting;
  options.sigma_m = 2e-3;
  options.sigma_rad = 3e-3;
  return options;
}

// Without noise, and ticks so fine that whole ones are exact.
BatchSimulationOptions ExactDrive() {
  BatchSimulationOptions options = Drive(1);
  options.drive.noise = {0.0, 0.0};
  options.drive.parameters.k_right *= 1e-4;
  options.drive.parameters.k_left *= 1e-4;
  options.is_exact = true;
  return options;
}

OdometryFilterOptions Options(const WheelParameters& parameters) {
  OdometryFilterOptions options;
  options.parameters = parameters;
  options.start = InitialPose{};
  options.ekf.mounting_position_sigma = 0.0;
  options.ekf.mounting_yaw_sigma = 0.0;
  return options;
}

// All events of a log in the order of DelayedFusion.
void Feed(const BatchLog& log,
          OdometryFilter* filter,
          const std::function<void(const EncoderReading&)>& each = {}) {
  using Measurement = OdometryFilter::Measurement;
  std::vector<std::tuple<Time, int, Measurement>> events;
  for (const AbsoluteFix& fix : log.fixes) {
    events.emplace_back(fix.time, 0, fix);
  }
  for (const RelativeMotion& motion : log.motions) {
    events.emplace_back(motion.time, 1, motion);
    events.emplace_back(motion.from, 2, MotionStart{motion.time});
  }
  std::stable_sort(
      events.begin(), events.end(), [](const auto& a, const auto& b) {
        return std::pair(std::get<0>(a), std::get<1>(a)) <
               std::pair(std::get<0>(b), std::get<1>(b));
      });
  auto next = events.begin();
  for (const EncoderReading& reading : log.encoders) {
    for (; next != events.end() && std::get<0>(*next) <= reading.time; ++next) {
      filter->Add(std::get<0>(*next), std::get<2>(*next));
    }
    filter->AddReading(reading, 0);
    if (each) each(reading);
  }
}

double LargestShareOff(const OdometryFilter& filter,
                       const WheelParameters& truth) {
  return (filter.parameters().parameters.vector() - truth.vector())
      .cwiseQuotient(truth.vector())
      .cwiseAbs()
      .maxCoeff();
}

WheelParameters Scaled(const WheelParameters& p, const Eigen::Vector3d& by) {
  return WheelParameters::FromVector(p.vector().cwiseProduct(by));
}

double DistanceOff(const OdometryFilter& filter, const Pose2& truth) {
  return (filter.estimate().X_WR.position() - truth.position()).norm();
}

TEST(RelativeMotion, ExactMotionsTeachTheWheelsWithoutAnyFix) {
  const BatchSimulationOptions drive = ExactDrive();
  const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  OdometryFilterOptions options =
      Options(Scaled(drive.drive.parameters, {1.05, 0.96, 0.92}));
  options.ekf.noise = {1e-9, 1e-11};
  OdometryFilter filter(options);
  Feed(simulation.log, &filter);
  ASSERT_EQ(filter.fault(), "");
  EXPECT_EQ(filter.counts().num_accepted,
            static_cast<std::int64_t>(simulation.log.motions.size()));
  EXPECT_EQ(filter.counts().num_unused, 0);
  // What the linearisation of the first motions leaves of 8 %.
  EXPECT_LT(LargestShareOff(filter, drive.drive.parameters), 1e-4);
  EXPECT_GT(filter.parameters().observability.minCoeff(), 0.999);
  // 14 m of path, with the first second driven on wrong wheels.
  EXPECT_LT(DistanceOff(filter, simulation.truth.back().X_WR), 0.01);

  OdometryFilter without(options);
  BatchLog wheels = simulation.log;
  wheels.motions.clear();
  Feed(wheels, &without);
  EXPECT_GT(DistanceOff(without, simulation.truth.back().X_WR), 0.5);
}

TEST(RelativeMotion, ExactWheelsAndMotionsAreExact) {
  const BatchSimulationOptions drive = ExactDrive();
  const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  OdometryFilter filter(Options(drive.drive.parameters));
  Feed(simulation.log, &filter);
  EXPECT_EQ(filter.counts().num_rejected, 0);
  // Whole ticks of 1e-8 m, summed over a thousand readings.
  EXPECT_LT(DistanceOff(filter, simulation.truth.back().X_WR), 1e-5);
  EXPECT_LT(LargestShareOff(filter, drive.drive.parameters), 1e-5);
}

TEST(RelativeMotion, MountingWithTheWrongSignIsNoHelp) {
  const BatchSimulationOptions drive = ExactDrive();
  BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  for (RelativeMotion& motion : simulation.log.motions) {
    motion.X_RS.heading = -motion.X_RS.heading;
  }
  OdometryFilter filter(
      Options(Scaled(drive.drive.parameters, {1.05, 0.96, 0.92})));
  Feed(simulation.log, &filter);
  EXPECT_GT(filter.counts().num_rejected, 20);
  EXPECT_GT(LargestShareOff(filter, drive.drive.parameters), 0.02);
}

TEST(RelativeMotion, ReversedMotionIsNoHelp) {
  const BatchSimulationOptions drive = ExactDrive();
  BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  for (RelativeMotion& motion : simulation.log.motions) {
    motion.X_S0S1 = Inverse(motion.X_S0S1);
  }
  OdometryFilter filter(
      Options(Scaled(drive.drive.parameters, {1.05, 0.96, 0.92})));
  Feed(simulation.log, &filter);
  EXPECT_EQ(filter.counts().num_accepted, 0);
}

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
      ekf.parameters().vector() - kTrue.vector();
  e(2) = WrapAngle(e(2));
  // Scaled: metres and micrometres do not share a factorisation.
  const Matrix6 P = ekf.covariance();
  const Vector6 scale = P.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6 C = scale.asDiagonal() * P * scale.asDiagonal();
  return e.cwiseProduct(scale).dot(C.ldlt().solve(e.cwiseProduct(scale)));
}

// Must show: normalised error squared of (pose, parameters) in its 95 % band,
// with a mounting that is exact and with one that is off by what is stated.
TEST(RelativeMotion, IsConsistentOver100Seeds) {
  constexpr int kSeeds = 100;
  const Eigen::Vector3d share(0.02, 0.02, 0.05);
  for (const double mounting_sigma : {0.0, 1.0}) {
    double sum = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const auto hashed = Random(static_cast<std::uint64_t>(seed)).Bits();
      Random random(hashed + 1);
      BatchSimulationOptions drive = Drive(hashed);
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
          Scaled(kTrue, scale),
          kTrue.vector().cwiseProduct(share).cwiseAbs2().asDiagonal());
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

TEST(RelativeMotion, ExactMotionsTeachTheMounting) {
  BatchSimulationOptions drive = ExactDrive();
  const Pose2 off{0.006, -0.004, 0.03};
  drive.X_RS = Pose2::FromVector(kMounting.vector() + off.vector());
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
TEST(RelativeMotion, MountingIsNotTakenForWheels) {
  BatchSimulationOptions drive = ExactDrive();
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

TEST(RelativeMotion, SensorsAreBounded) {
  BatchSimulation simulation = SimulateBatch(Drive(10), MixedDriver(0.3));
  for (std::size_t i = 0; i < simulation.log.motions.size(); ++i) {
    simulation.log.motions[i].source = std::to_string(i % 6);
  }
  OdometryFilterOptions options = Options(kTrue);
  options.ekf = OdometryEkfOptions{};
  OdometryFilter filter(options);
  Feed(simulation.log, &filter);
  // Two of six sensors are too many.
  EXPECT_NEAR(static_cast<double>(filter.counts().num_crowded),
              static_cast<double>(simulation.log.motions.size()) / 3.0,
              1.0);
  EXPECT_EQ(filter.counts().num_crowded + filter.counts().num_accepted,
            static_cast<std::int64_t>(simulation.log.motions.size()));
}

// A motion says nothing about where in the world the robot is: not even exact
// ones make the position surer than it was at the start.
TEST(RelativeMotion, DoesNotMeasureWhereInTheWorld) {
  const BatchSimulation simulation = SimulateBatch(Drive(3), MixedDriver(0.3));
  OdometryFilterOptions options = Options(kTrue);
  options.start->covariance = Eigen::Vector3d(0.25, 0.25, 1e-6).asDiagonal();
  OdometryFilter filter(options);
  Feed(simulation.log, &filter, [&](const EncoderReading&) {
    const Eigen::Matrix3d P = filter.estimate().covariance;
    ASSERT_GT(P(0, 0), 0.25);
    ASSERT_GT(P(1, 1), 0.25);
  });
  EXPECT_GT(filter.counts().num_accepted, 90);
}

// A clone that no motion uses is a passenger: fixes give the same estimate, to
// rounding (the joint update adds up in another order).
TEST(RelativeMotion, UnusedStartsChangeNothing) {
  BatchSimulationOptions drive = Drive(4);
  drive.fix_every = 7;
  drive.sigma_m = drive.sigma_rad = 0.01;
  BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  std::vector<Eigen::Vector3d> plain;
  std::vector<RelativeMotion> motions;
  std::swap(motions, simulation.log.motions);
  OdometryFilter without(Options(kTrue));
  Feed(simulation.log, &without);
  OdometryFilter with(Options(kTrue));
  std::size_t next = 0;
  Feed(simulation.log, &with, [&](const EncoderReading& reading) {
    if (next < motions.size() && reading.time >= motions[next].from) {
      with.Add(reading.time, MotionStart{motions[next++].time});
    }
  });
  EXPECT_GT(without.counts().num_accepted, 100);
  EXPECT_EQ(with.counts().num_accepted, without.counts().num_accepted);
  EXPECT_LT(
      (with.estimate().X_WR.vector() - without.estimate().X_WR.vector()).norm(),
      1e-9);
  EXPECT_LT((with.estimate().covariance - without.estimate().covariance).norm(),
            1e-9 * without.estimate().covariance.norm());
  EXPECT_LT(LargestShareOff(with, without.parameters().parameters), 1e-9);
}

TEST(RelativeMotion, FaultyOnesAreRejectedAndTheRestHelps) {
  BatchSimulation simulation = SimulateBatch(Drive(5), MixedDriver(0.3));
  int num_faulty = 0;
  for (std::size_t i = 0; i < simulation.log.motions.size(); i += 6) {
    simulation.log.motions[i].X_S0S1.y += i % 4 == 0 ? 0.3 : -0.3;
    ++num_faulty;
  }
  OdometryFilterOptions options = Options(Scaled(kTrue, {1.03, 0.98, 0.95}));
  OdometryFilter filter(options);
  Feed(simulation.log, &filter);
  EXPECT_EQ(filter.counts().num_rejected, num_faulty);
  EXPECT_EQ(filter.counts().num_doubts, 0);
  EXPECT_LT(LargestShareOff(filter, kTrue), 0.01);
}

// Parameters that are said to be exact and are far off: nothing fits, until the
// filter doubts them.
TEST(RelativeMotion, WrongParametersDoNotLockTheGate) {
  BatchSimulationOptions drive = Drive(6);
  drive.sigma_m = drive.sigma_rad = 5e-4;
  const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  OdometryFilterOptions options = Options(Scaled(kTrue, {1.25, 1.2, 0.8}));
  options.parameter_sigma = {1e-3, 1e-3, 1e-3};
  OdometryFilter filter(options);
  Feed(simulation.log, &filter);
  EXPECT_GT(filter.counts().num_doubts, 2);
  EXPECT_GT(filter.counts().num_accepted, 20);
  EXPECT_LT(LargestShareOff(filter, kTrue), 0.02);

  options.doubt_after = 1000;
  OdometryFilter locked(options);
  Feed(simulation.log, &locked);
  EXPECT_EQ(locked.counts().num_accepted, 0);
}

TEST(RelativeMotion, StartsAreBoundedAndTheRestCounted) {
  BatchSimulation simulation = SimulateBatch(Drive(7), MixedDriver(0.3));
  BatchLog& log = simulation.log;
  // From every reading on, over ten readings: ten starts at once.
  log.motions.clear();
  for (std::size_t i = 0; i + 10 < log.encoders.size(); ++i) {
    RelativeMotion motion;
    motion.from = log.encoders[i].time;
    motion.time = log.encoders[i + 10].time;
    motion.X_RS = kMounting;
    motion.X_S0S1 = Between(simulation.truth[i].X_WR * kMounting,
                            simulation.truth[i + 10].X_WR * kMounting);
    motion.covariance = 1e-5 * Eigen::Matrix3d::Identity();
    log.motions.push_back(motion);
  }
  const auto num = static_cast<std::int64_t>(log.motions.size());
  OdometryFilterOptions options = Options(kTrue);
  OdometryFilter filter(options);
  Feed(log, &filter);
  EXPECT_GT(filter.counts().num_crowded, num / 10);
  EXPECT_EQ(filter.counts().num_unused, filter.counts().num_crowded);
  EXPECT_EQ(filter.counts().num_accepted + filter.counts().num_unused, num);

  options.max_clones = 10;
  OdometryFilter roomy(options);
  Feed(log, &roomy);
  EXPECT_EQ(roomy.counts().num_crowded, 0);
  EXPECT_EQ(roomy.counts().num_accepted, num);

  // Sensors that start at the same time share one.
  log.motions.clear();
  for (std::size_t i = 0; i + 10 < log.encoders.size(); i += 10) {
    for (std::size_t n = 1; n <= 10; ++n) {
      RelativeMotion motion;
      motion.from = log.encoders[i].time;
      motion.time = log.encoders[i + n].time;
      motion.X_S0S1 =
          Between(simulation.truth[i].X_WR, simulation.truth[i + n].X_WR);
      motion.covariance = 1e-5 * Eigen::Matrix3d::Identity();
      log.motions.push_back(motion);
    }
  }
  options.max_clones = 1;
  OdometryFilter sharing(options);
  Feed(log, &sharing);
  EXPECT_EQ(sharing.counts().num_crowded, 0);
  EXPECT_EQ(sharing.counts().num_accepted,
            static_cast<std::int64_t>(log.motions.size()));
}

TEST(RelativeMotion, NeedsAPoseAtItsStart) {
  const BatchSimulation simulation = SimulateBatch(Drive(8), MixedDriver(0.3));
  const auto num = static_cast<std::int64_t>(simulation.log.motions.size());
  OdometryFilterOptions options = Options(kTrue);
  options.start.reset();
  OdometryFilter lost(options);
  Feed(simulation.log, &lost);
  EXPECT_EQ(lost.counts().num_unused, num);
  EXPECT_FALSE(lost.estimate().is_known);

  // A new start in the middle of a motion: that one is of no use any more.
  OdometryFilter moved(Options(kTrue));
  int reading = 0;
  Feed(simulation.log, &moved, [&](const EncoderReading& r) {
    if (++reading == 106) moved.Add(r.time, InitialPose{});
  });
  EXPECT_EQ(moved.counts().num_unused, 1);
  EXPECT_EQ(moved.counts().num_accepted, num - 1);
}

TEST(RelativeMotion, AdoptedParametersStayWhatTheyAre) {
  const BatchSimulation simulation = SimulateBatch(Drive(9), MixedDriver(0.3));
  OdometryFilterOptions options = Options(Scaled(kTrue, {1.02, 0.99, 0.97}));
  options.adopt_batch = true;
  OdometryFilter filter(options);
  Feed(simulation.log, &filter);
  EXPECT_GT(filter.counts().num_accepted, 90);
  EXPECT_LT(LargestShareOff(filter, *options.parameters), 1e-12);
  // The pose profits all the same.
  OdometryFilter without(options);
  BatchLog wheels = simulation.log;
  wheels.motions.clear();
  Feed(wheels, &without);
  const Pose2& truth = simulation.truth.back().X_WR;
  EXPECT_LT(DistanceOff(filter, truth), 0.3 * DistanceOff(without, truth));
}

}  // namespace
}  // namespace waymark
