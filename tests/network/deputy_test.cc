// The deputy with real processes, over real LCM: a raw peer of the wire sends
// it orders as a stock sheriff does.
#include "processes/support/decode.h"
#include "processes/support/lcm_url.h"
#include "tests/network/network_test.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace waymark {
namespace {

using Steady = std::chrono::steady_clock;
using testing::HasSubstr;

std::int64_t WallUtime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// As a stock sheriff, but for orders that it sends only when told to.
class Sheriff {
 public:
  Sheriff() : lcm_(WithGrantedBuffer(LcmUrl(""))) {
    lcm_.subscribe("PM_INFO", &Sheriff::OnInfo, this);
    lcm_.subscribe("PM_OUTPUT", &Sheriff::OnOutput, this);
  }

  void Want(const std::string& id,
            const std::string& exec,
            std::int32_t runid,
            bool force_quit = false) {
    procman_lcm::cmd_desired_t& desired = wanted_[id];
    desired.cmd.command_id = id;
    desired.cmd.exec_str = exec;
    desired.cmd.stop_signal = SIGTERM;
    desired.cmd.stop_time_allowed = 0.5f;
    desired.cmd.auto_respawn = respawns ? 1 : 0;
    desired.desired_runid = runid;
    desired.force_quit = force_quit ? 1 : 0;
  }
  void Forget(const std::string& id) { wanted_.erase(id); }

  void Send(std::int64_t age_us = 0) {
    procman_lcm::orders_t orders;
    orders.utime = WallUtime() - age_us;
    orders.deputy_id = "robot";
    orders.sheriff_id = "test";
    for (const auto& [id, desired] : wanted_) orders.cmds.push_back(desired);
    orders.ncmds = static_cast<std::int32_t>(orders.cmds.size());
    lcm_.publish("PM_ORDERS", &orders);
  }
  void Discover() {
    procman_lcm::discovery_t discovery;
    discovery.utime = WallUtime();
    discovery.transmitter_id = "test";
    discovery.nonce = 0;
    lcm_.publish("PM_DISCOVER", &discovery);
  }

  // Listens until then.
  [[nodiscard]] bool Until(const std::function<bool()>& done,
                           double seconds = 10.0) {
    const auto end = Steady::now() + std::chrono::duration<double>(seconds);
    while (!done()) {
      if (Steady::now() > end) return false;
      lcm_.handleTimeout(20);
    }
    return true;
  }
  [[nodiscard]] bool UntilInfo() {
    const auto before = num_infos;
    return Until([&] { return num_infos > before; }, 20.0);
  }
  [[nodiscard]] const procman_lcm::cmd_status_t* Find(
      const std::string& id) const {
    for (const auto& status : info.cmds) {
      if (status.cmd.command_id == id) return &status;
    }
    return nullptr;
  }
  [[nodiscard]] std::int32_t Pid(const std::string& id) const {
    const auto* status = Find(id);
    return status == nullptr ? 0 : status->pid;
  }
  // Orders, until it runs with this run id.
  [[nodiscard]] bool Runs(const std::string& id, std::int32_t runid) {
    Send();
    return Until(
        [&] { return Pid(id) != 0 && Find(id)->actual_runid == runid; });
  }
  [[nodiscard]] bool Ends(const std::string& id, double seconds = 10.0) {
    return Until([&] { return Find(id) != nullptr && Pid(id) == 0; }, seconds);
  }

  bool respawns = false;
  procman_lcm::deputy_info_t info;
  std::int64_t num_infos = 0;
  std::map<std::string, std::string> output;
  std::int64_t num_output_bytes = 0;

