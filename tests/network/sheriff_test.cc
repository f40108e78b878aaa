// The sheriff's command line with a deputy and real processes.
#include "tests/network/network_test.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr char kFile[] = R"(
group "base" {
  cmd "clock" { exec = "bash -c 'while :; do echo tick; sleep 0.2; done'";
                deputy = "robot"; auto_respawn = "true";
                # A shell goes on after SIGINT if its child has not seen it.
                stop_signal = 15; }
  cmd "broken" { exec = "bash -c 'exit 3'"; deputy = "robot"; }
}
cmd "late" { exec = "sleep 1000"; deputy = "robot"; depends_on = "clock"; }
cmd "never" { exec = "sleep 1001"; deputy = "robot"; ready_status = "nobody"; }
cmd "waits" { exec = "sleep 1002"; deputy = "robot"; depends_on = "never"; }
script "go" {
  start cmd "late" wait "running";
  wait ms 100;
  restart group "base" wait "running";
  stop everything wait "stopped" timeout 5000;
}
)";

class SheriffTest : public NetworkTest {
 protected:
  void SetUp() override {
    NetworkTest::SetUp();
    if (IsSkipped()) return;
    file_ = folder_ / "robot.pmd";
    std::ofstream(file_) << kFile;
    StartDeputy();
  }
  void TearDown() override {
    if (!deputy_) return;
    deputy_->Signal(SIGTERM);
    EXPECT_EQ(deputy_->Wait().exit_code, 0);
  }

  void StartDeputy() {
    deputy_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{BuildPath("bin/waymark-deputy"),
                                 file_,
                                 "--id",
                                 "robot",
                                 "--allow-root"});
    // It answers half a second after its start.
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
  }
  [[nodiscard]] ChildResult Call(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), BuildPath("bin/waymark-sheriff"));
    return RunChild(arguments);
  }
  [[nodiscard]] ChildResult CallWithFile(
      std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--deployment", file_});
    return Call(std::move(arguments));
  }
  [[nodiscard]] nlohmann::json Command(const std::string& id) const {
    const auto status = nlohmann::json::parse(Call({"status", "--json"}).out);
    for (const auto& command : status["commands"]) {
      if (command["id"] == id) return command;
    }
    return {};
  }

  TemporaryDirectory folder_;
  std::string file_;
  std::unique_ptr<ChildProcess> deputy_;
};

TEST_F(SheriffTest, StartsWithWhatItDependsOnAndStops) {
  const ChildResult start = CallWithFile({"start", "late"});
  EXPECT_EQ(start.exit_code, 0) << start.err;
  EXPECT_EQ(start.out, "start clock\nstart late\n");
  EXPECT_EQ(Command("late")["status"], "running");
  const int pid = Command("clock")["pid"];
  EXPECT_GT(pid, 0);
  // Another call knows what runs, and leaves it so; the file is not needed.
  EXPECT_EQ(Call({"start", "clock"}).out, "");
  EXPECT_EQ(Command("clock")["pid"], pid);
  EXPECT_EQ(Call({"restart", "clock"}).exit_code, 0);
  EXPECT_NE(Command("clock")["pid"], pid);
  EXPECT_EQ(Command("late")["status"], "running");
  const ChildResult output = Call({"output", "clock", "--for", "1"});
  EXPECT_THAT(output.out, HasSubstr("tick\ntick\n"));
  EXPECT_EQ(CallWithFile({"stop", "--all"}).exit_code, 0);
  for (const char* id : {"clock", "late"}) {
    EXPECT_EQ(Command(id)["status"], "stopped") << id;
  }
}

TEST_F(SheriffTest, ExitCodesSayWhatCameOfIt) {
  const ChildResult broken = CallWithFile({"start", "broken"});
  EXPECT_EQ(broken.exit_code, 1);
  EXPECT_EQ(broken.err, "waymark-sheriff: failed: broken (exit 3)\n");
  EXPECT_THAT(Call({"status"}).out, HasSubstr("failed"));
  const ChildResult unknown = CallWithFile({"start", "nobody"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("there is no command \"nobody\""));
  EXPECT_EQ(CallWithFile({"start"}).exit_code, 2);
  EXPECT_EQ(CallWithFile({"run", "gone"}).exit_code, 2);
  // What it depends on runs, but is never heard of.
  const ChildResult waits =
      CallWithFile({"start", "waits", "--timeout", "1.5"});
  EXPECT_EQ(waits.exit_code, 1);
  EXPECT_EQ(waits.err, "waymark-sheriff: not ready in time: never\n");
  EXPECT_EQ(Command("never")["status"], "running");
  EXPECT_EQ(Command("waits")["pid"], 0);
}

// Without orders of its own, so also beside another sheriff.
TEST_F(SheriffTest, WaitsForWhatComes) {
  EXPECT_EQ(CallWithFile({"start", "never"}).exit_code, 0);
  const ChildResult ready =
      CallWithFile({"wait", "never", "--status", "ready", "--timeout", "1"});
  EXPECT_EQ(ready.exit_code, 1);
  EXPECT_EQ(ready.err, "waymark-sheriff: not ready in time: never\n");
  ChildProcess stopped({BuildPath("bin/waymark-sheriff"),
                        "wait",
                        "never",
                        "--status",
                        "stopped",
                        "--timeout",
                        "20"});
  EXPECT_EQ(Call({"stop", "never"}).exit_code, 0);
  const ChildResult result = stopped.Wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(SheriffTest, RunsScripts) {
  const ChildResult run = CallWithFile({"run", "go"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              StartsWith("start clock\nstart late\nrestart clock\n"
                         "restart broken\nstop "));
  EXPECT_EQ(Command("late")["status"], "stopped");
  EXPECT_EQ(Command("clock")["status"], "stopped");
}

TEST_F(SheriffTest, BesideAnotherSheriffItGivesNoOrders) {
  EXPECT_EQ(CallWithFile({"start", "late"}).exit_code, 0);
  // One that waits for what never comes, and orders meanwhile.
  ChildProcess other({BuildPath("bin/waymark-sheriff"),
                      "start",
                      "waits",
                      "--deployment",
                      file_,
                      "--timeout",
                      "30"});
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  const ChildResult stop = Call({"stop", "late"});
  EXPECT_EQ(stop.exit_code, 1);
  EXPECT_THAT(stop.err, HasSubstr("another sheriff gives orders"));
  EXPECT_EQ(Command("late")["status"], "running");
  other.Signal(SIGKILL);
  (void)other.Wait();
  // Without a sheriff the deputy goes on; the next one takes over.
  EXPECT_EQ(Call({"stop", "late"}).exit_code, 0);
}

TEST_F(SheriffTest, SaysWhereNobodyAnswers) {
  deputy_->Signal(SIGTERM);
  EXPECT_EQ(deputy_->Wait().exit_code, 0);
  deputy_.reset();
  const ChildResult start = CallWithFile({"start", "late"});
  EXPECT_EQ(start.exit_code, 1);
  EXPECT_THAT(start.err, HasSubstr("no deputy answers"));
  EXPECT_THAT(Call({"status"}).out, HasSubstr("no deputies"));
}

}  // namespace
}  // namespace waymark
