#include "processes/batch_refiner/batch_refiner_process.h"

#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"
#include "tests/support/batch_simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace waymark {
namespace {

constexpr WheelParameters kTrue{1.02e-4, 0.99e-4, 0.27};

BatchSimulation Simulate() {
  BatchSimulationOptions options;
  options.drive.parameters = kTrue;
  options.drive.rate_hz = 20.0;
  options.drive.duration_s = 60.0;
  options.fix_every = 5;
  return SimulateBatch(options, MixedDriver(0.3));
}

BatchRefinerConfig Config() {
  BatchRefinerConfig config;
  config.nominal = {1e-4, 1e-4, 0.25};
  config.solver.options.noise = DriveNoise{};
  return config;
}

struct World {
  explicit World(const BatchRefinerConfig& config)
      : process(config, local.AddProcess("batch_refiner")) {}

  void Play(const BatchSimulation& simulation) {
    for (const EncoderReading& reading : simulation.log.encoders) {
      local.Publish(kEncoders, ToMessage(reading, 0, false));
    }
    for (const AbsoluteFix& fix : simulation.log.fixes) {
      local.Publish(kPositionFix, ToMessage(fix));
    }
    local.Run();
    process.Finish();
    local.Run();
  }
  [[nodiscard]] std::vector<odometry_parameters_t> Published() const {
    return local.Messages<odometry_parameters_t>(kOdometryParameters);
  }
  [[nodiscard]] std::int64_t Bad(std::string_view channel) const {
    for (const channel_status_t& c : local.Status("batch_refiner").channels) {
      if (c.channel == channel) return c.num_bad;
    }
    return -1;
  }

