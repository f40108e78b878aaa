#include "logs/import/censi_joint_calibration.h"

#include "tests/logs/import/import_test_tools.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

std::string TupleText(double seconds,
                      double left_rate,
                      double right_rate,
                      const Pose2& X_S0S1) {
  return Format(
      "{ \"T\": %.17g, \"phi_l\": %.17g, \"phi_r\": %.17g, "
      "\"sm\": [ %.17g, %.17g, %.17g ] }",
      seconds,
      left_rate,
      right_rate,
      X_S0S1.x,
      X_S0S1.y,
      X_S0S1.heading);
}

// Wheel velocities and the motion of a laser mounted askew, from the same
// simulated drive: after import, dead reckoning predicts every motion.
TEST(CensiTest, DriveComesBack) {
  const TemporaryDirectory folder;
  // Of the simulated drive; its ticks are not the importer's.
  const WheelParameters wheels{1e-5, 1e-5, 0.08841};
  const double rad_per_tick = 1e-5 / 0.0205;
  const Pose2 X_RS{0.02, -0.01, -0.5 * kPi};
  const auto drive = NoiselessDrive(wheels, 1.25, 80.0);
  std::string text;
  for (std::size_t i = 1; i < drive.size(); ++i) {
    const SimulatedReading& a = drive[i - 1];
    const SimulatedReading& b = drive[i];
    const double seconds = Seconds(b.time - a.time);
    text += TupleText(seconds,
                      (b.left_ticks - a.left_ticks) * rad_per_tick / seconds,
                      (b.right_ticks - a.right_ticks) * rad_per_tick / seconds,
                      Between(a.X_WR * X_RS, b.X_WR * X_RS));
    // One object to a line, now and then two.
    text += i % 10 == 3 ? " " : "\n";
  }
  WriteText(folder / "any.tuple", text);
  const Recording recording =
      ReadCensiTuples(folder / "any.tuple", CensiOptions{X_RS});
  ASSERT_EQ(recording.encoders.size(), drive.size());
  ASSERT_EQ(recording.motions.size(), drive.size() - 1);
  EXPECT_TRUE(recording.has_virtual_ticks);
  EXPECT_FALSE(recording.start);
  const auto path =
      DeadReckon(recording.encoders, recording.nominal.parameters);
  for (std::size_t i = 0; i < recording.motions.size(); ++i) {
    const RelativeMotion& motion = recording.motions[i];
    EXPECT_EQ(motion.from, recording.encoders[i].time);
    EXPECT_EQ(motion.time, recording.encoders[i + 1].time);
    EXPECT_EQ(motion.seq, static_cast<std::int64_t>(i));
    EXPECT_EQ(motion.time, drive[i + 1].time);
    const Pose2 predicted =
        Between(path[i].X_WR * motion.X_RS, path[i + 1].X_WR * motion.X_RS);
    const Pose2 error = Between(predicted, motion.X_S0S1);
    // Rounding to virtual ticks: up to one tick (20.5 nm) for either wheel of
    // an interval, so 41 nm / 88 mm = 0.46 urad.
    EXPECT_LT(error.position().norm(), 5e-8);
    EXPECT_LT(std::abs(error.heading), 5e-7);
  }
}

// Rounding the sum, not the parts: no drift after very many parts.
TEST(CensiTest, VirtualTicksDoNotDrift) {
  const TemporaryDirectory folder;
  std::string text;
  // 0.4 tick of each interval would be lost or doubled by rounding parts.
  const double left = 1.4e-6 / 0.8;
  const double right = -0.4e-6 / 0.8;
  for (int i = 0; i < 5000; ++i) {
    text += TupleText(0.8, left, right, {}) + "\n";
  }
  WriteText(folder / "lstraight_x.tuple", text);
  const Recording recording = ReadCensiTuples(folder / "lstraight_x.tuple");
  for (std::size_t i = 0; i < recording.encoders.size(); ++i) {
    const auto n = static_cast<double>(i);
    const EncoderReading& reading = recording.encoders[i];
    // Half a tick, and the last bits of the sums.
    EXPECT_LE(std::abs(static_cast<double>(reading.left) - 1.4 * n), 0.500001);
    EXPECT_LE(std::abs(static_cast<double>(reading.right) + 0.4 * n), 0.500001);
  }
  EXPECT_EQ(recording.encoders.back().left, 7000);
  EXPECT_EQ(recording.encoders.back().right, -2000);
}

