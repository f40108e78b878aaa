// waymark-log as people and scripts meet it: exit codes and lines.
#include "tests/logs/log_tool/log_maker.h"

#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace waymark {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

struct Outcome {
  int exit_code = -1;
  std::string text;  // Of stdout and stderr.
};

class LogToolProgramTest : public LogToolTest {
 protected:
  static Outcome RunTool(const std::string& arguments) {
    const char* build = std::getenv("WAYMARK_BUILD");
    const std::string command = std::string(build == nullptr ? "." : build) +
                                "/bin/waymark-log " + arguments + " 2>&1";
    Outcome run;
    std::FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 4096> block;
    while (const std::size_t n =
               std::fread(block.data(), 1, block.size(), pipe)) {
      run.text.append(block.data(), n);
    }
    run.exit_code = WEXITSTATUS(pclose(pipe));
    return run;
  }

  // Exit code 2 and one line that says `what`.
  static void ExpectRefused(const std::string& arguments,
                            const std::string& what) {
    SCOPED_TRACE(arguments);
    const Outcome run = RunTool(arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(std::count(run.text.begin(), run.text.end(), '\n'), 1);
    EXPECT_THAT(run.text, AllOf(StartsWith("waymark-log: "), HasSubstr(what)));
  }
};

TEST_F(LogToolProgramTest, Help) {
  for (const char* command : {"", "info", "check", "repair", "cut", "export"}) {
    const Outcome run = RunTool(std::string(command) + " --help");
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_THAT(run.text, HasSubstr("Usage: waymark-log"));
  }
}

TEST_F(LogToolProgramTest, SoundLog) {
  WriteDrive();
  Outcome run = RunTool("info " + log_);
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.text,
              AllOf(HasSubstr("30 events on 2 channels, 1.9 s, "),
                    HasSubstr("from 2023-11-14 22:13:20.000 UTC"),
                    HasSubstr("no damage"),
                    HasSubstr("waymark.encoders_t")));
  run = RunTool("check " + log_);
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.text, HasSubstr("30 events, sound"));
  run = RunTool("info --json " + log_);
  EXPECT_THAT(run.text, HasSubstr("\"rate_hz\": 10.0"));
}

TEST_F(LogToolProgramTest, DamagedLog) {
  WriteDrive();
  auto bytes = ReadBytes(log_);
  bytes.erase(bytes.end() - 10, bytes.end());
  WriteBytes(log_, bytes);
  Outcome run = RunTool("check " + log_);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.text, AllOf(HasSubstr("torn end"), HasSubstr("damaged")));
  EXPECT_EQ(RunTool("info " + log_).exit_code, 0);
  run = RunTool("repair " + log_ + " " + out_);
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.text, HasSubstr("bytes in 1 place were lost"));
  EXPECT_EQ(RunTool("check " + out_).exit_code, 0);
}

TEST_F(LogToolProgramTest, CutAndExport) {
  WriteDrive();
  EXPECT_EQ(RunTool("cut " + log_ + " " + out_ +
                    " --start 0.5 --end 1.5 --channels 'POSE' -v")
                .exit_code,
            0);
  EXPECT_EQ(ReadAll(out_).size(), 10U);
  EXPECT_EQ(
      RunTool("export " + log_ + " --csv " + (directory_ / "csv")).exit_code,
      0);
  EXPECT_EQ(RunTool("export " + log_ + " --channel POSE --tum " +
                    (directory_ / "a.tum"))
                .exit_code,
            0);
}

