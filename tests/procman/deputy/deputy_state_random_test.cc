// Random orders, exits and jumps of the clock: what must always hold.
#include "estimation/base/random.h"
#include "procman/deputy/deputy_state.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr int kNumIds = 6;
constexpr int kNumEvents = 100'000;
// From SIGKILL to the end of a process here, at most.
constexpr Duration kDying = milliseconds(300);

// Processes as a kernel would keep them: some end by themselves, some pass over
// all signals but SIGKILL.
struct Process {
  std::string id;
  bool is_deaf = false;
  std::optional<Duration> ends_at;
  std::int32_t status = 0;
};

class World {
 public:
  World(DeputyDialect dialect, std::uint64_t seed)
      : random_(seed), state_(OptionsOf(dialect)) {}

  void Run(int num_events) {
    for (int i = 0; i < num_events; ++i) {
      switch (random_.Index(8)) {
        case 0:
        case 1:
          Order();
          break;
        case 2:
          wall_ += random_.Index(4) == 0 ? Duration(seconds(-400))
                                         : Duration(milliseconds(300));
          break;
        case 3:
          // Of somebody else's child.
          Do(state_.OnExit(5, 0, now_));
          break;
        case 4:
          EndOne();
          break;
        default:
          Pass(milliseconds(random_.Index(1500)));
      }
      Check();
      if (testing::Test::HasFatalFailure()) return;
    }
  }

  // Everything ends, and nothing comes again.
  void Quit() {
    Do(state_.OnQuit(now_));
    Pass(seconds(30));
    EXPECT_TRUE(state_.is_done());
    EXPECT_TRUE(processes_.empty());
  }

  [[nodiscard]] int num_starts() const { return num_starts_; }
  [[nodiscard]] int num_kills() const { return num_kills_; }
  [[nodiscard]] int num_refused() const {
    return static_cast<int>(state_.num_refused());
  }

  void operator()(const StartChild& action) {
    const CommandState& command = state_.commands().at(action.id);
    for (const auto& [pid, process] : processes_) {
      ASSERT_NE(process.id, action.id) << "two processes of one command";
    }
    ASSERT_NE(command.spec.exec, "forbidden");
    ASSERT_FALSE(command.force_quit);
    ++num_starts_;
    if (random_.Index(10) == 0) {
      Do(state_.OnStartFailed(action.id, "no", now_));
      return;
    }
    Process process;
    process.id = action.id;
    process.is_deaf = random_.Index(4) == 0;
    if (random_.Index(3) == 0) {
      process.ends_at = now_ + milliseconds(random_.Index(4000));
      process.status = static_cast<std::int32_t>(random_.Index(3)) << 8;
    }
    processes_.emplace(++last_pid_, process);
    Do(state_.OnStarted(action.id, last_pid_, now_));
  }
  void operator()(const SignalFamily& action) {
    const auto found = processes_.find(action.pid);
    ASSERT_NE(found, processes_.end()) << "a signal to nobody";
    ASSERT_EQ(found->second.id, action.id);
    Process& process = found->second;
    num_kills_ += action.signal == SIGKILL ? 1 : 0;
    if (process.is_deaf && action.signal != SIGKILL) return;
    const Duration end = now_ + Duration(random_.Index(kDying.count()));
    if (process.ends_at && *process.ends_at <= end) return;
    process.ends_at = end;
    process.status = action.signal;
  }
  void operator()(const EndFamily& action) {
    ASSERT_EQ(processes_.count(action.pid), 0u);
  }
  void operator()(const SayText&) {}
  void operator()(const PublishInfo&) {}

 private:
  static DeputyStateOptions OptionsOf(DeputyDialect dialect) {
    return {"robot", dialect, [](const CommandSpec& spec) {
              return spec.exec == "forbidden" ? std::string("forbidden")
                                              : std::string();
            }};
  }

  void Do(const DeputyState::Actions& actions) {
    for (const DeputyAction& action : actions) std::visit(*this, action);
  }