 private:
  void OnInfo(const lcm::ReceiveBuffer* buffer, const std::string&) {
    const auto message = DecodeMessage<procman_lcm::deputy_info_t>(
        {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
    if (!message) return;
    info = *message;
    ++num_infos;
  }
  void OnOutput(const lcm::ReceiveBuffer* buffer, const std::string&) {
    num_output_bytes += buffer->data_size;
    const auto message = DecodeMessage<procman_lcm::output_t>(
        {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
    if (!message) return;
    for (std::size_t i = 0; i < message->text.size(); ++i) {
      output[message->command_ids[i]] += message->text[i];
    }
  }

  lcm::LCM lcm_;
  std::map<std::string, procman_lcm::cmd_desired_t> wanted_;
};

bool IsThere(std::int32_t pid) {
  // A zombie of somebody else is no longer there.
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  const auto at = text.rfind(')');
  return at != std::string::npos && at + 2 < text.size() && text[at + 2] != 'Z';
}

class DeputyTest : public NetworkTest {
 protected:
  void SetUp() override {
    NetworkTest::SetUp();
    if (IsSkipped()) return;
    sheriff_ = std::make_unique<Sheriff>();
  }

  void StartDeputy(std::vector<std::string> arguments) {
    arguments.insert(
        arguments.begin(),
        {BuildPath("bin/waymark-deputy"), "--id", "robot", "--allow-root"});
    deputy_ = std::make_unique<ChildProcess>(arguments);
    ASSERT_TRUE(sheriff_->UntilInfo()) << deputy_->ErrSoFar();
  }
  // Number that a command has printed.
  std::int32_t Printed(const std::string& id) {
    std::int32_t number = 0;
    EXPECT_TRUE(sheriff_->Until([&] {
      number = std::atoi(sheriff_->output[id].c_str());
      return number != 0 && sheriff_->output[id].back() == '\n';
    }));
    return number;
  }

  std::unique_ptr<Sheriff> sheriff_;
  std::unique_ptr<ChildProcess> deputy_;
};

TEST_F(DeputyTest, StartsRestartsAndStops) {
  StartDeputy({"--trust-network"});
  Sheriff& s = *sheriff_;
  EXPECT_EQ(s.info.deputy_id, "robot");
  EXPECT_GT(s.info.phys_mem_total_bytes, 0);
  EXPECT_EQ(s.info.ncmds, 0);
  s.Want("a",
         "GREETING='good day' bash -c 'tty -s && echo $GREETING; sleep 99'",
         1);
  ASSERT_TRUE(s.Runs("a", 1));
  EXPECT_TRUE(s.Until([&] { return s.output["a"] == "good day\n"; }))
      << s.output["a"];
  const std::int32_t first = s.Pid("a");
  s.Want("a", s.Find("a")->cmd.exec_str, 2);
  ASSERT_TRUE(s.Runs("a", 2));
  EXPECT_NE(s.Pid("a"), first);
  EXPECT_FALSE(IsThere(first));
  s.Want("a", s.Find("a")->cmd.exec_str, 2, true);
  s.Send();
  ASSERT_TRUE(s.Ends("a"));
  EXPECT_EQ(s.Find("a")->exit_code, SIGTERM);
  EXPECT_TRUE(s.Until(
      [&] { return s.output["a"].find("Terminated") != std::string::npos; }));
  // The status is as wait() gives it.
  s.Want("b", "bash -c 'exit 3'", 1);
  s.Send();
  ASSERT_TRUE(s.Ends("b"));
  EXPECT_EQ(s.Find("b")->exit_code, 3 << 8);
  s.Want("c", "/no/such/program", 1);
  s.Send();
  ASSERT_TRUE(s.Ends("c"));
  EXPECT_EQ(s.Find("c")->exit_code, 255 << 8);
  EXPECT_TRUE(s.Until([&] {
    return s.output["c"].find("/no/such/program: cannot be run") == 0;
  })) << s.output["c"];
}

// It passes over SIGTERM, and has a child in its session and one that left it.
TEST_F(DeputyTest, EndsDeafFamiliesWithoutFurtherOrders) {
  StartDeputy({"--trust-network"});
  Sheriff& s = *sheriff_;
  s.Want("deaf",
         "bash -c 'trap \"\" TERM; sleep 1000 & echo $!; "
         "setsid sleep 1001 & echo $! >/proc/self/fd/2; while :; do sleep 1; "
         "done'",
         1);
  ASSERT_TRUE(s.Runs("deaf", 1));
  ASSERT_TRUE(s.Until([&] {
    return std::count(s.output["deaf"].begin(), s.output["deaf"].end(), '\n') ==
           2;
  }));
  const std::int32_t leader = s.Pid("deaf");
  int inner = 0;
  int outer = 0;
  ASSERT_EQ(std::sscanf(s.output["deaf"].c_str(), "%d %d", &inner, &outer), 2);
  EXPECT_TRUE(IsThere(inner));
  EXPECT_TRUE(IsThere(outer));
  s.Want("deaf", s.Find("deaf")->cmd.exec_str, 1, true);
  s.Send();
  // Once: the deputy's own timer does the rest.
  ASSERT_TRUE(s.Ends("deaf", 5.0));
  EXPECT_EQ(s.Find("deaf")->exit_code, SIGKILL);
  EXPECT_FALSE(IsThere(leader));
  EXPECT_FALSE(IsThere(inner));
  EXPECT_FALSE(IsThere(outer));
}

// It goes into the background, as daemons do, and its command ends.
TEST_F(DeputyTest, WhatACommandLeavesBehindEndsWithIt) {
  const TemporaryDirectory folder;
  const std::string script = folder / "daemon.sh";
  std::ofstream(script) << "setsid bash -c 'sleep 1003 & echo $!'\nsleep 0.3\n";
  StartDeputy({"--trust-network"});
  Sheriff& s = *sheriff_;
  s.Want("a", "bash " + script, 1);
  s.Send();
  const std::int32_t left = Printed("a");
  EXPECT_TRUE(IsThere(left));
  ASSERT_TRUE(s.Ends("a"));
  EXPECT_EQ(s.Find("a")->exit_code, 0);
  EXPECT_TRUE(s.Until([&] { return !IsThere(left); }, 2.0));
}

TEST_F(DeputyTest, EmptyOrdersEndAllAndOldOnesNothing) {
  StartDeputy({"--trust-network"});
  Sheriff& s = *sheriff_;
  s.Want("a", "sleep 99", 1);
  ASSERT_TRUE(s.Runs("a", 1));
  s.Forget("a");
  s.Send(61'000'000);
  ASSERT_TRUE(s.UntilInfo());
  ASSERT_TRUE(s.UntilInfo());
  EXPECT_NE(s.Pid("a"), 0);
  s.Send();
  EXPECT_TRUE(s.Until([&] { return s.info.ncmds == 0; }));
}

TEST_F(DeputyTest, RespawnsUntilItIsStopped) {
  StartDeputy({"--trust-network"});
  Sheriff& s = *sheriff_;
  s.respawns = true;
  s.Want("a", "sleep 99", 1);
  ASSERT_TRUE(s.Runs("a", 1));
  const std::int32_t first = s.Pid("a");
  kill(first, SIGKILL);
  ASSERT_TRUE(
      s.Until([&] { return s.Pid("a") != 0 && s.Pid("a") != first; }, 3.0));
  EXPECT_EQ(s.Find("a")->actual_runid, 1);
  s.Want("a", "sleep 99", 1, true);
  s.Send();
  ASSERT_TRUE(s.Ends("a"));
  ASSERT_TRUE(s.UntilInfo());
  ASSERT_TRUE(s.UntilInfo());
  EXPECT_EQ(s.Pid("a"), 0);
}

TEST_F(DeputyTest, RunsOnlyWhatItsFileLists) {
  const TemporaryDirectory folder;
  const std::string file = folder / "robot.pmd";
  std::ofstream(file)
      << "cmd \"a\" { exec = \"sleep 99\"; deputy = \"robot\"; "
         "nice = 5; working_dir = \"/usr\"; }\n"
         "cmd \"b\" { exec = \"sleep 98\"; deputy = \"eye\"; }\n";
  StartDeputy({file});
  Sheriff& s = *sheriff_;
  s.Want("a", "sleep 99", 1);
  s.Want("b", "sleep 98", 1);
  s.Want("c", "touch " + (folder / "broken"), 1);
  ASSERT_TRUE(s.Runs("a", 1));
  ASSERT_TRUE(s.Until([&] { return s.Find("c") != nullptr; }));
  for (const char* id : {"b", "c"}) {
    EXPECT_EQ(s.Pid(id), 0) << id;
    EXPECT_EQ(s.Find(id)->exit_code, 126 << 8) << id;
    EXPECT_TRUE(s.Until(
        [&] { return s.output[id].find("refused: ") != std::string::npos; }));
  }
  std::error_code error;
  EXPECT_EQ(std::filesystem::read_symlink(
                "/proc/" + std::to_string(s.Pid("a")) + "/cwd", error),
            "/usr");
  EXPECT_FALSE(std::filesystem::exists(folder / "broken"));
  s.Want("a", "rm " + file, 2);
  s.Send();
  EXPECT_TRUE(s.Until(
      [&] { return s.output["a"].find("another exec") != std::string::npos; }));
  EXPECT_EQ(s.Find("a")->actual_runid, 1);
  EXPECT_NE(s.Pid("a"), 0);
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST_F(DeputyTest, OfTwoWithOneIdTheSecondGivesUp) {
  StartDeputy({"--trust-network"});
  const ChildResult second = RunChild({BuildPath("bin/waymark-deputy"),
                                       "--id",
                                       "robot",
                                       "--allow-root",
                                       "--trust-network"});
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.err, HasSubstr("another deputy \"robot\""));
  EXPECT_TRUE(sheriff_->UntilInfo());
}

TEST_F(DeputyTest, ASignalEndsItWithAllItsChildren) {
  StartDeputy({"--trust-network"});
  Sheriff& s = *sheriff_;
  s.Want("a", "sleep 99", 1);
  s.Want("deaf", "bash -c 'trap \"\" TERM; while :; do sleep 1; done'", 1);
  ASSERT_TRUE(s.Runs("a", 1));
  ASSERT_TRUE(s.Until([&] { return s.Pid("deaf") != 0; }));
  const std::int32_t a = s.Pid("a");
  const std::int32_t deaf = s.Pid("deaf");
  deputy_->Signal(SIGTERM);
  EXPECT_EQ(deputy_->Wait().exit_code, 0);
  EXPECT_FALSE(IsThere(a));
  EXPECT_FALSE(IsThere(deaf));
}

// 29 commands, among them two that print without end, deaf ones, and one that
// closes its terminal.
TEST_F(DeputyTest, ChaosLeavesItAnswering) {
  const TemporaryDirectory folder;
  const std::string file = folder / "robot.pmd";
  std::vector<std::pair<std::string, std::string>> commands{
      {"flood", "yes a line of output that goes on and on and on"},
      {"closed", "bash -c 'exec <&- >&- 2>&-; sleep 1000'"},
      {"binary", "cat /dev/urandom"}};
  for (int i = 0; i < 26; ++i) {
    commands.emplace_back("deaf" + std::to_string(i),
                          "bash -c 'trap \"\" TERM INT; while :; do sleep 1; "
                          "done'");
  }
  {
    std::ofstream out(file);
    for (const auto& [id, exec] : commands) {
      std::string quoted;
      for (const char c : exec) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += c;
      }
      out << "cmd \"" << id << "\" { exec = \"" << quoted
          << "\"; deputy = \"robot\"; }\n";
    }
  }
  StartDeputy({file});
  Sheriff& s = *sheriff_;
  for (const auto& [id, exec] : commands) {
    s.Want(id, exec, 1);
  }
  s.Send();
  ASSERT_TRUE(
      s.Until([&] { return s.info.ncmds == 29 && s.Pid("deaf25") != 0; }));
  double worst_s = 0.0;
  for (int i = 0; i < 10; ++i) {
    (void)s.Until([] { return false; }, 0.1);
    const auto before = s.num_infos;
    const auto asked = Steady::now();
    s.Discover();
    ASSERT_TRUE(s.Until([&] { return s.num_infos > before; }));
    worst_s = std::max(
        worst_s, std::chrono::duration<double>(Steady::now() - asked).count());
  }
  EXPECT_LT(worst_s, 1.5);
  EXPECT_THAT(s.output["flood"], HasSubstr("bytes of output left out here]"));
  // Every stop wins.
  for (const auto& [id, exec] : commands) {
    s.Want(id, exec, 1, true);
  }
  s.Send();
  EXPECT_TRUE(s.Until([&] {
    for (const auto& status : s.info.cmds) {
      if (status.pid != 0) return false;
    }
    return true;
  }));
}

}  // namespace
}  // namespace waymark
