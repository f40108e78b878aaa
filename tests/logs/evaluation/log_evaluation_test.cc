#include "logs/evaluation/log_evaluation.h"

#include "logs/evaluation/evaluation_text.h"
#include "processes/support/channels.h"
#include "processes/support/log_file.h"
#include "tests/logs/evaluation/synthetic_log.h"

#include <waymark/status_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace waymark {
namespace {

using testing::HasSubstr;

class LogEvaluationTest : public testing::Test {
 protected:
  LogEvaluationTest() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("log_evaluation_test_") + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~LogEvaluationTest() override { std::filesystem::remove_all(folder_); }

  std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }
  LogEvaluation Evaluate(const SyntheticLogOptions& options) {
    const std::vector<std::string> paths{Path("run.lcm")};
    std::filesystem::remove(paths[0]);
    WriteSyntheticLog(paths[0], options);
    return EvaluateRecording(ReadRecording(paths), {});
  }

  std::filesystem::path folder_;
};

TEST_F(LogEvaluationTest, ScoresWhatWasPutIn) {
  const SyntheticLogOptions options;
  const LogEvaluation e = Evaluate(options);
  EXPECT_EQ(e.name, "run");
  EXPECT_TRUE(e.recording.is_reference_aided());
  ASSERT_EQ(e.estimates.size(), 6u);
  for (const auto& estimate : e.estimates) {
    EXPECT_EQ(estimate.missing, "") << estimate.id;
    EXPECT_GT(estimate.num_pairs, 400) << estimate.id;
  }
  // Two axes of 1 cm: RMSE sqrt(2) cm; 480 draws scatter it by 3 %, the
  // heading's 0.01 rad on a lever of 3 cm adds nothing visible. Four sigma.
  const auto* online = e.Find("online");
  EXPECT_NEAR(
      online->absolute->position_summary.rmse, 0.01 * std::sqrt(2.0), 0.0017);
  EXPECT_NEAR(online->absolute->heading_summary.rmse, 0.01, 0.0013);
  EXPECT_NEAR(online->nees_position->share_inside, 0.95, 0.04);
  EXPECT_NEAR(online->nees_pose->mean, 3.0, 0.45);
  // Raw drifts by its parameters; with the true ones little is left, and
  // ODOMETRY as published is the nominal integration itself.
  const double raw = e.Find("raw")->absolute->position_summary.rmse;
  const double batch =
      e.Find("dead_reckoning_batch")->absolute->position_summary.rmse;
  EXPECT_GT(raw, 0.3);
  EXPECT_LT(batch, 0.05);
  EXPECT_NEAR(
      raw, e.Find("raw_nominal")->absolute->position_summary.rmse, 1e-9);
  EXPECT_FALSE(e.Find("raw")->nees_position);
  EXPECT_EQ(e.Find("nothing"), nullptr);
}

TEST_F(LogEvaluationTest, FollowsTheParametersToTheBatchResult) {
  const LogEvaluation e = Evaluate({});
  EXPECT_EQ(e.parameter_reference, "batch");
  ASSERT_EQ(e.parameters.size(), 3u);
  const ParameterEvaluation& online = e.parameters[1];
  EXPECT_EQ(online.source, "online");
  EXPECT_EQ(online.samples.size(), 61u);
  // 7.4 % off, times exp(-t / 8): below 1 % after 16.02 s, so at sample 17.
  ASSERT_TRUE(online.convergence.settled_s[2]);
  EXPECT_EQ(*online.convergence.settled_s[2], 17.0);
  EXPECT_LT(online.convergence.normalised_error(2), 3.0);
}

TEST_F(LogEvaluationTest, KnowsTheTrueWheelsOfASimulation) {
  const std::vector<std::string> paths{Path("run.lcm")};
  WriteSyntheticLog(paths[0], {});
  LogRecording recording = ReadRecording(paths);
  recording.configs["simulator"] =
      "robot: {meters_per_tick: 1e-04, wheel_base: 0.25}\n"
      "noise: {right_wheel_factor: 1.1, left_wheel_factor: 0.9, "
      "wheel_base_factor: 1.2}\n";
  const LogEvaluation e = EvaluateRecording(recording, {});
  EXPECT_EQ(e.parameter_reference, "truth");
  ASSERT_EQ(e.parameters.size(), 4u);
  EXPECT_EQ(e.parameters[3].source, "truth");
  const Eigen::Vector3d truth = e.parameters[3].convergence.final.vector();
  EXPECT_TRUE(truth.isApprox(Eigen::Vector3d(1.1e-4, 0.9e-4, 0.3), 1e-12));
  EXPECT_THAT(TableOf(e), HasSubstr("truth                      110.0000"));
  // What is no configuration of a simulator is none.
  for (const char* yaml : {"", "robot: 3\n", "robot: {", "noise: []\n"}) {
    recording.configs["simulator"] = yaml;
    EXPECT_EQ(EvaluateRecording(recording, {}).parameter_reference, "batch");
  }
}

