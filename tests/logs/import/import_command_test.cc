#include "logs/import/import_command.h"

#include "logs/import/import_formats.h"
#include "processes/support/log_file.h"
#include "tests/logs/import/import_test_tools.h"
#include "tests/support/temporary_directory.h"

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace waymark {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

constexpr char kRun[] = "0,0,0,0,0,0\n0.05,0.01,0,0,5,5\n0.1,0.02,0,0,5,5\n";
constexpr char kTuple[] =
    "{\"T\": 0.8, \"phi_l\": 0.1, \"phi_r\": 0.1, \"sm\": [0, 0, 0]}\n";

// Runs "import <arguments>" and returns what the error says.
std::string Import(std::vector<std::string> arguments) {
  CLI::App app;
  int exit_code = 0;
  AddImportCommand(&app, &exit_code);
  arguments.insert(arguments.begin(), "import");
  std::reverse(arguments.begin(), arguments.end());  // As CLI11 wants them.
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    return error.what();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

int NumEvents(const std::string& path) {
  LogReader reader(path);
  int count = 0;
  while (reader.Next()) ++count;
  return count;
}

TEST(ImportFormatsTest, AreToldByContent) {
  const TemporaryDirectory folder;
  const auto format_of = [&](const std::string& text) {
    WriteText(folder / "any", text);
    return DetectImportFormat(folder / "any");
  };
  EXPECT_EQ(format_of(kRun), ImportFormat::kOptiodomDiffdrive);
  EXPECT_EQ(format_of(kTuple), ImportFormat::kCensiJointCalibration);
  EXPECT_EQ(format_of("M 204 1 2\n"), ImportFormat::kBrennerLegoRobot4);
  EXPECT_EQ(format_of("\nodom2diff 1"), ImportFormat::kTucLabyrinthDiffdrive);
  EXPECT_EQ(format_of(std::string("\xED\xA1\xDA\x01\0\0", 6)),
            ImportFormat::kLcmMaebotLogs);
  for (const char* text : {"", "1,2,3\n", "a,b,c,d,e,f\n", "hello\n"}) {
    EXPECT_THAT(InputErrorOf([&] { (void)format_of(text); }),
                HasSubstr("any: is none of the known formats (brenner"));
  }
  EXPECT_THAT(InputErrorOf([&] { (void)DetectImportFormat(folder / "none"); }),
              EndsWith("none: no such file"));
  for (const std::string& name : ImportFormatNames()) {
    EXPECT_EQ(NameOf(*ImportFormatFromName(name)), name);
  }
  EXPECT_FALSE(ImportFormatFromName("mp3"));
}

// Times of the events on a channel, microseconds.
std::vector<std::int64_t> TimesOf(const std::string& path,
                                  const std::string& channel) {
  LogReader reader(path);
  std::vector<std::int64_t> times;
  while (const auto event = reader.Next()) {
    if (event->channel == channel) times.push_back(Microseconds(event->time));
  }
  return times;
}

TEST(ImportCommandTest, ADelayedReferenceIsSetBack) {
  const TemporaryDirectory folder;
  WriteText(folder / "1_run-01.csv", kRun);
  const std::string run = folder / "1_run-01.csv";
  ASSERT_EQ(Import({run, folder / "a.log"}), "no error");
  ASSERT_EQ(Import({run, folder / "b.log", "--reference-delay", "0.02"}),
            "no error");
  for (const char* channel : {"POSITION_FIX", "TRUTH"}) {
    std::vector<std::int64_t> times = TimesOf(folder / "a.log", channel);
    ASSERT_FALSE(times.empty());
    for (std::int64_t& time : times) time -= 20'000;
    EXPECT_EQ(TimesOf(folder / "b.log", channel), times);
  }
  EXPECT_EQ(TimesOf(folder / "a.log", "ENCODERS"),
            TimesOf(folder / "b.log", "ENCODERS"));
  const auto bytes = ReadBytes(folder / "b.log");
  EXPECT_THAT(std::string(bytes.begin(), bytes.end()),
              HasSubstr("set back by 0.02 s"));
  EXPECT_THAT(Import({run, folder / "c.log", "--reference-delay", "11"}),
              HasSubstr("--reference-delay"));
}

TEST(ImportCommandTest, OneRunBecomesOneLog) {
  const TemporaryDirectory folder;
  const std::string run = folder / "1_run-01.csv";
  WriteText(run, kRun);
  const std::string out = folder / "out.log";
  EXPECT_EQ(Import({run, out}), "no error");
  // CONFIG, nominal parameters, start, 3 readings, 1 fix, 2 truth samples.
  EXPECT_EQ(NumEvents(out), 9);
  EXPECT_THAT(Import({run, out}),
              EndsWith("out.log: exists already; --force "
                       "replaces it"));
  EXPECT_THAT(Import({run, run, "--force"}),
              EndsWith("run-01.csv: is an input too; choose another name"));
  EXPECT_EQ(Import({run, out, "--force", "--every", "2"}), "no error");
  EXPECT_EQ(NumEvents(out), 9);
  EXPECT_EQ(Import({"optiodom_diffdrive", run, folder / "b.log"}), "no error");
  EXPECT_EQ(ReadBytes(folder / "b.log").empty(), false);
  // The same log whether the format is named, given or found out.
  EXPECT_EQ(Import({run, folder / "c.log"}), "no error");
  EXPECT_EQ(Import({"--format", "optiodom_diffdrive", run, folder / "d.log"}),
            "no error");
  EXPECT_EQ(ReadBytes(folder / "b.log"), ReadBytes(folder / "c.log"));
  EXPECT_EQ(ReadBytes(folder / "b.log"), ReadBytes(folder / "d.log"));
}

TEST(ImportCommandTest, AFolderBecomesManyLogs) {
  const TemporaryDirectory folder;
  std::filesystem::create_directories(folder / "in/deeper");
  WriteText(folder / "in/1_run-01.csv", kRun);
  WriteText(folder / "in/deeper/2_run-01.csv", kRun);
  EXPECT_THAT(Import({folder / "in", folder / "one.log"}),
              EndsWith("one.log: 2 recordings go into a folder, not into one "
                       "log"));
  EXPECT_EQ(Import({folder / "in", folder / "out"}), "no error");
  EXPECT_EQ(NumEvents(folder / "out/1_run-01.log"), 9);
  EXPECT_EQ(NumEvents(folder / "out/2_run-01.log"), 9);
  WriteText(folder / "in/deeper/1_run-01.csv", kRun);
  EXPECT_THAT(Import({folder / "in", folder / "out2"}),
              EndsWith("out2: two recordings are named 1_run-01"));
}

TEST(ImportCommandTest, OneBadRecordingAndNothingIsWritten) {
  const TemporaryDirectory folder;
  std::filesystem::create_directory(folder / "in");
  WriteText(folder / "in/1_run-01.csv", kRun);
  WriteText(folder / "in/1_run-02.csv", std::string(kRun) + "0.2,x,0,0,1,1\n");
  EXPECT_THAT(Import({folder / "in", folder / "out"}),
              EndsWith("1_run-02.csv:4: column 2: \"x\" is not a number"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(ImportCommandTest, UsesOfTheReference) {
  const TemporaryDirectory folder;
  const std::string run = folder / "1_run-01.csv";
  WriteText(run, kRun);
  EXPECT_EQ(Import({run, folder / "a.log", "--use", "calibration"}),
            "no error");
  EXPECT_EQ(NumEvents(folder / "a.log"), 9);  // 3 fixes, no truth.
  EXPECT_EQ(Import({run,
                    folder / "b.log",
                    "--heading",
                    "--noise-m",
                    "0",
                    "--noise-rad",
                    "0",
                    "--seed",
                    "7"}),
            "no error");
  WriteText(folder / "lmov.tuple", kTuple);
  const std::string tuple = folder / "lmov.tuple";
  EXPECT_THAT(Import({tuple, folder / "t.log"}), HasSubstr("the mounting"));
  EXPECT_EQ(Import({tuple, folder / "t.log", "--mounting", "0", "0", "-90"}),
            "no error");
}

TEST(ImportCommandTest, BadFlagsAndInputsAreOneLine) {
  const TemporaryDirectory folder;
  const std::string run = folder / "1_run-01.csv";
  WriteText(run, kRun);
  const std::string out = folder / "out.log";
  EXPECT_THAT(Import({}), HasSubstr("paths is required"));
  EXPECT_THAT(Import({run}), HasSubstr("at least one input and the output"));
  EXPECT_THAT(Import({folder / "none", out}), EndsWith("none: no such file"));
  EXPECT_THAT(Import({run, out, "--every", "0"}), HasSubstr("--every"));
  EXPECT_THAT(Import({run, out, "--noise-m", "-1"}), HasSubstr("--noise-m"));
  EXPECT_THAT(Import({run, out, "--noise-m", "nan"}),
              HasSubstr("--noise-m: 'nan'"));
  EXPECT_THAT(Import({run, out, "--use", "both"}), HasSubstr("--use"));
  for (const char* flag : {"--every", "--noise-m", "--noise-rad", "--seed"}) {
    EXPECT_EQ(Import({run, out, "--use", "calibration", flag, "2"}),
              std::string(flag) + ": goes with --use running only");
  }
  EXPECT_THAT(Import({run, out, "--format", "mp3"}), HasSubstr("--format"));
  EXPECT_THAT(Import({run, out, "--mounting", "1"}), HasSubstr("--mounting"));
  WriteText(folder / "run_motors.txt", "M 1 1 0 0 0 1 0 0 0 0 0 0 0\n");
  WriteText(folder / "run_reference.txt", "P 1 1 1\n");
  EXPECT_THAT(Import({folder / "run_motors.txt", out, "--heading"}),
              HasSubstr("--heading: the reference has no headings"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace waymark
