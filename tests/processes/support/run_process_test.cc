#include "processes/support/run_process.h"

#include "processes/support/channels.h"
#include "processes/support/log_file.h"
#include "tests/support/child_process.h"

#include <waymark/encoders_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

ChildResult Echo(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), BuildPath("tests/echo_for_tests"));
  return RunChild(arguments);
}

// The one line on stderr of a run that must exit with 2.
std::string Refusal(const std::vector<std::string>& arguments) {
  const ChildResult result = Echo(arguments);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1)
      << result.err;
  return result.err;
}

// For a minute at most: the machine may be busy.
void WaitFor(const std::function<bool()>& condition) {
  for (int i = 0; i < 6000 && !condition(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_TRUE(condition());
}

class RunProcessTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "run_process_test/";
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    LogWriter writer(folder_ + "in.lcm");
    for (int i = 0; i < 100; ++i) {
      encoders_t message;
      message.utime = 1'700'000'000'000'000 + 50'000 * i;
      message.seq = i;
      message.left_ticks = 1;
      writer.Write(kEncoders, message);
    }
    writer.Close();
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string folder_;
};

TEST_F(RunProcessTest, HelpVersionAndReference) {
  const ChildResult help = Echo({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* flag : {"--config",
                           "--set",
                           "--lcm-url",
                           "--log-in",
                           "--log-out",
                           "--check-config",
                           "--print-config"}) {
    EXPECT_THAT(help.out, HasSubstr(flag));
  }
  EXPECT_EQ(Echo({"--version"}).exit_code, 0);
  EXPECT_THAT(Echo({"--describe-config"}).out, HasSubstr("| `scale` | `1` |"));
}

TEST_F(RunProcessTest, PrintedConfigurationLoadsBack) {
  const ChildResult printed =
      Echo({"--print-config", "--set", "scale=0.1", "--set", "sleep_us=7"});
  EXPECT_EQ(printed.exit_code, 0);
  EXPECT_THAT(printed.out, HasSubstr("scale: 0.1\n"));
  std::ofstream(folder_ + "echo.yaml") << printed.out;
  EXPECT_EQ(Echo({"--print-config", "--config", folder_ + "echo.yaml"}).out,
            printed.out);
  EXPECT_EQ(
      Echo({"--check-config", "--config", folder_ + "echo.yaml"}).exit_code, 0);
}

TEST_F(RunProcessTest, BadInputIsOneLineAndExitCodeTwo) {
  const std::string yaml = folder_ + "bad.yaml";
  std::ofstream(yaml) << "scale: 1\nspeed: 2\n";
  EXPECT_EQ(Refusal({"--check-config", "--config", yaml}),
            "echo: " + yaml +
                ":2: speed: unknown key; known here: scale, throw_at, "
                "sleep_us, finish_pose\n");
  EXPECT_EQ(Refusal({"--config", folder_ + "none.yaml"}),
            "echo: " + folder_ +
                "none.yaml: cannot be opened: No such file or directory\n");
  EXPECT_EQ(Refusal({"--set", "scale=fast"}),
            "echo: --set scale=fast: scale = fast: must be a number in [0, "
            "10]\n");
  EXPECT_EQ(Refusal({"--set", "scale=3"}),
            "echo: configuration with --set: scale = 3: is taken\n");
  EXPECT_THAT(Refusal({"--bogus"}), HasSubstr("--bogus"));
  EXPECT_THAT(Refusal({"--set"}), HasSubstr("--set"));
  EXPECT_EQ(Refusal({"--log-out", folder_ + "out.lcm"}),
            "echo: --log-out requires --log-in\n");
  EXPECT_EQ(Refusal({"--log-in", folder_ + "in.lcm", "--lcm-url", "memq://"}),
            "echo: --lcm-url excludes --log-in\n");
  EXPECT_THAT(Refusal({"--log-in", folder_ + "none.lcm"}),
              StartsWith("echo: " + folder_ + "none.lcm: "));
  EXPECT_THAT(Refusal({"--log-in",
                       folder_ + "in.lcm",
                       "--log-out",
                       folder_ + "in.lcm",
                       "--force"}),
              HasSubstr("in.lcm: is an input too"));
  EXPECT_THAT(Refusal({"--lcm-url", "udpm:/x"}), HasSubstr("LCM URL udpm:/x"));
  EXPECT_THAT(Refusal({"--lcm-url", "tcpq://127.0.0.1:1"}),
              HasSubstr("no broker answers"));
}

TEST_F(RunProcessTest, OfflineTwiceIsByteEqualAndAnOutputIsNotReplaced) {
  const std::string in = folder_ + "in.lcm";
  const std::string out = folder_ + "out.lcm";
  EXPECT_EQ(Echo({"--log-in", in, "--log-out", out}).exit_code, 0);
  const auto bytes = [](const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  const std::string first = bytes(out);
  EXPECT_THAT(Refusal({"--log-in", in, "--log-out", out}), HasSubstr(out));
  EXPECT_EQ(bytes(out), first);
  EXPECT_EQ(Echo({"--log-in", in, "--log-out", out, "--force"}).exit_code, 0);
  EXPECT_EQ(bytes(out), first);
}

TEST_F(RunProcessTest, FullDiskIsOneLine) {
  const std::string error = Refusal(
      {"--log-in", folder_ + "in.lcm", "--log-out", "/dev/full", "--force"});
  EXPECT_THAT(error, HasSubstr("/dev/full"));
}

TEST_F(RunProcessTest, HandlerThatThrowsIsExitCodeOne) {
  const ChildResult result =
      Echo({"--log-in", folder_ + "in.lcm", "--set", "throw_at=3"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err,
            "echo: " + folder_ +
                "in.lcm: event 3 (ENCODERS): handler threw as configured\n");
}

TEST_F(RunProcessTest, DamagedLogIsSaidAndReadOn) {
  std::ofstream file(folder_ + "in.lcm", std::ios::binary | std::ios::app);
  file << "torn";
  file.close();
  const ChildResult result = Echo({"--log-in", folder_ + "in.lcm"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err,
              HasSubstr("4 bytes in 1 place are no log records, skipped"));
}

TEST_F(RunProcessTest, SignalsEndALiveProcess) {
  for (const int signal : {SIGTERM, SIGINT}) {
    ChildProcess echo(
        {BuildPath("tests/echo_for_tests"), "--lcm-url", "memq://"});
    // An earlier signal would kill it (128 + signal).
    WaitFor(
        [&] { return echo.ErrSoFar().find("live on") != std::string::npos; });
    echo.Signal(signal);
    const ChildResult result = echo.Wait();
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.err,
                HasSubstr(" info: live on memq://: receives ENCODERS, "
                          "ODOMETRY_PARAMETERS; sends ODOMETRY, "
                          "ODOMETRY_PARAMETERS, POSE\n"));
  }
}

TEST_F(RunProcessTest, SignalEndsAnOfflineRunWithWhatIsDone) {
  const std::string out = folder_ + "out.lcm";
  ChildProcess echo({BuildPath("tests/echo_for_tests"),
                     "--log-in",
                     folder_ + "in.lcm",
                     "--log-out",
                     out,
                     "--set",
                     "sleep_us=20000"});
  WaitFor([&] { return std::filesystem::exists(out); });
  echo.Signal(SIGTERM);
  const ChildResult result = echo.Wait();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("interrupted after "));
  LogReader reader(out);
  LogEvent last;
  while (auto event = reader.Next()) last = *event;
  EXPECT_EQ(last.channel, kStatus);
  EXPECT_TRUE(reader.report().is_sound());
}

}  // namespace
}  // namespace waymark