TEST_F(LogEvaluationTest, ReadsHealth) {
  const LogEvaluation e = Evaluate({});
  const LogRecording& r = e.recording;
  EXPECT_NEAR(r.latency.at("POSE").median_ms, 3.0, 1e-9);
  EXPECT_NEAR(r.channels.at("ENCODERS").rate_hz, 20.0, 1e-6);
  EXPECT_EQ(r.channels.at("ENCODERS").num_lost, 0);
  const ProcessHealth& process = r.processes.at("pose_filter");
  EXPECT_EQ(process.num_dropped, 2);
  EXPECT_EQ(process.worst_handler_us, 210);
  ASSERT_EQ(process.faults.size(), 1u);
  EXPECT_THAT(FaultText(process.faults[0]),
              testing::ContainsRegex("^synthetic fault .once, at [0-9.]+ s.$"));
  EXPECT_EQ(r.version, "0.1.0");
}

// What counts up is one fault, however many lines a log has of it.
TEST_F(LogEvaluationTest, GroupsFaultsThatDifferInNumbers) {
  const std::string path = testing::TempDir() + "/faults.lcm";
  {
    LogWriter writer(path, IfExists::kReplace);
    for (int i = 0; i < 60; ++i) {
      status_t status{};
      status.utime = 1'700'000'000'000'000 + 1'000'000 * i;
      status.seq = i;
      status.process = "collision_guard";
      if (i >= 10) {
        status.fault = i % 2 == 0 ? "no RANGES for " + std::to_string(i) + " s"
                                  : "stopped by teleop";
      }
      writer.Write("STATUS", status);
    }
    writer.Close();
  }
  const LogRecording recording = ReadRecording({&path, 1});
  std::filesystem::remove(path);
  const auto& faults = recording.processes.at("collision_guard").faults;
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_EQ(FaultText(faults[0]),
            "no RANGES for 58 s (25 times, from 10.0 s on)");
  EXPECT_EQ(FaultText(faults[1]),
            "stopped by teleop (25 times, from 11.0 s on)");
}

TEST_F(LogEvaluationTest, LatencyIsAbsentOffline) {
  SyntheticLogOptions options;
  options.latency_s = 0;
  const LogEvaluation e = Evaluate(options);
  EXPECT_TRUE(e.recording.latency.empty());
  EXPECT_FALSE(e.recording.processes.at("pose_filter").worst_handler_us);
  EXPECT_TRUE(JsonOf(e)["health"]["latency"].is_null());
}

TEST_F(LogEvaluationTest, WithoutTruthSaysSoAndEvaluatesTheRest) {
  SyntheticLogOptions options;
  options.has_truth = false;
  const LogEvaluation e = Evaluate(options);
  EXPECT_FALSE(e.Find("online")->absolute);
  EXPECT_EQ(e.parameters.size(), 3u);
  EXPECT_FALSE(e.recording.latency.empty());
  EXPECT_THAT(e.notes[0], HasSubstr("No TRUTH in the log"));
  EXPECT_THAT(TableOf(e), HasSubstr("note: No TRUTH"));
  EXPECT_TRUE(JsonOf(e)["estimates"][2]["ate"].is_null());
}

TEST_F(LogEvaluationTest, WithoutHeadingsComparesPositions) {
  SyntheticLogOptions options;
  options.has_truth_heading = false;
  const LogEvaluation e = Evaluate(options);
  const auto* online = e.Find("online");
  EXPECT_TRUE(online->nees_position);
  EXPECT_FALSE(online->nees_pose);
  EXPECT_EQ(online->absolute->heading_summary.num, 0);
  EXPECT_FALSE(online->relative[0].has_heading);
  EXPECT_GT(online->relative[0].translation.num, 0);
}

TEST_F(LogEvaluationTest, ABareRecordingHasItsDeadReckoning) {
  SyntheticLogOptions options;
  options.has_estimates = false;
  options.fix_source = "beacons";
  const LogEvaluation e = Evaluate(options);
  EXPECT_FALSE(e.recording.is_reference_aided());
  EXPECT_TRUE(e.Find("raw_nominal")->absolute);
  EXPECT_EQ(e.Find("raw")->missing, "no ODOMETRY in the log");
  EXPECT_EQ(e.Find("online")->missing, "no known pose on POSE");
  EXPECT_EQ(e.Find("dead_reckoning_batch")->missing,
            "no ODOMETRY_PARAMETERS of source 'batch'");
  EXPECT_THAT(SummaryTableOf({&e, 1}), HasSubstr("run"));
}

// Where batch_refiner had no answer, what its message holds is not used.
TEST_F(LogEvaluationTest, NoneIsNoBatchEstimate) {
  SyntheticLogOptions options;
  options.no_batch = "stands still";
  const LogEvaluation e = Evaluate(options);
  EXPECT_EQ(e.recording.parameters.count("batch"), 0u);
  EXPECT_EQ(e.Find("dead_reckoning_batch")->missing,
            "no ODOMETRY_PARAMETERS of source 'batch': stands still");
  EXPECT_EQ(e.recording.channels.at("ODOMETRY_PARAMETERS").num_bad, 0);
}

