#include "procman/deputy/deputy_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;

CommandOrder Order(const std::string& id, std::int32_t runid) {
  CommandOrder order;
  order.spec.id = id;
  order.spec.exec = id + " --run";
  order.desired_runid = runid;
  return order;
}

CommandOrder Off(CommandOrder order) {
  order.force_quit = true;
  return order;
}

CommandOrder Respawned(CommandOrder order) {
  order.spec.auto_respawn = true;
  return order;
}

// Starts what it is told to, with pids from 100 on, and writes down what else
// it is told.
class DeputyStateTest : public testing::Test {
 protected:
  void Use(DeputyStateOptions options) {
    options.deputy_id = "robot";
    state_ = DeputyState(std::move(options));
  }

  void Do(const DeputyState::Actions& actions) {
    for (const DeputyAction& action : actions) std::visit(*this, action);
  }
  void Orders(std::vector<CommandOrder> orders) {
    DeputyOrders message;
    message.utime = wall_;
    message.deputy_id = "robot";
    message.sheriff_id = "sheriff";
    message.commands = std::move(orders);
    Do(state_.OnOrders(message, wall_, now_));
  }
  void Exit(std::int32_t pid, std::int32_t status) {
    Do(state_.OnExit(pid, status, now_));
  }
  // Time passes, with all that becomes due.
  void Pass(Duration duration) {
    const Duration end = now_ + duration;
    while (state_.next_timer() && *state_.next_timer() <= end) {
      now_ = std::max(now_, *state_.next_timer());
      Do(state_.OnTimer(now_));
    }
    now_ = end;
  }
  [[nodiscard]] const CommandState& Command(const std::string& id) const {
    return state_.commands().at(id);
  }
  std::vector<std::string> TakeDone() { return std::exchange(done_, {}); }

 public:
  void operator()(const StartChild& action) {
    if (cannot_start_) {
      done_.push_back("fail " + action.id);
      Do(state_.OnStartFailed(action.id, "no such file", now_));
      return;
    }
    done_.push_back("start " + action.id);
    Do(state_.OnStarted(action.id, next_pid_++, now_));
  }
  void operator()(const SignalFamily& action) {
    done_.push_back("signal " + std::to_string(action.pid) + " " +
                    std::to_string(action.signal));
  }
  void operator()(const EndFamily& action) {
    done_.push_back("end " + std::to_string(action.pid));
  }
  void operator()(const SayText& action) {
    said_ += action.id + ": " + action.text;
  }
  void operator()(const PublishInfo&) { ++num_infos_; }

