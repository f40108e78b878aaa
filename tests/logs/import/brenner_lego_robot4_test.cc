#include "logs/import/brenner_lego_robot4.h"

#include "tests/logs/import/import_test_tools.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

std::string MotorLine(std::int64_t ms, std::int64_t left, std::int64_t right) {
  return Format("M %lld %lld 0 0 0 %lld 0 0 0 0 0 0 0\n",
                static_cast<long long>(ms),
                static_cast<long long>(left),
                static_cast<long long>(right));
}

class BrennerLegoTest : public testing::Test {
 protected:
  void Write(const std::string& motors, const std::string& reference) {
    WriteText(folder_ / "run_motors.txt", motors);
    WriteText(folder_ / "run_reference.txt", reference);
  }
  std::string Error() {
    return InputErrorOf([&] { (void)ReadBrennerLegoRobot4(folder_ / ""); });
  }
  TemporaryDirectory folder_;
};

// Writes a simulated drive of the nominal robot that starts where the course
// says and expects dead reckoning of what is read back to be its truth.
TEST_F(BrennerLegoTest, DriveComesBack) {
  DriveSimulationOptions options;
  options.parameters = {0.349e-3, 0.349e-3, 0.150};
  options.noise = {0.0, 0.0};
  options.rate_hz = 4.0;
  const Pose2 X_WS{1.850, 1.897, WrapAngle(RadiansFromDegrees(213.0))};
  options.start = X_WS * Pose2{-0.030, 0.0, 0.0};
  const auto drive = SimulateDrive(options, SquareDriver(0.1, 0.5, 0.4));
  std::string motors;
  std::string reference;
  for (const SimulatedReading& reading : drive) {
    const std::int64_t ms =
        (reading.time - options.start_time).count() / 1000 + 200;
    const Eigen::Vector2d p_WS = reading.X_WR * Eigen::Vector2d(0.030, 0.0);
    motors += MotorLine(ms,
                        std::llround(reading.left_ticks) + 20795,
                        std::llround(reading.right_ticks) + 16067);
    reference += Format("P %lld %.9f %.9f\n",
                        static_cast<long long>(ms),
                        1e3 * p_WS.x(),
                        1e3 * p_WS.y());
  }
  Write(motors, reference);
  const Recording recording = ReadBrennerLegoRobot4(folder_ / "");
  ASSERT_EQ(recording.encoders.size(), drive.size());
  ASSERT_EQ(recording.reference.samples.size(), drive.size());
  EXPECT_EQ(recording.encoders[0].left, 20795);
  EXPECT_EQ(recording.encoders[0].right, 16067);
  EXPECT_EQ(Microseconds(recording.encoders[0].time), 1'000'200'000);
  EXPECT_GT(PathLength(recording.reference), 3.0);
  // The text holds 1e-12 m; the rest is rounding.
  EXPECT_LT(NominalRmse(recording), 1e-9);
}

TEST_F(BrennerLegoTest, RepeatedRecordsAreMergedAndCounted) {
  Write(MotorLine(100, 1, 2) + MotorLine(100, 1, 2) + MotorLine(350, 3, 4),
        "P 120 1850 1897\nP 230 1850 1897\nP 340 1851 1897\n");
  const Recording recording = ReadBrennerLegoRobot4(folder_ / "");
  ASSERT_EQ(recording.encoders.size(), 2u);
  EXPECT_EQ(recording.encoders[1].seq, 1);
  EXPECT_EQ(recording.encoders[1].left, 3);
  EXPECT_EQ(recording.encoders[1].right, 4);
  EXPECT_EQ(recording.reference.samples.size(), 3u);
  EXPECT_THAT(recording.notes[0], HasSubstr("1 motor records that repeat"));
}

TEST_F(BrennerLegoTest, ScansBecomeRegularRanges) {
  Write(MotorLine(100, 1, 2), "P 120 1850 1897\n");
  std::string scan = "S 130 660";
  for (int i = 0; i < 660; ++i) scan += " " + std::to_string(1000 + i);
  WriteText(folder_ / "run_scan.txt", scan + "\n");
  const Recording recording = ReadBrennerLegoRobot4(folder_ / "");
  ASSERT_EQ(recording.scans.size(), 1u);
  const RangeScan& read = recording.scans[0];
  EXPECT_EQ(Microseconds(read.time), 1'000'130'000);
  ASSERT_EQ(read.ranges.size(), 660u);
  EXPECT_FLOAT_EQ(read.ranges[659], 1.659f);
  // Beam 330 looks ahead but for the mounting angle of -4 degrees.
  EXPECT_NEAR(
      DegreesFromRadians(read.first_angle + 330 * read.step), -4.0, 1e-9);
}

TEST_F(BrennerLegoTest, BadInputNamesFileAndLine) {
  const std::string good = MotorLine(100, 1, 2);
  const std::string reference = "P 120 1850 1897\n";
  EXPECT_THAT(Error(), EndsWith("0 files *_motors.txt, 1 needed"));
  Write(good + "M 200 x 0 0 0 2 0 0 0 0 0 0 0\n", reference);
  EXPECT_THAT(Error(),
              EndsWith("run_motors.txt:2: column 3: \"x\" is not a number"));
  Write(good + "\nM 200 nan 0 0 0 2 0 0 0 0 0 0 0\n", reference);
  EXPECT_THAT(Error(),
              EndsWith("run_motors.txt:3: column 3: \"nan\" is not finite"));
  Write(good + "M 200 1.5 0 0 0 2 0 0 0 0 0 0 0\n", reference);
  EXPECT_THAT(Error(), EndsWith("\"1.5\" is not a whole number"));
  Write(good + "M 200 1 2\n", reference);
  EXPECT_THAT(Error(), EndsWith("run_motors.txt:2: 4 columns, 14 needed"));
  Write(good + MotorLine(99, 1, 2), reference);
  EXPECT_THAT(Error(), EndsWith(":2: column 2: time goes backwards by 1 ms"));
  Write(good + MotorLine(100, 1, 3), reference);
  EXPECT_THAT(Error(), HasSubstr(":2: repeats the stamp"));
  Write(good, "Q 120 1850 1897\n");
  EXPECT_THAT(Error(), EndsWith("run_reference.txt:1: column 1: \"P\" needed"));
  Write(good, reference + reference);
  EXPECT_THAT(Error(),
              EndsWith("run_reference.txt:2: column 2: repeats the stamp of "
                       "the line before"));
  Write(good, "");
  EXPECT_THAT(Error(), EndsWith("run_reference.txt: is empty"));
  Write(good, "\n\n");
  EXPECT_THAT(Error(), EndsWith("run_reference.txt: has no records"));
  Write(good, reference);
  WriteText(folder_ / "run_scan.txt", "S 130 3 1 2\n");
  EXPECT_THAT(Error(),
              EndsWith("run_scan.txt:1: column 3: 3 ranges stated, 2 follow"));
  std::filesystem::remove(folder_ / "run_reference.txt");
  EXPECT_THAT(
      Error(),
      EndsWith(
          "run_reference.txt: cannot be opened: No such file or directory"));
}

}  // namespace
}  // namespace waymark