TEST_F(LogEvaluationTest, CountsLostAndUnusableMessages) {
  const std::vector<std::string> paths{Path("damaged.lcm")};
  WriteSyntheticLog(Path("whole.lcm"), {});
  LogReader reader(Path("whole.lcm"));
  LogWriter writer(paths[0]);
  int num_encoders = 0;
  while (auto event = reader.Next()) {
    if (event->channel == kEncoders) {
      ++num_encoders;
      if (num_encoders == 100 || num_encoders == 101) continue;  // Lost.
      if (num_encoders == 200) event->data.resize(20);           // Cut short.
      if (num_encoders == 300) event->data[0] ^= 1;  // Another type.
    }
    writer.Write(event->time, event->channel, event->data);
  }
  writer.Close();
  const LogRecording r = ReadRecording(paths);
  EXPECT_EQ(r.channels.at("ENCODERS").num_bad, 2);
  // The two dropped and the two that could not be read leave gaps.
  EXPECT_EQ(r.channels.at("ENCODERS").num_lost, 4);
  EXPECT_NEAR(r.channels.at("ENCODERS").longest_gap_s, 0.15, 1e-9);
  EXPECT_EQ(r.readings.size(), 1197u);
  EXPECT_THAT(EvaluateRecording(r, {}).notes,
              testing::Contains(HasSubstr("4 of 1201 on ENCODERS.")));
  EXPECT_THAT(Evaluate({}).notes,
              testing::Not(testing::Contains(HasSubstr("are not in the log"))));
}

TEST_F(LogEvaluationTest, JoinsOutputsWithInputsFromAnotherLog) {
  WriteSyntheticLog(Path("whole.lcm"), {});
  {
    LogReader reader(Path("whole.lcm"));
    LogWriter in(Path("in.lcm"));
    LogWriter out(Path("out.lcm"));
    while (const auto event = reader.Next()) {
      const bool is_output =
          event->channel == kPose || event->channel == kPoseSettled;
      (is_output ? out : in).Write(event->time, event->channel, event->data);
    }
    in.Close();
    out.Close();
  }
  const std::vector<std::string> paths{Path("out.lcm"), Path("in.lcm")};
  const LogEvaluation e = EvaluateRecording(ReadRecording(paths), {});
  EXPECT_EQ(e.name, "out");
  EXPECT_TRUE(e.Find("online")->absolute);
  EXPECT_TRUE(e.Find("raw")->absolute);
}

TEST_F(LogEvaluationTest, SaysWhichLogCannotBeRead) {
  const std::vector<std::string> missing{Path("missing.lcm")};
  try {
    (void)ReadRecording(missing);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("missing.lcm"));
  }
}

TEST_F(LogEvaluationTest, TableAndJsonSayTheSame) {
  const LogEvaluation e = Evaluate({});
  const std::string table = TableOf(e);
  EXPECT_THAT(table, HasSubstr("[reference-aided]"));
  EXPECT_THAT(table, HasSubstr("online (POSE_SETTLED)"));
  EXPECT_THAT(
      table,
      HasSubstr("120 fixes from 'reference, every 10th', sigma 10.00 mm"));
  EXPECT_THAT(SummaryTableOf({&e, 1}), HasSubstr("* reference-aided"));
  const auto json = JsonOf(e);
  EXPECT_EQ(json["schema"], "waymark-evaluation-1");
  EXPECT_EQ(json["estimates"][0]["id"], "raw");
  const double rmse = json["estimates"][2]["ate"]["position"]["rmse_m"];
  EXPECT_EQ(rmse, e.Find("online")->absolute->position_summary.rmse);
  EXPECT_THAT(table, HasSubstr(MetresText(rmse)));
  EXPECT_THAT(table, HasSubstr(" 98 88 78 %\n"));
  EXPECT_EQ(json["parameters"][0]["observability"]["wheel_base"],
            e.parameters[0].convergence.observability(2));
  // Complete: no number that JSON cannot hold.
  EXPECT_THAT(json.dump(), testing::Not(HasSubstr("nan")));
}

TEST(MetresText, ChoosesTheUnit) {
  EXPECT_EQ(MetresText(0.00734), "7.34 mm");
  EXPECT_EQ(MetresText(0.732), "732.0 mm");
  EXPECT_EQ(MetresText(2.5), "2.500 m");
}

TEST(EvaluationTextTest, DecimalsFollowSigma) {
  EXPECT_EQ(WithSigmaText(361.04123, 2.5312), "361.0 ± 2.5");
  EXPECT_EQ(WithSigmaText(176.8, 15.3), "177 ± 15");
  EXPECT_EQ(WithSigmaText(1.0, 0.00123), "1.0000 ± 0.0012");
  EXPECT_EQ(WithSigmaText(-2.0, 1e-9), "-2.000000 ± 0.000000");
  EXPECT_EQ(WithSigmaText(349.0, 0.0), "349.0000");
}

}  // namespace
}  // namespace waymark
