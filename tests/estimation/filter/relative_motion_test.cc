// What relative motions do to the whole filter: the gate, the bounds, wheel
// parameters without any absolute fix.
#include "estimation/filter/odometry_filter.h"
#include "tests/support/motion_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace waymark {
namespace {

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

double DistanceOff(const OdometryFilter& filter, const Pose2& truth) {
  return (filter.estimate().X_WR.position() - truth.position()).norm();
}

TEST(RelativeMotion, ExactMotionsTeachTheWheelsWithoutAnyFix) {
  const BatchSimulationOptions drive = ExactMotionDrive();
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
  const BatchSimulationOptions drive = ExactMotionDrive();
  const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  OdometryFilter filter(Options(drive.drive.parameters));
  Feed(simulation.log, &filter);
  EXPECT_EQ(filter.counts().num_rejected, 0);
  // Whole ticks of 1e-8 m, summed over a thousand readings.
  EXPECT_LT(DistanceOff(filter, simulation.truth.back().X_WR), 1e-5);
  EXPECT_LT(LargestShareOff(filter, drive.drive.parameters), 1e-5);
}

TEST(RelativeMotion, MountingWithTheWrongSignIsNoHelp) {
  const BatchSimulationOptions drive = ExactMotionDrive();
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
  const BatchSimulationOptions drive = ExactMotionDrive();
  BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  for (RelativeMotion& motion : simulation.log.motions) {
    motion.X_S0S1 = Inverse(motion.X_S0S1);
  }
  OdometryFilter filter(
      Options(Scaled(drive.drive.parameters, {1.05, 0.96, 0.92})));
  Feed(simulation.log, &filter);
  EXPECT_EQ(filter.counts().num_accepted, 0);
}

TEST(RelativeMotion, SensorsAreBounded) {
  BatchSimulation simulation = SimulateBatch(MotionDrive(10), MixedDriver(0.3));
  for (std::size_t i = 0; i < simulation.log.motions.size(); ++i) {
    simulation.log.motions[i].source = std::to_string(i % 6);
  }
  OdometryFilterOptions options = Options(kMotionWheels);
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
  const BatchSimulation simulation =
      SimulateBatch(MotionDrive(3), MixedDriver(0.3));
  OdometryFilterOptions options = Options(kMotionWheels);
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
  BatchSimulationOptions drive = MotionDrive(4);
  drive.fix_every = 7;
  drive.sigma_m = drive.sigma_rad = 0.01;
  BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  std::vector<Eigen::Vector3d> plain;
  std::vector<RelativeMotion> motions;
  std::swap(motions, simulation.log.motions);
  OdometryFilter without(Options(kMotionWheels));
  Feed(simulation.log, &without);
  OdometryFilter with(Options(kMotionWheels));
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
  BatchSimulation simulation = SimulateBatch(MotionDrive(5), MixedDriver(0.3));
  int num_faulty = 0;
  for (std::size_t i = 0; i < simulation.log.motions.size(); i += 6) {
    simulation.log.motions[i].X_S0S1.y += i % 4 == 0 ? 0.3 : -0.3;
    ++num_faulty;
  }
  OdometryFilterOptions options =
      Options(Scaled(kMotionWheels, {1.03, 0.98, 0.95}));
  OdometryFilter filter(options);
  Feed(simulation.log, &filter);
  EXPECT_EQ(filter.counts().num_rejected, num_faulty);
  EXPECT_EQ(filter.counts().num_doubts, 0);
  EXPECT_LT(LargestShareOff(filter, kMotionWheels), 0.01);
}

// Parameters that are said to be exact and are far off: nothing fits, until the
// filter doubts them.
TEST(RelativeMotion, WrongParametersDoNotLockTheGate) {
  BatchSimulationOptions drive = MotionDrive(6);
  drive.sigma_m = drive.sigma_rad = 5e-4;
  const BatchSimulation simulation = SimulateBatch(drive, MixedDriver(0.3));
  OdometryFilterOptions options =
      Options(Scaled(kMotionWheels, {1.25, 1.2, 0.8}));
  options.parameter_sigma = {1e-3, 1e-3, 1e-3};
  OdometryFilter filter(options);
  Feed(simulation.log, &filter);
  EXPECT_GT(filter.counts().num_doubts, 2);
  EXPECT_GT(filter.counts().num_accepted, 20);
  EXPECT_LT(LargestShareOff(filter, kMotionWheels), 0.02);

  options.doubt_after = 1000;
  OdometryFilter locked(options);
  Feed(simulation.log, &locked);
  EXPECT_EQ(locked.counts().num_accepted, 0);
}

TEST(RelativeMotion, StartsAreBoundedAndTheRestCounted) {
  BatchSimulation simulation = SimulateBatch(MotionDrive(7), MixedDriver(0.3));
  BatchLog& log = simulation.log;
  // From every reading on, over ten readings: ten starts at once.
  log.motions.clear();
  for (std::size_t i = 0; i + 10 < log.encoders.size(); ++i) {
    RelativeMotion motion;
    motion.from = log.encoders[i].time;
    motion.time = log.encoders[i + 10].time;
    motion.X_RS = kMotionMounting;
    motion.X_S0S1 = Between(simulation.truth[i].X_WR * kMotionMounting,
                            simulation.truth[i + 10].X_WR * kMotionMounting);
    motion.covariance = 1e-5 * Eigen::Matrix3d::Identity();
    log.motions.push_back(motion);
  }
  const auto num = static_cast<std::int64_t>(log.motions.size());
  OdometryFilterOptions options = Options(kMotionWheels);
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
  const BatchSimulation simulation =
      SimulateBatch(MotionDrive(8), MixedDriver(0.3));
  const auto num = static_cast<std::int64_t>(simulation.log.motions.size());
  OdometryFilterOptions options = Options(kMotionWheels);
  options.start.reset();
  OdometryFilter lost(options);
  Feed(simulation.log, &lost);
  EXPECT_EQ(lost.counts().num_unused, num);
  EXPECT_FALSE(lost.estimate().is_known);

  // A new start in the middle of a motion: that one is of no use any more.
  OdometryFilter moved(Options(kMotionWheels));
  int reading = 0;
  Feed(simulation.log, &moved, [&](const EncoderReading& r) {
    if (++reading == 106) moved.Add(r.time, InitialPose{});
  });
  EXPECT_EQ(moved.counts().num_unused, 1);
  EXPECT_EQ(moved.counts().num_accepted, num - 1);
}

TEST(RelativeMotion, AdoptedParametersStayWhatTheyAre) {
  const BatchSimulation simulation =
      SimulateBatch(MotionDrive(9), MixedDriver(0.3));
  OdometryFilterOptions options =
      Options(Scaled(kMotionWheels, {1.02, 0.99, 0.97}));
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
