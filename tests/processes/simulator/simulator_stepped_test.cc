// The simulator stepped: each ENCODERS waits for the command that answers it.
#include "tests/processes/simulator/simulator_test.h"

#include <waymark/encoders_t.hpp>
#include <waymark/truth_t.hpp>
#include <waymark/velocity_t.hpp>

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class SimulatorSteppedTest : public SimulatorTest {
 protected:
  SimulatorSteppedTest() { config_.pace = Pace::kStepped; }
};

TEST_F(SimulatorSteppedTest, GoesAsFastAsItIsAnswered) {
  config_.answer_timeout_s = 1.0;
  SimulatorOnBus run(config_);
  run.AddDriver([](Bus* driver, int num_before, Time t) {
    if (num_before == 100) return;  // As if a message were lost.
    driver->Publish(kMotionCommand, Velocity(t, 0.2, 0.0));
  });
  // 100 answered steps in no time, and the first tick 20 ms after the start;
  // the one without answer is waited for.
  run.bus.RunUntil(kStart + milliseconds(500));
  EXPECT_EQ(run.bus.Messages<encoders_t>(kEncoders).size(), 101u);
  EXPECT_EQ(run.bus.Status("simulator").fault, "");
}

// 1/30 and 1/70 s are no whole numbers of microseconds.
TEST_F(SimulatorSteppedTest, GoesOnAtAnyEncoderRate) {
  for (const double rate_hz : {30.0, 70.0}) {
    config_.encoder_rate_hz = rate_hz;
    SimulatorOnBus run(config_);
    run.AddDriver([](Bus* driver, int num_before, Time t) {
      if (num_before >= 300) return;
      driver->Publish(kMotionCommand, Velocity(t, 0.2, 0.0));
    });
    run.bus.RunUntil(kStart + milliseconds(500));
    const auto encoders = run.bus.Messages<encoders_t>(kEncoders);
    ASSERT_EQ(encoders.size(), 301u) << rate_hz << " Hz";
    EXPECT_NEAR(
        static_cast<double>(encoders[300].utime - encoders[0].utime) * 1e-6,
        300.0 / rate_hz,
        1e-6);
  }
}

// Somebody with a clock of their own steers, but does not step.
TEST_F(SimulatorSteppedTest, TakesTheCommandOfItsOwnTimeForAnswer) {
  SimulatorOnBus run(config_);
  run.AddDriver([](Bus* driver, int num_before, Time t) {
    for (const Duration off : {-milliseconds(7), milliseconds(7)}) {
      driver->Publish(kMotionCommand, Velocity(t + off, 0.0, 0.3));
    }
    if (num_before >= 100) return;
    driver->Publish(kMotionCommand, Velocity(t, 0.2, 0.0));
  });
  run.bus.RunUntil(kStart + milliseconds(500));
  // Each step has the command that answered it; the 101st waits.
  const auto truths = run.bus.Messages<truth_t>(kTruth);
  ASSERT_EQ(truths.size(), 101u);
  EXPECT_EQ(truths.back().heading, 0.0);
  EXPECT_GT(truths.back().x, 1.3);
}

// A guard that nobody asks anything sends zero, by its own clock.
TEST_F(SimulatorSteppedTest, TakesNoAnswerThatNobodyAskedFor) {
  SimulatorOnBus run(config_);
  velocity_t nobody = Velocity(kStart + seconds(9), 0.0, 0.0);
  nobody.source = "";
  for (int i = 1; i < 5; ++i) {
    run.bus.PublishAt(kStart + milliseconds(100 * i), kMotionCommand, nobody);
  }
  run.bus.RunUntil(kStart + milliseconds(600));
  EXPECT_EQ(run.bus.Messages<encoders_t>(kEncoders).size(), 1u);
}

TEST_F(SimulatorSteppedTest, HasTheTrajectoryOfLockStep) {
  config_.robot.wheel_variance = 1e-5;
  std::vector<std::vector<truth_t>> paths;
  for (const Pace pace : {Pace::kRealTime, Pace::kStepped}) {
    config_.pace = pace;
    SimulatorOnBus run(config_);
    run.AddDriver([first = std::optional<Time>()](
                      Bus* driver, int num_before, Time t) mutable {
      if (!first) first = t;
      if (num_before >= 400) return;
      driver->Publish(kMotionCommand,
                      Velocity(t, 0.3, std::sin(Seconds(t - *first))));
    });
    run.bus.RunUntil(kStart + seconds(9));
    paths.push_back(run.bus.Messages<truth_t>(kTruth));
  }
  ASSERT_GE(paths[0].size(), 400u);
  ASSERT_GE(paths[1].size(), 400u);
  for (std::size_t i = 0; i < 400; ++i) {
    EXPECT_EQ(paths[0][i].x, paths[1][i].x) << i;
    EXPECT_EQ(paths[0][i].heading, paths[1][i].heading) << i;
  }
  EXPECT_GT(paths[0][399].x, 1.5);
}

}  // namespace
}  // namespace waymark
