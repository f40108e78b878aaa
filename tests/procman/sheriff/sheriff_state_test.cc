#include "procman/sheriff/sheriff_state.h"

#include "estimation/base/random.h"
#include "procman/deployment/deployment_parser.h"
#include "procman/deputy/deputy_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::IsEmpty;

constexpr char kFile[] = R"(
cmd "a" { exec = "a --run"; deputy = "robot"; stop_time_allowed = 2; }
cmd "b" { exec = "b --run"; deputy = "eye"; }
)";

CommandReport Reported(const std::string& id,
                       std::int32_t pid,
                       std::int32_t runid,
                       std::int32_t exit_code = 0) {
  CommandReport report;
  report.spec.id = id;
  report.spec.exec = id + " --run";
  report.pid = pid;
  report.actual_runid = runid;
  report.exit_code = exit_code;
  return report;
}

class SheriffStateTest : public testing::Test {
 protected:
  bool Report(const std::string& deputy,
              std::vector<CommandReport> commands,
              Duration age = {}) {
    DeputyReport report;
    report.utime = wall_ - age;
    report.deputy_id = deputy;
    report.commands = std::move(commands);
    now_ += seconds(1);
    return state_.OnReport(report, wall_, now_);
  }
  [[nodiscard]] CommandStatus Status(const std::string& id) const {
    return state_.commands().at(id).status();
  }
  // The one order for one command of a deputy.
  [[nodiscard]] CommandOrder OrderOf(const std::string& deputy) const {
    for (const DeputyOrders& orders : state_.Orders(wall_)) {
      if (orders.deputy_id == deputy && orders.commands.size() == 1) {
        return orders.commands[0];
      }
    }
    ADD_FAILURE() << deputy;
    return {};
  }