  LocalBus local;
  BatchRefinerProcess process;
};

// What it says of the plain drive, solved once for the tests that compare.
const std::vector<odometry_parameters_t>& CleanAnswers() {
  static const std::vector<odometry_parameters_t> kAnswers = [] {
    World world(Config());
    world.Play(Simulate());
    return world.Published();
  }();
  return kAnswers;
}

TEST(BatchRefinerProcess, PublishesBatchParametersEveryPeriod) {
  const auto& published = CleanAnswers();
  // At 10, 20, ... 60 s; the last one also when it ends.
  ASSERT_EQ(published.size(), 6u);
  const odometry_parameters_t& last = published.back();
  EXPECT_EQ(last.source, "batch");
  EXPECT_EQ(last.seq, 5);
  EXPECT_EQ(last.has_sensor, 0);
  const double sigma = std::sqrt(last.covariance[8]);
  EXPECT_LT(sigma, 0.003);
  EXPECT_NEAR(last.wheel_base, kTrue.wheel_base, 4.0 * sigma);
  EXPECT_NEAR(last.k_right, kTrue.k_right, 4.0 * std::sqrt(last.covariance[0]));
  EXPECT_NEAR(last.k_left, kTrue.k_left, 4.0 * std::sqrt(last.covariance[4]));
  EXPECT_GT(last.observability[2], 0.99);
  // More data, less doubt.
  EXPECT_LT(last.covariance[8], published.front().covariance[8]);
}

TEST(BatchRefinerProcess, TakesNominalParametersFromTheLog) {
  BatchRefinerConfig config = Config();
  config.nominal.clear();
  World world(config);
  const BatchSimulation simulation = Simulate();
  OdometryParameters nominal;
  nominal.time = simulation.log.encoders.front().time;
  nominal.source = "nominal";
  nominal.parameters = {1e-4, 1e-4, 0.25};
  world.local.Publish(kOdometryParameters, ToMessage(nominal, 0));
  world.Play(simulation);
  EXPECT_EQ(world.Published().size(), 7u);  // The nominal ones, and 6.
}

TEST(BatchRefinerProcess, WithoutNominalParametersThereIsNoAnswer) {
  BatchRefinerConfig config = Config();
  config.nominal.clear();
  World world(config);
  world.Play(Simulate());
  ASSERT_EQ(world.Published().size(), 6u);
  for (const odometry_parameters_t& none : world.Published()) {
    EXPECT_FALSE(none.is_known);
    EXPECT_THAT(none.reason, testing::HasSubstr("no nominal wheel parameters"));
    EXPECT_EQ(none.wheel_base, 0.0);
  }
}

// Stands for 35 s, then drives.
TEST(BatchRefinerProcess, TooLittleMotionIsNoneThenThereIsAnAnswer) {
  const BatchSimulation simulation = Simulate();
  const EncoderReading first = simulation.log.encoders.front();
  World world(Config());
  BatchSimulation late = simulation;
  const Duration wait = DurationFromSeconds(35.0);
  for (EncoderReading& reading : late.log.encoders) reading.time += wait;
  for (AbsoluteFix& fix : late.log.fixes) fix.time += wait;
  for (int i = 0; i < 700; ++i) {
    EncoderReading standing = first;
    standing.time += DurationFromSeconds(0.05 * i);
    world.local.Publish(kEncoders, ToMessage(standing, 0, false));
    if (i % 20 != 10) continue;
    AbsoluteFix fix = simulation.log.fixes.front();
    fix.time = standing.time;
    world.local.Publish(kPositionFix, ToMessage(fix));
  }
  world.Play(late);
  const auto published = world.Published();
  ASSERT_EQ(published.size(), 10u);
  const double share = Config().solver.sigma_share[2];
  for (std::size_t i = 0; i < published.size(); ++i) {
    const odometry_parameters_t& m = published[i];
    EXPECT_EQ(m.source, "batch");
    EXPECT_EQ(m.seq, static_cast<int>(i));
    EXPECT_EQ(m.is_known, i < 3 ? 0 : m.is_known);
    if (m.is_known) continue;
    EXPECT_EQ(m.utime,
              Microseconds(first.time) +
                  10'000'000 * static_cast<std::int64_t>(i + 1));
    EXPECT_NE(m.reason, "");
    EXPECT_EQ(m.wheel_base, Config().nominal[2]);
    EXPECT_DOUBLE_EQ(m.covariance[8], std::pow(share * Config().nominal[2], 2));
    EXPECT_EQ(m.observability[2], 0.0);
    std::string reason;
    const auto values = OdometryParametersFromMessage(m, &reason);
    ASSERT_TRUE(values) << reason;
    EXPECT_FALSE(values->is_known);
  }
  EXPECT_EQ(published[0].reason, "the wheels travelled 0 m, less than 0.2 m");
  EXPECT_TRUE(published.back().is_known);
  EXPECT_EQ(published.back().reason, "");
  EXPECT_NEAR(published.back().wheel_base, kTrue.wheel_base, 0.005);
}

// Straight on (wheels of one size, or it would curve): the base stays what was
// assumed, and the message says so.
TEST(BatchRefinerProcess, PartlyObservableIsKnownAndNamesTheRest) {
  BatchSimulationOptions options;
  options.drive.parameters = {1e-4, 1e-4, 0.27};
  options.drive.rate_hz = 20.0;
  options.drive.duration_s = 60.0;
  options.fix_every = 5;
  World world(Config());
  world.Play(SimulateBatch(options, [](double, const Pose2&) {
    return DriveCommand{0.3, 0.0};
  }));
  ASSERT_FALSE(world.Published().empty());
  const odometry_parameters_t last = world.Published().back();
  EXPECT_TRUE(last.is_known);
  EXPECT_EQ(last.reason, "not observable: wheel_base");
  EXPECT_LT(last.observability[2], 0.9);
}

TEST(BatchRefinerProcess, SameInputGivesTheSameBytes) {
  std::vector<RawMessage> first;
  for (int run = 0; run < 2; ++run) {
    World world(Config());
    world.Play(Simulate());
    const std::vector<RawMessage>& recording = world.local.recording();
    if (run == 0) {
      first = recording;
      continue;
    }
    ASSERT_EQ(recording.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      ASSERT_EQ(recording[i].channel, first[i].channel);
      ASSERT_EQ(recording[i].data, first[i].data) << i;
    }
  }
}

TEST(BatchRefinerProcess, BadMessagesAreCountedAndChangeNothing) {
  const BatchSimulation simulation = Simulate();
  World world(Config());
  position_fix_t nan = ToMessage(simulation.log.fixes[3]);
  nan.x = std::numeric_limits<double>::quiet_NaN();
  world.local.Publish(kPositionFix, nan);
  relative_motion_t backwards{};
  backwards.utime = nan.utime;
  backwards.utime_from = nan.utime + 1;
  world.local.Publish(kRelativeMotion, backwards);
  encoders_t jump = ToMessage(simulation.log.encoders[200], 0, false);
  jump.utime += 1000;
  jump.left_ticks += 1'000'000'000;
  world.local.Publish(kEncoders, jump);
  encoders_t zero{};
  world.local.Publish(kEncoders, zero);
  world.Play(simulation);
  EXPECT_EQ(world.Bad(kPositionFix), 1);
  EXPECT_EQ(world.Bad(kRelativeMotion), 1);
  EXPECT_EQ(world.Bad(kEncoders), 2);
  ASSERT_EQ(world.Published().size(), CleanAnswers().size());
  EXPECT_EQ(world.Published().back().wheel_base,
            CleanAnswers().back().wheel_base);
}

TEST(BatchRefinerProcess, CounterWrapDoesNotMatter) {
  BatchSimulation simulation = Simulate();
  World world(Config());
  for (const EncoderReading& reading : simulation.log.encoders) {
    encoders_t message = ToMessage(reading, 16, false);
    // As a 16-bit counter that starts near its end.
    message.left_ticks = (message.left_ticks + 65000) & 0xffff;
    message.right_ticks = (message.right_ticks + 65000) & 0xffff;
    world.local.Publish(kEncoders, message);
  }
  simulation.log.encoders.clear();
  world.Play(simulation);
  ASSERT_EQ(world.Published().size(), 6u);
  EXPECT_EQ(world.Published().back().wheel_base,
            CleanAnswers().back().wheel_base);
}

// From the far past and from the far future, early and late in the window.
TEST(BatchRefinerProcess, OneWrongStampCostsOneReading) {
  const BatchSimulation simulation = Simulate();
  World world(Config());
  const auto publish = [&](std::size_t i, Time stamp) {
    EncoderReading wrong = simulation.log.encoders[i];
    const Time sent = wrong.time + Duration(1);
    wrong.time = stamp;
    world.local.PublishAt(sent, kEncoders, ToMessage(wrong, 0, false));
  };
  const Time far =
      TimeFromMicroseconds(std::numeric_limits<int64_t>::max() / 2);
  publish(100, TimeFromMicroseconds(1));
  publish(200, far);
  publish(900, far);
  publish(901, TimeFromMicroseconds(1));
  world.Play(simulation);
  EXPECT_EQ(world.Bad(kEncoders), 4);
  ASSERT_EQ(world.Published().size(), CleanAnswers().size());
  for (std::size_t i = 0; i < CleanAnswers().size(); ++i) {
    EXPECT_EQ(world.Published()[i].wheel_base, CleanAnswers()[i].wheel_base);
  }
}

TEST(BatchRefinerProcess, TimeGoingBackStartsAnew) {
  BatchRefinerConfig config = Config();
  config.window.window_s = 30.0;
  World world(config);
  const BatchSimulation simulation = Simulate();
  world.Play(simulation);
  const std::size_t before = world.Published().size();
  // The log again, as lcm-logplayer does in a loop.
  std::size_t fix = 0;
  for (const EncoderReading& reading : simulation.log.encoders) {
    world.local.PublishAt(
        world.local.now(), kEncoders, ToMessage(reading, 0, false));
    for (; fix < simulation.log.fixes.size() &&
           simulation.log.fixes[fix].time <= reading.time;
         ++fix) {
      world.local.PublishAt(world.local.now(),
                            kPositionFix,
                            ToMessage(simulation.log.fixes[fix]));
    }
  }
  world.local.Run();
  EXPECT_EQ(world.Bad(kEncoders), 1);
  EXPECT_GT(world.Published().size(), before);
}

TEST(BatchRefinerProcess, PublishesTheSensorThatItCalibrates) {
  BatchRefinerConfig config = Config();
  config.solver.calibrate_position = true;
  config.solver.calibrate_yaw = true;
  config.solver.calibrate_time_offset = true;
  World world(config);
  BatchSimulationOptions options;
  options.drive.parameters = kTrue;
  options.drive.rate_hz = 20.0;
  options.source = "camera";
  options.fix_every = 5;
  options.X_RS = {0.1, -0.05, 0.3};
  options.time_offset_s = 0.02;
  world.Play(SimulateBatch(options, MixedDriver(0.3)));
  ASSERT_FALSE(world.Published().empty());
  const odometry_parameters_t last = world.Published().back();
  ASSERT_TRUE(last.has_sensor);
  EXPECT_EQ(last.sensor, "camera");
  const double truth[4] = {0.1, -0.05, 0.3, 0.02};
  const double value[4] = {
      last.sensor_R[0], last.sensor_R[1], last.sensor_R[2], last.time_offset};
  for (int i = 0; i < 4; ++i) {
    const double sigma = std::sqrt(last.sensor_covariance[5 * i]);
    EXPECT_GT(sigma, 0.0);
    EXPECT_LT(sigma, 0.02);
    EXPECT_NEAR(value[i], truth[i], 4.0 * sigma) << i;
  }
}

TEST(BatchRefinerProcess, ConfigurationIsChecked) {
  BatchRefinerConfig config = Config();
  config.nominal[2] = -1.0;
  EXPECT_THROW(config.Check(), std::invalid_argument);
  config = Config();
  config.solver.sigma_share[0] = 0.0;
  EXPECT_THROW(config.Check(), std::invalid_argument);
}

TEST(BatchWindow, KeepsTheNewestWithinItsBounds) {
  BatchWindowOptions options;
  options.window_s = 10.0;
  options.max_readings = 100;
  BatchWindow window(options);
  EXPECT_FALSE(window.newest().has_value());
  for (int i = 0; i < 1000; ++i) {
    EncoderReading reading;
    reading.time = TimeFromMicroseconds(1'000'000 + 50'000 * i);
    window.Add(reading);
    AbsoluteFix fix;
    fix.time = reading.time;
    window.Add(fix);
  }
  const BatchLog& log = window.Log();
  EXPECT_LE(log.encoders.size(), 100u);
  EXPECT_GE(log.encoders.size(), 74u);
  EXPECT_EQ(log.fixes.size(), 201u);  // 10 s at 20 Hz, both ends.
  EXPECT_GT(window.num_displaced(), 0);
  EXPECT_EQ(Microseconds(*window.newest()), 1'000'000 + 50'000 * 999);
  window.Clear();
  EXPECT_TRUE(window.Log().fixes.empty());
}

}  // namespace
}  // namespace waymark
