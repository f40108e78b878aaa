// The corridor system's tasks, small ones, through a model of its vision.
#include "processes/tools/experiment/corridor_experiment.h"

#include "processes/support/configuration.h"
#include "processes/support/log_file.h"
#include "tests/support/temporary_directory.h"

#include <waymark/corridor_pose_t.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

void Prepare(CorridorExperiment* experiment,
             const std::vector<std::string>& settings) {
  const DescribeFunction describe = [&](Describer& d) {
    experiment->Describe(d);
  };
  for (const std::string& setting : settings) ApplySetting(setting, describe);
  experiment->Prepare();
}

double FigureOf(const RunResult& result, const std::string& name) {
  const auto found = std::find_if(
      result.figures.begin(), result.figures.end(), [&](const auto& figure) {
        return figure.first == name;
      });
  if (found == result.figures.end()) throw std::logic_error("no " + name);
  return found->second;
}

TEST(CorridorExperiment, SightKeepsTheRobotNearTheTruth) {
  CorridorExperiment experiment;
  Prepare(&experiment, {"task=turns", "way.length_m=4", "way.num_legs=1"});
  const RunResult result = experiment.Run(1, "");
  EXPECT_TRUE(result.is_success) << result.reason;
  EXPECT_LT(FigureOf(result, "max_y_m"), 0.03);
  EXPECT_LT(FigureOf(result, "max_y_sigmas"), 5.0);
  EXPECT_EQ(experiment.Run(1, ""), result);
  EXPECT_NE(experiment.Run(2, ""), result);
}

// Errors that it does not know of are seen in the figures.
TEST(CorridorExperiment, WrongSightFails) {
  CorridorExperiment experiment;
  Prepare(&experiment,
          {"way.length_m=4",
           "way.num_legs=1",
           "model.slow_sigma_m=0.3",
           "model.correlation_s=1000"});
  const RunResult result = experiment.Run(1, "");
  EXPECT_FALSE(result.is_success);
  EXPECT_EQ(result.reason, "lateral error");
  EXPECT_GT(FigureOf(result, "max_y_sigmas"), 10.0);
}

TEST(CorridorExperiment, BlindItDrivesOnAndFindsItselfAgain) {
  CorridorExperiment experiment;
  Prepare(&experiment, {"task=blind", "way.length_m=8", "way.blind_m=[2, 6]"});
  const TemporaryDirectory folder;
  const RunResult result = experiment.Run(3, folder / "run.lcm");
  EXPECT_TRUE(result.is_success) << result.reason;
  EXPECT_LT(FigureOf(result, "max_offset_m"), 0.5);
  int num_blind = 0;
  int num_seeing = 0;
  LogReader log(folder / "run.lcm");
  while (const auto event = log.Next()) {
    if (event->channel != "CORRIDOR_POSE") continue;
    const auto message = DecodeAs<corridor_pose_t>(*event);
    ASSERT_TRUE(message);
    (message->status == "no_lines" ? num_blind : num_seeing) += 1;
  }
  // 4 m at 0.4 m/s and 15 Hz.
  EXPECT_NEAR(num_blind, 150, 15);
  EXPECT_GT(num_seeing, 100);
}

TEST(CorridorExperiment, LearnsItsWheels) {
  CorridorExperiment experiment;
  Prepare(&experiment, {"task=learn", "way.num_legs=1"});
  const RunResult result = experiment.Run(5, "");
  EXPECT_TRUE(result.is_success) << result.reason;
  EXPECT_LT(std::abs(FigureOf(result, "ratio_error")), 0.005);
  EXPECT_LT(std::abs(FigureOf(result, "base_error")), 0.02);
  EXPECT_LT(std::abs(FigureOf(result, "ratio_sigmas")), 5.0);
  EXPECT_LT(std::abs(FigureOf(result, "base_sigmas")), 5.0);
  // Better than the bound it is by chance alone, and hardly worse.
  for (const std::string of : {"ratio", "base"}) {
    const double bound = FigureOf(result, of + "_bound");
    EXPECT_GT(bound, 1e-5);
    EXPECT_LT(std::abs(FigureOf(result, of + "_error")), 4.0 * bound);
  }
}

TEST(CorridorExperiment, RefusesABlindWayThatEndsBeforeItBegins) {
  CorridorExperiment experiment;
  EXPECT_THROW(Prepare(&experiment, {"way.blind_m=[6, 2]"}),
               std::invalid_argument);
}

}  // namespace
}  // namespace waymark