TEST(CensiTest, MountingFollowsFromTheName) {
  const TemporaryDirectory folder;
  const std::string text = TupleText(0.8, 0.1, 0.1, {});
  for (const char* name : {"lstraight_0.tuple", "l90.tuple", "lmov.tuple"}) {
    WriteText(folder / name, text);
  }
  EXPECT_EQ(ReadCensiTuples(folder / "lstraight_0.tuple").motions[0].X_RS,
            Pose2());
  EXPECT_EQ(ReadCensiTuples(folder / "l90.tuple").motions[0].X_RS.heading,
            -0.5 * kPi);
  EXPECT_THAT(
      InputErrorOf([&] { (void)ReadCensiTuples(folder / "lmov.tuple"); }),
      HasSubstr("lmov.tuple: the mounting"));
  EXPECT_EQ(FindCensiTuples(folder / "").size(), 3u);
}

TEST(CensiTest, BadInputNamesFileAndLine) {
  const TemporaryDirectory folder;
  const std::string path = folder / "l90.tuple";
  const auto error = [&](const std::string& text) {
    WriteText(path, text);
    return InputErrorOf([&] { (void)ReadCensiTuples(path); });
  };
  const std::string good = TupleText(0.8, 0.1, 0.1, {}) + "\n";
  EXPECT_THAT(error(good + "{ \"T\": 0.8"),
              EndsWith("l90.tuple:2: is not a JSON object"));
  EXPECT_THAT(error(good + "hello"), EndsWith(":2: is not a JSON object"));
  EXPECT_THAT(error(good + "}{"), EndsWith(":2: is not a JSON object"));
  EXPECT_THAT(error(good + TupleText(0.8, 1, 1, {}) + " 7"),
              EndsWith(":2: is not a JSON object"));
  EXPECT_THAT(error("{}"), EndsWith(":1: \"T\" is missing"));
  EXPECT_THAT(error("{\"T\": \"x\"}"), EndsWith(":1: \"T\" is not a number"));
  EXPECT_THAT(error(TupleText(-0.8, 1, 1, {})),
              HasSubstr(":1: \"T\" is -0.800000 s, more than 0"));
  const std::string head = "{\"T\": 1, \"phi_l\": 1, \"phi_r\": ";
  EXPECT_THAT(error(head + "1, \"sm\": [1, 2]}"),
              EndsWith(":1: \"sm\" is not a list of 3 numbers"));
  EXPECT_THAT(error(head + "1, \"sm\": [1, 2, \"x\"]}"),
              EndsWith(":1: entry 2 of \"sm\" is not a number"));
  EXPECT_THAT(error(head + "NaN, \"sm\": [1, 2, 3]}"),
              EndsWith(":1: is not a JSON object"));
  EXPECT_THAT(error(TupleText(1, 1e5, 1, {})), HasSubstr("beyond 1e4 rad/s"));
  EXPECT_THAT(error(""), EndsWith("l90.tuple: is empty"));
  EXPECT_THAT(error("\n"), EndsWith("l90.tuple: has no records"));
}

TEST(CensiTest, ResultsOfTheAuthors) {
  const TemporaryDirectory folder;
  const std::string path = folder / "r.json";
  std::string covariance;
  for (int i = 0; i < 6; ++i) {
    covariance += i == 0 ? "[[" : "], [";
    for (int j = 0; j < 6; ++j) {
      covariance += (j == 0 ? "" : ", ") + std::to_string(10 * i + j);
    }
  }
  const std::string head =
      "{\"axle\": 0.088, \"l_diam\": 0.041, \"r_diam\": 0.042, \"l_x\": 1, "
      "\"l_y\": 2, \"l_theta\": 7";
  WriteText(path, head + ", \"covariance\": " + covariance + "]]}");
  const CensiResult result = ReadCensiResult(path);
  EXPECT_EQ(result.wheels, (WheelParameters{0.021, 0.0205, 0.088}));
  EXPECT_EQ(result.X_RS, (Pose2{1.0, 2.0, WrapAngle(7.0)}));
  EXPECT_EQ(result.covariance(0, 0), 11.0);  // Right wheel: their second.
  EXPECT_EQ(result.covariance(1, 2), 2.0);   // Left with axle.
  EXPECT_EQ(result.covariance(3, 5), 35.0);
  WriteText(path, head + "}");
  EXPECT_THAT(InputErrorOf([&] { (void)ReadCensiResult(path); }),
              EndsWith("r.json: \"covariance\" is not a 6 x 6 list"));
  WriteText(path, "[1]");
  EXPECT_THAT(InputErrorOf([&] { (void)ReadCensiResult(path); }),
              EndsWith("r.json: is not a JSON object"));
}

}  // namespace
}  // namespace waymark
