#include "logs/import/optiodom_diffdrive.h"

#include "tests/logs/import/import_test_tools.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

constexpr char kMetadata[] =
    "type,diff,,,\nngear,43.7,,,\nencRes,64,,,\nLi,0.2,,,\nDi,0.084,0.084,,\n"
    "Thi,,,,\nN,6,,,\n";

std::string RunText(const std::vector<SimulatedReading>& drive) {
  std::string text;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    const SimulatedReading& now = drive[i];
    const SimulatedReading& before = drive[i == 0 ? 0 : i - 1];
    text += Format("%.15g,%.15g,%.15g,%.15g,%.0f,%.0f\r\n",
                   Seconds(now.time - drive[0].time),
                   now.X_WR.x,
                   now.X_WR.y,
                   now.X_WR.heading,
                   now.right_ticks - before.right_ticks,
                   now.left_ticks - before.left_ticks);
  }
  return text;
}

TEST(OptiodomTest, DriveComesBack) {
  const TemporaryDirectory folder;
  const double k = kPi * 0.084 / (64.0 * 43.7);
  const auto drive = NoiselessDrive({k, k, 0.2}, 20.0, 60.0);
  WriteText(folder / "7_metadata.csv", kMetadata);
  WriteText(folder / "7_run-01.csv", RunText(drive));
  const Recording recording = ReadOptiodomRun(folder / "7_run-01.csv");
  EXPECT_EQ(recording.name, "7_run-01");
  ASSERT_EQ(recording.encoders.size(), drive.size());
  ASSERT_EQ(recording.reference.samples.size(), drive.size());
  for (std::size_t i = 0; i < drive.size(); ++i) {
    EXPECT_EQ(recording.encoders[i].time, drive[i].time);
    EXPECT_EQ(static_cast<double>(recording.encoders[i].right),
              drive[i].right_ticks);
    EXPECT_EQ(static_cast<double>(recording.encoders[i].left),
              drive[i].left_ticks);
  }
  EXPECT_DOUBLE_EQ(recording.nominal.parameters.k_right, k);
  EXPECT_EQ(recording.nominal.source, "nominal");
  // The text holds 15 digits; the rest is rounding. A swap of the wheels or a
  // sign would be off by metres.
  EXPECT_LT(NominalRmse(recording), 1e-9);
}

TEST(OptiodomTest, TicksOfATurnComeFromMetadata) {
  const TemporaryDirectory folder;
  const std::string run = "0,0,0,0,0,0\n0.05,0,0,0,3,-4\n";
  WriteText(folder / "7_run-01.csv", run);
  EXPECT_THAT(ReadOptiodomRun(folder / "7_run-01.csv").notes[0],
              HasSubstr("no metadata file"));
  WriteText(folder / "7_metadata.csv",
            "type,diff\nngear,10\nencRes,100\nLi,0.205\nDi,0.084,0.084\n");
  const Recording recording = ReadOptiodomRun(folder / "7_run-01.csv");
  const WheelParameters& nominal = recording.nominal.parameters;
  EXPECT_DOUBLE_EQ(nominal.k_right, kPi * 0.084 / 1000);
  EXPECT_DOUBLE_EQ(nominal.k_left, kPi * 0.084 / 1000);
  // Not what that experiment's controller was told.
  EXPECT_DOUBLE_EQ(nominal.wheel_base, 0.2);
  EXPECT_THAT(recording.notes[0], HasSubstr("0.205 m apart"));
  EXPECT_EQ(recording.encoders[1].right, 3);
  EXPECT_EQ(recording.encoders[1].left, -4);
}

TEST(OptiodomTest, RunsBelowAFolderInOrder) {
  const TemporaryDirectory folder;
  EXPECT_THAT(InputErrorOf([&] { (void)FindOptiodomRuns(folder / ""); }),
              EndsWith("no file *_run-NN.csv"));
  EXPECT_THAT(InputErrorOf([&] { (void)FindOptiodomRuns(folder / "none"); }),
              HasSubstr("none: No such file"));
  std::filesystem::create_directory(folder / "b");
  std::filesystem::create_directory(folder / "a");
  for (const char* name : {"b/1_run-01.csv",
                           "a/2_run-02.csv",
                           "a/2_run-01.csv",
                           "a/2_metadata.csv"}) {
    WriteText(folder / name, "x");
  }
  EXPECT_THAT(FindOptiodomRuns(folder / ""),
              testing::ElementsAre(EndsWith("a/2_run-01.csv"),
                                   EndsWith("a/2_run-02.csv"),
                                   EndsWith("b/1_run-01.csv")));
}

TEST(OptiodomTest, BadInputNamesFileAndLine) {
  const TemporaryDirectory folder;
  const std::string path = folder / "7_run-01.csv";
  const auto error = [&](const std::string& text) {
    WriteText(path, text);
    return InputErrorOf([&] { (void)ReadOptiodomRun(path); });
  };
  const std::string good = "0,0,0,0,0,0\n";
  EXPECT_THAT(error(good + "0.05,0,0,0,1\n"),
              EndsWith("7_run-01.csv:2: 5 columns, 6 needed"));
  EXPECT_THAT(error(good + "0.05,0,abc,0,1,1\n"),
              EndsWith("7_run-01.csv:2: column 3: \"abc\" is not a number"));
  EXPECT_THAT(error(good + "0.05,0,,0,1,1\n"),
              EndsWith(":2: column 3: \"\" is not a number"));
  EXPECT_THAT(error(good + "0.05,inf,0,0,1,1\n"),
              EndsWith(":2: column 2: \"inf\" is not finite"));
  EXPECT_THAT(error(good + "0.05,1e999,0,0,1,1\n"),
              EndsWith(":2: column 2: \"1e999\" does not fit a double"));
  EXPECT_THAT(error(good + "0.05,0,0,0,0.5,1\n"),
              EndsWith(":2: column 5: \"0.5\" is not a whole number"));
  EXPECT_THAT(error(good + "0.1,0,0,0,1,1\n0.05,0,0,0,1,1\n"),
              EndsWith(":3: column 1: time does not increase"));
  EXPECT_THAT(error(good + good),
              EndsWith(":2: column 1: time does not increase"));
  EXPECT_THAT(error("0,0,0,0,0,1e7\n"),
              EndsWith(":1: column 6: is beyond 1e6 ticks in a cycle"));
  EXPECT_THAT(error("-1,0,0,0,0,0\n"), HasSubstr(":1: column 1: is no time"));
  EXPECT_THAT(error(""), EndsWith("7_run-01.csv: is empty"));
  EXPECT_THAT(error("\n"), EndsWith("7_run-01.csv: has no records"));
  WriteText(folder / "7_metadata.csv", "type,tricycle\n");
  EXPECT_THAT(error(good), HasSubstr("7_metadata.csv:1: column 2: \"diff\""));
  WriteText(folder / "7_metadata.csv", "type,diff\nLi,0\n");
  EXPECT_THAT(error(good),
              EndsWith("7_metadata.csv:2: column 2: must be positive"));
  std::filesystem::remove(path);
  EXPECT_THAT(
      InputErrorOf([&] { (void)ReadOptiodomRun(path); }),
      EndsWith("7_run-01.csv: cannot be opened: No such file or directory"));
  EXPECT_THAT(InputErrorOf([&] { (void)ReadOptiodomRun(folder / ""); }),
              EndsWith("is a folder, not a file"));
}

}  // namespace
}  // namespace waymark