 protected:
  DeputyState state_{DeputyStateOptions{"robot", {}, {}}};
  Duration now_ = seconds(1000);
  Time wall_ = TimeFromMicroseconds(1'700'000'000'000'000);
  std::int32_t next_pid_ = 100;
  bool cannot_start_ = false;
  std::vector<std::string> done_;
  std::string said_;
  int num_infos_ = 0;
};

TEST_F(DeputyStateTest, StartsOnceForEachRunId) {
  Orders({Order("a", 1)});
  EXPECT_THAT(TakeDone(), ElementsAre("start a"));
  EXPECT_EQ(num_infos_, 1);
  EXPECT_EQ(Command("a").pid, 100);
  EXPECT_EQ(Command("a").actual_runid, 1);
  Orders({Order("a", 1)});
  EXPECT_THAT(TakeDone(), ElementsAre());
  EXPECT_EQ(num_infos_, 1);
  // It ends by itself and stays so.
  Exit(100, 3 << 8);
  EXPECT_THAT(TakeDone(), ElementsAre("end 100"));
  EXPECT_EQ(num_infos_, 2);
  EXPECT_EQ(Command("a").exit_code, 768);
  Orders({Order("a", 1)});
  Pass(seconds(10));
  EXPECT_THAT(TakeDone(), ElementsAre());
  Orders({Order("a", 2)});
  EXPECT_THAT(TakeDone(), ElementsAre("start a"));
  EXPECT_EQ(Command("a").exit_code, 0);
}

TEST_F(DeputyStateTest, ARestartStopsAndStartsByItself) {
  Orders({Order("a", 1)});
  Orders({Order("a", 2)});
  EXPECT_THAT(TakeDone(), ElementsAre("start a", "signal 100 2"));
  EXPECT_EQ(Command("a").actual_runid, 1);
  Orders({Order("a", 2)});
  EXPECT_THAT(TakeDone(), ElementsAre());
  Exit(100, SIGINT);
  EXPECT_THAT(TakeDone(), ElementsAre("end 100", "start a"));
  EXPECT_EQ(Command("a").actual_runid, 2);
  EXPECT_EQ(Command("a").pid, 101);
}

// No orders are needed for it: the sheriff may be gone.
TEST_F(DeputyStateTest, KillsWhatDoesNotEndInItsTime) {
  CommandOrder order = Order("a", 1);
  order.spec.stop_signal = SIGTERM;
  order.spec.stop_time_allowed_s = 3.0;
  Orders({order});
  Orders({Off(order)});
  EXPECT_THAT(TakeDone(), ElementsAre("start a", "signal 100 15"));
  Pass(milliseconds(2999));
  EXPECT_THAT(TakeDone(), ElementsAre());
  Pass(milliseconds(1));
  EXPECT_THAT(TakeDone(), ElementsAre("signal 100 9"));
  Pass(milliseconds(1500));
  EXPECT_THAT(TakeDone(), ElementsAre("signal 100 9"));
  Exit(100, SIGKILL);
  EXPECT_FALSE(state_.next_timer());
  Orders({Off(order)});
  EXPECT_EQ(Command("a").exit_code, 9);
}

TEST_F(DeputyStateTest, RunIdZeroIsNoOpinion) {
  Orders({Order("a", 0)});
  EXPECT_THAT(TakeDone(), ElementsAre());
  Orders({Order("a", 5)});
  Orders({Order("a", 0)});
  EXPECT_THAT(TakeDone(), ElementsAre("start a"));
  EXPECT_EQ(Command("a").actual_runid, 5);
  Exit(100, 0);
  Orders({Order("a", 0)});
  EXPECT_THAT(TakeDone(), ElementsAre("end 100"));
}

TEST_F(DeputyStateTest, InTheOldDialectRunIdZeroEndsWhatRuns) {
  Use({"", DeputyDialect::kBotProcman, {}});
  Orders({Order("a", 5)});
  Orders({Order("a", 0)});
  EXPECT_THAT(TakeDone(), ElementsAre("start a", "signal 100 2"));
  Exit(100, 0);
  EXPECT_THAT(TakeDone(), ElementsAre("end 100", "start a"));
  EXPECT_EQ(Command("a").actual_runid, 0);
}

TEST_F(DeputyStateTest, WhatOrdersDoNotNameGoes) {
  Orders({Order("a", 1), Order("b", 1)});
  Exit(101, 0);
  TakeDone();
  Orders({});
  EXPECT_THAT(TakeDone(), ElementsAre("signal 100 2"));
  EXPECT_EQ(state_.commands().count("b"), 0u);
  EXPECT_TRUE(Command("a").is_removing);
  Orders({});
  EXPECT_THAT(TakeDone(), ElementsAre());
  Exit(100, 0);
  EXPECT_TRUE(state_.commands().empty());
}

TEST_F(DeputyStateTest, WhatIsNamedAgainWhileItGoesStays) {
  Orders({Order("a", 1)});
  Orders({});
  Orders({Order("a", 1)});
  EXPECT_FALSE(Command("a").is_removing);
  Exit(100, 0);
  EXPECT_THAT(TakeDone(), ElementsAre("start a", "signal 100 2", "end 100"));
  Orders({Order("a", 2)});
  EXPECT_THAT(TakeDone(), ElementsAre("start a"));
}

TEST_F(DeputyStateTest, RespawnsLaterTheOftenerItFails) {
  Orders({Respawned(Order("a", 1))});
  TakeDone();
  std::vector<std::int64_t> waits;
  for (int i = 0; i < 9; ++i) {
    Exit(Command("a").pid, 256);
    const Duration at = *state_.next_timer();
    waits.push_back((at - now_).count() / 1000);
    Pass(at - now_);
    EXPECT_EQ(Command("a").actual_runid, 1);
  }
  EXPECT_THAT(waits, ElementsAre(20, 40, 80, 160, 320, 640, 1000, 1000, 1000));
  EXPECT_EQ(Command("a").num_respawns, 9);
  // Each whole second that it lived halves the wait; also after success.
  Pass(milliseconds(3500));
  Exit(Command("a").pid, 0);
  EXPECT_EQ(*state_.next_timer() - now_, milliseconds(125));
  Pass(seconds(1));
  Pass(seconds(100));
  Exit(Command("a").pid, 0);
  EXPECT_EQ(*state_.next_timer() - now_, milliseconds(10));
}

TEST_F(DeputyStateTest, AnOperatorsStopWinsOverARespawn) {
  const CommandOrder order = Respawned(Order("a", 1));
  Orders({order});
  Exit(100, 256);
  Orders({Off(order)});
  EXPECT_FALSE(state_.next_timer());
  Pass(seconds(10));
  EXPECT_THAT(TakeDone(), ElementsAre("start a", "end 100"));
  // Neither does it come back once it was stopped itself.
  Orders({Respawned(Order("a", 2))});
  Orders({Off(Respawned(Order("a", 2)))});
  Exit(101, SIGINT);
  Pass(seconds(10));
  EXPECT_THAT(TakeDone(), ElementsAre("start a", "signal 101 2", "end 101"));
}

TEST_F(DeputyStateTest, WhatCannotBeStartedHasEnded) {
  cannot_start_ = true;
  Orders({Order("a", 1)});
  EXPECT_THAT(TakeDone(), ElementsAre("fail a"));
  EXPECT_EQ(Command("a").exit_code, 65280);
  EXPECT_THAT(said_, HasSubstr("a: no such file"));
  Orders({Respawned(Order("a", 2))});
  TakeDone();
  cannot_start_ = false;
  Pass(seconds(2));
  EXPECT_THAT(TakeDone(), ElementsAre("start a"));
}

TEST_F(DeputyStateTest, StaleOrdersAreNotFollowedThoseOfTheFutureAre) {
  DeputyOrders orders;
  orders.deputy_id = "robot";
  orders.commands = {Order("a", 1)};
  orders.utime = wall_ - seconds(61);
  Do(state_.OnOrders(orders, wall_, now_));
  EXPECT_THAT(TakeDone(), ElementsAre());
  EXPECT_EQ(state_.num_stale(), 1);
  EXPECT_THAT(said_, HasSubstr("a: orders are passed over"));
  orders.utime = wall_ + seconds(3600);
  Do(state_.OnOrders(orders, wall_, now_));
  EXPECT_THAT(TakeDone(), ElementsAre("start a"));
  orders.deputy_id = "another";
  orders.commands.clear();
  Do(state_.OnOrders(orders, wall_, now_));
  EXPECT_EQ(state_.num_orders(), 2);
  EXPECT_EQ(state_.commands().size(), 1u);
}

TEST_F(DeputyStateTest, OfTwoWithOneIdTheFirstCounts) {
  Orders({Order("a", 1), Off(Order("a", 1))});
  EXPECT_THAT(TakeDone(), ElementsAre("start a"));
}

TEST_F(DeputyStateTest, WhatMustNotRunIsRefusedButMayBeStopped) {
  Use({"", {}, [](const CommandSpec& spec) {
         return spec.exec == "a --run" ? std::string() : "not listed";
       }});
  Orders({Order("a", 1), Order("b", 7)});
  EXPECT_THAT(TakeDone(), ElementsAre("start a"));
  EXPECT_THAT(said_, HasSubstr("b: refused: not listed"));
  EXPECT_EQ(state_.num_refused(), 1);
  EXPECT_EQ(Command("b").exit_code, 126 << 8);
  EXPECT_EQ(Command("b").actual_runid, 7);
  // A changed exec string does not touch what runs.
  CommandOrder changed = Order("a", 2);
  changed.spec.exec = "rm -r /";
  Orders({changed, Order("b", 7)});
  EXPECT_THAT(TakeDone(), ElementsAre());
  EXPECT_EQ(Command("a").spec.exec, "a --run");
  Orders({Off(changed), Order("b", 7)});
  EXPECT_THAT(TakeDone(), ElementsAre("signal 100 2"));
  Exit(100, 2);
  EXPECT_THAT(TakeDone(), ElementsAre("end 100"));
  Orders({Order("a", 3)});
  EXPECT_THAT(TakeDone(), ElementsAre("start a"));
}

TEST_F(DeputyStateTest, KeepsNoMoreCommandsThanCanBeMeant) {
  Use({"", {}, [](const CommandSpec&) { return std::string("no"); }});
  std::vector<CommandOrder> orders;
  for (int i = 0; i < 5000; ++i) orders.push_back(Order(std::to_string(i), 1));
  Orders(orders);
  EXPECT_EQ(state_.commands().size(), DeputyState::kMostCommands);
  EXPECT_EQ(state_.num_refused(), 5000);
}

TEST_F(DeputyStateTest, QuitsOnceAllHaveEnded) {
  Orders({Respawned(Order("a", 1)), Respawned(Order("b", 1))});
  Exit(101, 256);
  TakeDone();
  EXPECT_FALSE(state_.is_done());
  Do(state_.OnQuit(now_));
  EXPECT_THAT(TakeDone(), ElementsAre("signal 100 2"));
  EXPECT_FALSE(state_.is_done());
  Orders({Order("a", 9), Order("c", 1)});
  Pass(seconds(7));
  EXPECT_THAT(TakeDone(), ElementsAre("signal 100 9"));
  Exit(100, 9);
  EXPECT_TRUE(state_.is_done());
  EXPECT_FALSE(state_.next_timer());
}

TEST_F(DeputyStateTest, OthersChildrenAreNoneOfItsOwn) {
  Orders({Order("a", 1)});
  Exit(77, 0);
  EXPECT_EQ(Command("a").pid, 100);
}

}  // namespace
}  // namespace waymark