  SheriffState state_{"me"};
  Time wall_ = TimeFromMicroseconds(1'700'000'000'000'000);
  Duration now_ = seconds(10);
};

TEST_F(SheriffStateTest, OrdersGoOnlyToDeputiesThatWereHeard) {
  state_.Load(ParseDeployment(kFile, "f"));
  EXPECT_THAT(state_.Orders(wall_), IsEmpty());
  EXPECT_EQ(Status("a"), CommandStatus::kUnknown);
  Report("robot", {});
  ASSERT_EQ(state_.Orders(wall_).size(), 1u);
  const CommandOrder order = OrderOf("robot");
  EXPECT_EQ(order.spec.exec, "a --run");
  EXPECT_EQ(order.spec.stop_time_allowed_s, 2.0);
  EXPECT_EQ(order.desired_runid, 0);
  EXPECT_TRUE(order.force_quit);
  EXPECT_EQ(Status("a"), CommandStatus::kStopped);
}

TEST_F(SheriffStateTest, StartStopAndRestartAreRunIds) {
  state_.Load(ParseDeployment(kFile, "f"));
  Report("robot", {});
  state_.Start("a");
  EXPECT_EQ(OrderOf("robot").desired_runid, 1);
  EXPECT_FALSE(OrderOf("robot").force_quit);
  EXPECT_EQ(Status("a"), CommandStatus::kStarting);
  EXPECT_TRUE(Report("robot", {Reported("a", 7, 1)}));
  EXPECT_EQ(Status("a"), CommandStatus::kRunning);
  // It runs: nothing to do.
  state_.Start("a");
  EXPECT_EQ(OrderOf("robot").desired_runid, 1);
  EXPECT_FALSE(Report("robot", {Reported("a", 7, 1)}));
  state_.Restart("a");
  EXPECT_EQ(OrderOf("robot").desired_runid, 2);
  EXPECT_EQ(Status("a"), CommandStatus::kRestarting);
  Report("robot", {Reported("a", 8, 2)});
  state_.Stop("a");
  EXPECT_EQ(OrderOf("robot").desired_runid, 2);
  EXPECT_TRUE(OrderOf("robot").force_quit);
  EXPECT_EQ(Status("a"), CommandStatus::kStopping);
  Report("robot", {Reported("a", 0, 2, SIGTERM)});
  EXPECT_EQ(Status("a"), CommandStatus::kStopped);
  state_.Start("a");
  EXPECT_EQ(OrderOf("robot").desired_runid, 3);
}

TEST_F(SheriffStateTest, WhatDeputiesRunIsAdoptedAndGoesOn) {
  Report("robot", {Reported("a", 7, 5), Reported("x", 8, 3)});
  EXPECT_EQ(Status("a"), CommandStatus::kRunning);
  EXPECT_EQ(state_.commands().at("x").command.deputy, "robot");
  const std::vector<DeputyOrders> all = state_.Orders(wall_);
  for (const CommandOrder& order : all[0].commands) {
    EXPECT_FALSE(order.force_quit);
    EXPECT_EQ(order.desired_runid, order.spec.id == "a" ? 5 : 3);
  }
  // A file that is loaded afterwards, or before, starts and stops nothing.
  state_.Load(ParseDeployment(kFile, "f"));
  EXPECT_EQ(state_.commands().at("a").desired_runid, 5);
  EXPECT_FALSE(state_.commands().at("a").force_quit);
  SheriffState other("other");
  other.Load(ParseDeployment(kFile, "f"));
  DeputyReport report;
  report.utime = wall_;
  report.deputy_id = "robot";
  report.commands = {Reported("a", 7, 5)};
  other.OnReport(report, wall_, now_);
  EXPECT_EQ(other.commands().at("a").status(), CommandStatus::kRunning);
  EXPECT_EQ(other.commands().at("a").desired_runid, 5);
}

TEST_F(SheriffStateTest, WhatHasEndedByItselfStaysEnded) {
  state_.Load(ParseDeployment(kFile, "f"));
  Report("robot", {});
  state_.Start("a");
  Report("robot", {Reported("a", 7, 1)});
  Report("robot", {Reported("a", 0, 1, 3 << 8)});
  EXPECT_EQ(Status("a"), CommandStatus::kFailed);
  EXPECT_TRUE(OrderOf("robot").force_quit);
  // A deputy that was started anew knows nothing of it.
  Report("robot", {});
  EXPECT_TRUE(OrderOf("robot").force_quit);
}

TEST_F(SheriffStateTest, WhatRunsIsStartedAgainByANewDeputy) {
  state_.Load(ParseDeployment(kFile, "f"));
  Report("robot", {});
  state_.Start("a");
  Report("robot", {Reported("a", 7, 1)});
  Report("robot", {});
  EXPECT_FALSE(OrderOf("robot").force_quit);
  EXPECT_EQ(OrderOf("robot").desired_runid, 1);
  EXPECT_EQ(Status("a"), CommandStatus::kStarting);
}

TEST_F(SheriffStateTest, RemovedIsLeftOutUntilItIsGone) {
  Report("robot", {Reported("a", 7, 5)});
  state_.Remove("a");
  EXPECT_THAT(state_.Orders(wall_)[0].commands, IsEmpty());
  EXPECT_EQ(Status("a"), CommandStatus::kStopping);
  Report("robot", {Reported("a", 0, 5, SIGINT)});
  EXPECT_EQ(Status("a"), CommandStatus::kRemoving);
  Report("robot", {});
  EXPECT_EQ(state_.commands().count("a"), 0u);
}

TEST_F(SheriffStateTest, BesideAnotherSheriffItOnlyLooks) {
  Report("robot", {Reported("a", 7, 5)});
  DeputyOrders orders;
  orders.deputy_id = "robot";
  orders.sheriff_id = "me";
  EXPECT_FALSE(state_.OnOrders(orders));
  orders.sheriff_id = "you";
  CommandOrder order;
  order.spec.id = "a";
  order.desired_runid = 6;
  orders.commands = {order};
  EXPECT_TRUE(state_.OnOrders(orders));
  EXPECT_FALSE(state_.OnOrders(orders));
  EXPECT_TRUE(state_.is_observer());
  EXPECT_EQ(state_.other_sheriff(), "you");
  EXPECT_THAT(state_.Orders(wall_), IsEmpty());
  EXPECT_THROW(state_.Stop("a"), std::logic_error);
  EXPECT_EQ(Status("a"), CommandStatus::kRestarting);
}

TEST_F(SheriffStateTest, OldReportsSayNothingButToAnObserver) {
  Report("robot", {Reported("a", 7, 5)}, seconds(31));
  EXPECT_THAT(state_.deputies(), IsEmpty());
  state_ = SheriffState("me", true);
  Report("robot", {Reported("a", 7, 5)}, seconds(86400 * 400));
  EXPECT_EQ(Status("a"), CommandStatus::kRunning);
}

TEST_F(SheriffStateTest, TheClockOffsetIsThatOfTheFastestMessage) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    // 40 ms behind, and up to 20 ms on the way.
    Report("robot", {}, milliseconds(40) + Duration(random.Index(20'000)));
  }
  const Duration offset = state_.deputies().at("robot").clock_offset;
  EXPECT_LE(offset, -milliseconds(40));
  EXPECT_GE(offset, -milliseconds(43));
}

TEST_F(SheriffStateTest, NamesWhatThereIsNot) {
  EXPECT_THROW(state_.Start("a"), std::invalid_argument);
  Report("eye", {Reported("a", 7, 5)});
  EXPECT_THROW(state_.Load(ParseDeployment(kFile, "f")), std::invalid_argument);
}

// Both state machines against each other, over a network that loses half of
// all messages: what the sheriff wants comes about.
TEST(SheriffAndDeputy, AgreeOverALossyNetwork) {
  Random random(11);
  SheriffState sheriff("me");
  DeputyState deputy({"robot", {}, {}});
  sheriff.Load(ParseDeployment(kFile, "f"));
  Time wall = TimeFromMicroseconds(1'700'000'000'000'000);
  Duration now = seconds(1);
  std::int32_t pid = 100;
  const auto act = [&](const DeputyState::Actions& actions,
                       auto& self) -> void {
    for (const DeputyAction& action : actions) {
      if (const auto* start = std::get_if<StartChild>(&action)) {
        self(deputy.OnStarted(start->id, ++pid, now), self);
      } else if (const auto* signal = std::get_if<SignalFamily>(&action)) {
        self(deputy.OnExit(signal->pid, signal->signal, now), self);
      }
    }
  };
  for (int round = 0; round < 300; ++round) {
    const bool wants = random.Index(2) == 0;
    bool is_asked = false;
    bool is_there = false;
    for (int step = 0; step < 60 && !is_there; ++step) {
      now += milliseconds(500);
      wall += milliseconds(500);
      if (random.Index(2) == 0) {
        DeputyReport report;
        report.utime = wall;
        report.deputy_id = "robot";
        for (const auto& [id, command] : deputy.commands()) {
          report.commands.push_back({command.spec,
                                     command.pid,
                                     command.actual_runid,
                                     command.exit_code});
        }
        sheriff.OnReport(report, wall, now);
      }
      if (!is_asked) {
        if (wants) {
          sheriff.Restart("a");
        } else {
          sheriff.Stop("a");
        }
        is_asked = true;
      }
      for (const DeputyOrders& orders : sheriff.Orders(wall)) {
        if (random.Index(2) == 0) act(deputy.OnOrders(orders, wall, now), act);
      }
      const CommandStatus status = sheriff.commands().at("a").status();
      is_there = wants ? status == CommandStatus::kRunning
                       : status == CommandStatus::kStopped;
    }
    ASSERT_TRUE(is_there) << round;
    ASSERT_EQ(deputy.commands().at("a").pid != 0, wants);
  }
}

}  // namespace
}  // namespace waymark