TEST_F(LogToolProgramTest, BadInputIsOneLineAndExitCode2) {
  WriteDrive();
  const std::string picture = directory_ / "picture.jpg";
  const std::vector<std::uint8_t> jpeg = {0xFF, 0xD8, 0xFF, 0xE0, 0, 16, 'J'};
  WriteBytes(picture, jpeg);
  const std::string empty = directory_ / "empty.log";
  WriteBytes(empty, {});
  for (const std::string command : {"info ", "check "}) {
    ExpectRefused(command + "/none.log", "/none.log: cannot be opened");
    ExpectRefused(command + "/tmp", "/tmp: is a directory");
    ExpectRefused(command + picture, "is not an LCM log");
    ExpectRefused(command + empty, "is empty");
  }
  for (const std::string command : {"repair ", "cut "}) {
    ExpectRefused(command + picture + " " + out_, "is not an LCM log");
    ExpectRefused(command + log_ + " " + picture, "exists already");
    ExpectRefused(command + log_ + " " + log_ + " -f", "is an input too");
    ExpectRefused(command + log_ + " /dev/full -f", "No space left on device");
    ExpectRefused(command + log_ + " /none/a.log", "cannot be created");
  }
  ExpectRefused("", "needs a command: info, check, repair, cut, export");
  ExpectRefused("frobnicate", "'frobnicate' is none; needs a command: info");
  ExpectRefused("info", "log is required");
  ExpectRefused("info --types /none " + log_, "/none");
  ExpectRefused("cut " + log_ + " " + out_ + " --start=-3", "--start: '-3'");
  ExpectRefused("cut " + log_ + " " + out_ + " -c '['", "--channels");
  ExpectRefused("export " + log_, "one of --csv DIR, --tum FILE and");
  ExpectRefused("export " + log_ + " --tum /tmp/x", "--channel");
  ExpectRefused("export " + log_ + " --tum /dev/null --channel POSE",
                "exists already");
  ExpectRefused("export " + log_ + " --csv " + picture, "cannot be made");
  EXPECT_EQ(ReadBytes(picture), jpeg);
}

TEST_F(LogToolProgramTest, OutputsNeverReplaceWhatWasNotMeant) {
  WriteDrive();
  const auto log = ReadBytes(log_);
  const std::string link = directory_ / "link.log";
  std::filesystem::create_hard_link(log_, link);
  const std::string mine = directory_ / "mine";
  WriteBytes(mine, std::vector<std::uint8_t>{1, 2});
  const std::string page = " --out " + (directory_ / "page.html");
  // Each command but for the output's name.
  for (const std::string& command :
       {"evaluate " + log_ + " --json ",
        "evaluate " + mine + " --inputs " + log_ + " --json ",
        "report " + log_ + " --out ",
        "report " + log_ + page + " --json ",
        "export " + log_ + " --channel POSE --tum "}) {
    ExpectRefused(command + log_ + " -f", "is an input too");
    ExpectRefused(command + link + " -f", "is an input too");
    if (command.find(mine) != std::string::npos) continue;
    ExpectRefused(command + mine, "mine: exists already; --force replaces it");
    EXPECT_EQ(ReadBytes(mine).size(), 2U);
    EXPECT_EQ(RunTool(command + mine + " -f").exit_code, 0) << command;
    EXPECT_GT(ReadBytes(mine).size(), 2U);
    WriteBytes(mine, std::vector<std::uint8_t>{1, 2});
    std::filesystem::remove(directory_ / "page.html");
  }
  const std::string csv = "export " + log_ + " --csv " + (directory_ / "csv");
  EXPECT_EQ(RunTool(csv).exit_code, 0);
  ExpectRefused(csv, "exists already; --force replaces it");
  EXPECT_EQ(RunTool(csv + " -f").exit_code, 0);
  EXPECT_EQ(ReadBytes(log_), log);
}

TEST_F(LogToolProgramTest, NumbersThatAreNoneAreRefused) {
  WriteDrive();
  for (const std::string flag :
       {"--max-gap-s ", "--rpe-m ", "--rpe-s ", "--parameters 1 1 "}) {
    for (const std::string value : {"nan", "inf", "0", "x"}) {
      ExpectRefused("evaluate " + log_ + " " + flag + value,
                    "'" + value + "' is not a number in [1e-06, 1e+09]");
    }
  }
  for (const std::string flag : {"--noise-m ",
                                 "--noise-rad ",
                                 "--reference-delay ",
                                 "--mounting 0 0 "}) {
    ExpectRefused("import " + log_ + " " + out_ + " " + flag + "nan",
                  "'nan' is not a number in [");
  }
}

}  // namespace
}  // namespace waymark
