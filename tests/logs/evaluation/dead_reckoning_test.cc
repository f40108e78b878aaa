#include "logs/evaluation/dead_reckoning.h"

#include "estimation/geometry/angle.h"
#include "logs/evaluation/trajectory_error.h"
#include "tests/support/drive_simulation.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

std::vector<SimulatedReading> NoiselessSquare() {
  DriveSimulationOptions options;
  options.noise = {0.0, 0.0};
  options.start = {3, -1, 0.6};
  options.duration_s = 20;
  return SimulateDrive(options, SquareDriver(0.3, 1.0, 0.8));
}

std::vector<EncoderReading> Readings(
    const std::vector<SimulatedReading>& drive) {
  std::vector<EncoderReading> readings;
  for (const SimulatedReading& r : drive) {
    readings.push_back({r.time,
                        static_cast<std::int64_t>(readings.size()),
                        static_cast<std::int64_t>(r.right_ticks),
                        static_cast<std::int64_t>(r.left_ticks)});
  }
  return readings;
}

TEST(DeadReckon, RecoversANoiselessDriveExactly) {
  const auto drive = NoiselessSquare();
  const DriveSimulationOptions options;
  const auto path = Anchor(DeadReckon(Readings(drive), options.parameters),
                           drive[0].time,
                           drive[0].X_WR);
  ASSERT_EQ(path.size(), drive.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    // Same formula, same inputs: what is left is rounding over 1000 steps.
    EXPECT_NEAR(path[i].X_WR.x, drive[i].X_WR.x, 1e-10);
    EXPECT_NEAR(path[i].X_WR.y, drive[i].X_WR.y, 1e-10);
  }
}

TEST(DeadReckon, ASmallerBaseTurnsTooFar) {
  const auto readings = Readings(NoiselessSquare());
  WheelParameters narrow = DriveSimulationOptions{}.parameters;
  narrow.wheel_base *= 0.9;
  // Left turns: headings are ahead of those of the right base.
  const auto wide = DeadReckon(readings, DriveSimulationOptions{}.parameters);
  const auto path = DeadReckon(readings, narrow);
  EXPECT_GT(path[250].X_WR.heading, wide[250].X_WR.heading);
}

TEST(Anchor, PassesThroughThePoseAtItsTime) {
  const auto drive = NoiselessSquare();
  const auto path = DeadReckon(Readings(drive), {1e-4, 1e-4, 0.27});
  const Pose2 X_WR{7, 8, -2};
  const Time middle = drive[400].time;
  const auto moved = Anchor(path, middle, X_WR);
  EXPECT_NEAR(moved[400].X_WR.x, 7, 1e-12);
  EXPECT_NEAR(moved[400].X_WR.y, 8, 1e-12);
  EXPECT_NEAR(WrapAngle(moved[400].X_WR.heading + 2), 0, 1e-12);
  const auto early = Anchor(path, drive[0].time - DurationFromSeconds(5), X_WR);
  EXPECT_NEAR(early[0].X_WR.x, 7, 1e-12);
  EXPECT_TRUE(Anchor({}, middle, X_WR).empty());
}

TEST(Convergence, HandComputed) {
  std::vector<ParameterSample> samples;
  // Base: 0.2, 0.269, 0.25, 0.272, 0.27; inside 1 % of 0.27 from t = 3 on.
  const double bases[] = {0.2, 0.269, 0.25, 0.272, 0.271};
  for (int i = 0; i < 5; ++i) {
    ParameterSample sample;
    sample.time = Time(DurationFromSeconds(10.0 + i));
    sample.parameters = {1e-4, 2e-4, bases[i]};
    sample.covariance = Eigen::Vector3d(1e-12, 4e-12, 4e-6).asDiagonal();
    samples.push_back(sample);
  }
  const ParameterConvergence c =
      EvaluateConvergence(samples, WheelParameters{1e-4, 1.8e-4, 0.27});
  EXPECT_NEAR(c.sigma(1), 2e-6, 1e-18);
  EXPECT_NEAR(c.relative_error(2), 0.001 / 0.27, 1e-12);
  EXPECT_NEAR(c.normalised_error(2), 0.5, 1e-9);
  EXPECT_EQ(c.settled_s[0], 0.0);
  EXPECT_EQ(c.settled_s[1], std::nullopt);  // 11 % off to the end.
  EXPECT_EQ(c.settled_s[2], 3.0);
  EXPECT_FALSE(EvaluateConvergence(samples, std::nullopt).has_reference);
}

}  // namespace
}  // namespace waymark