  void Order() {
    DeputyOrders orders;
    orders.deputy_id = random_.Index(10) == 0 ? "another" : "robot";
    orders.utime = wall_ - (random_.Index(10) == 0 ? seconds(100) : seconds(0));
    for (int i = 0; i < kNumIds; ++i) {
      if (random_.Index(6) == 0) continue;
      CommandOrder order;
      order.spec.id = std::to_string(i);
      order.spec.exec = random_.Index(20) == 0 ? "forbidden" : "fine";
      order.spec.auto_respawn = random_.Index(2) == 0;
      order.spec.stop_signal = random_.Index(2) == 0 ? SIGINT : SIGTERM;
      order.spec.stop_time_allowed_s = 0.5 + 3.0 * random_.Uniform();
      order.desired_runid = static_cast<std::int32_t>(random_.Index(4));
      order.force_quit = random_.Index(3) == 0;
      orders.commands.push_back(order);
    }
    const bool is_followed =
        orders.deputy_id == "robot" && orders.utime == wall_;
    Do(state_.OnOrders(orders, wall_, now_));
    if (!is_followed) return;
    std::set<std::string> wanted;
    for (const CommandOrder& order : orders.commands) {
      if (!order.force_quit) wanted.insert(order.spec.id);
    }
    for (int i = 0; i < kNumIds; ++i) {
      const std::string id = std::to_string(i);
      if (wanted.count(id) != 0) {
        off_since_.erase(id);
      } else {
        off_since_.try_emplace(id, now_);
      }
    }
  }

  // By itself, at any time.
  void EndOne() {
    if (processes_.empty()) return;
    auto it = processes_.begin();
    std::advance(it, random_.Index(processes_.size()));
    Reap(it->first, 256);
  }

  void Reap(std::int32_t pid, std::int32_t status) {
    const std::string id = processes_.at(pid).id;
    processes_.erase(pid);
    const auto actions = state_.OnExit(pid, status, now_);
    const auto found = state_.commands().find(id);
    if (found != state_.commands().end()) {
      ASSERT_EQ(found->second.pid, 0) << "not reaped";
    }
    Do(actions);
  }

  void Pass(Duration duration) {
    const Duration end = now_ + duration;
    wall_ += duration;
    while (true) {
      std::optional<Duration> next = state_.next_timer();
      std::int32_t pid = 0;
      for (const auto& [some, process] : processes_) {
        if (process.ends_at && (!next || *process.ends_at < *next)) {
          next = process.ends_at;
          pid = some;
        }
      }
      if (!next || *next > end) break;
      now_ = std::max(now_, *next);
      if (pid != 0) {
        Reap(pid, processes_.at(pid).status);
      } else {
        Do(state_.OnTimer(now_));
      }
    }
    now_ = end;
  }

  void Check() {
    // Each process belongs to a command that knows it.
    for (const auto& [pid, process] : processes_) {
      const auto found = state_.commands().find(process.id);
      ASSERT_NE(found, state_.commands().end()) << "a process of nobody";
      ASSERT_EQ(found->second.pid, pid);
      // Off for longer than it had time for.
      const auto off = off_since_.find(process.id);
      if (off == off_since_.end()) continue;
      const Duration longest = milliseconds(3500) + kDying;
      ASSERT_LE((now_ - off->second).count(), longest.count())
          << "it runs though it was forced off";
    }
    for (const auto& [id, command] : state_.commands()) {
      ASSERT_TRUE(command.pid == 0 || processes_.count(command.pid) == 1);
      // What is off never waits to come again.
      ASSERT_TRUE(off_since_.count(id) == 0 || !command.respawn_at);
    }
  }

  Random random_;
  DeputyState state_;
  Duration now_ = seconds(50);
  Time wall_ = TimeFromMicroseconds(1'700'000'000'000'000);
  std::map<std::int32_t, Process> processes_;
  std::map<std::string, Duration> off_since_;
  std::int32_t last_pid_ = 1000;
  int num_starts_ = 0;
  int num_kills_ = 0;
};

TEST(DeputyStateRandom, KeepsItsInvariants) {
  for (const DeputyDialect dialect :
       {DeputyDialect::kProcman, DeputyDialect::kBotProcman}) {
    World world(dialect, SeedFor(7, "DeputyStateRandom"));
    world.Run(kNumEvents);
    world.Quit();
    EXPECT_GT(world.num_starts(), 10'000);
    EXPECT_GT(world.num_kills(), 1'000);
    EXPECT_GT(world.num_refused(), 1'000);
  }
}

}  // namespace
}  // namespace waymark
