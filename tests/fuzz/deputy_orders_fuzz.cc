// Orders as a deputy gets them from anybody, and reports as a sheriff does: one
// message after another, with starts, exits and time between them.
#include "processes/support/decode.h"
#include "procman/deputy/deputy_messages.h"
#include "procman/sheriff/sheriff_state.h"
#include "tests/fuzz/fuzz_target.h"

#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/orders_t.hpp>

#include <map>
#include <string>
#include <variant>

namespace waymark::fuzz {
namespace {

class Host {
 public:
  void Do(const DeputyState::Actions& actions) {
    for (const DeputyAction& action : actions) {
      if (const auto* start = std::get_if<StartChild>(&action)) {
        for (const auto& [pid, id] : processes_) {
          Expect(id != start->id, "one process of each command");
        }
        processes_[++last_pid_] = start->id;
        Do(state.OnStarted(start->id, last_pid_, now));
      } else if (const auto* signal = std::get_if<SignalFamily>(&action)) {
        Expect(processes_.count(signal->pid) == 1, "a process of its own");
        Expect(signal->signal > 0 && signal->signal < 65, "a signal");
      }
    }
  }
  void EndFirst(std::int32_t status) {
    if (processes_.empty()) return;
    const std::int32_t pid = processes_.begin()->first;
    processes_.erase(pid);
    Do(state.OnExit(pid, status, now));
  }

  DeputyState state{DeputyStateOptions{"robot", {}, {}}};
  Duration now = std::chrono::seconds(1);

 private:
  std::map<std::int32_t, std::string> processes_;
  std::int32_t last_pid_ = 1;
};

}  // namespace

void RunOne(Bytes data) {
  constexpr std::size_t kMostMessages = 6;
  Host host;
  SheriffState sheriff("sheriff");
  const Time wall = TimeFromMicroseconds(1'700'000'000'000'000);
  for (const Bytes part : Split(data, kMostMessages)) {
    const auto orders = DecodeMessage<procman_lcm::orders_t>(WithFingerprint(
        static_cast<std::uint64_t>(procman_lcm::orders_t::getHash()), part));
    if (orders) {
      DeputyOrders values = ToOrders(*orders);
      values.deputy_id = "robot";
      values.utime = wall;
      host.Do(host.state.OnOrders(values, wall, host.now));
      (void)FromOrders(values);
      (void)sheriff.OnOrders(values);
    }
    host.EndFirst(static_cast<std::int32_t>(part.size()));
    host.now += std::chrono::milliseconds(700);
    host.Do(host.state.OnTimer(host.now));
    const auto info = ToInfo("robot", host.state.commands(), {}, {}, 0.0, wall);
    Expect(info.ncmds == static_cast<std::int32_t>(info.cmds.size()),
           "its length");
  }
  host.Do(host.state.OnQuit(host.now));
  while (!host.state.is_done()) host.EndFirst(0);
}

std::vector<std::string> Seeds() {
  procman_lcm::orders_t orders;
  orders.deputy_id = "robot";
  orders.sheriff_id = "sheriff";
  procman_lcm::cmd_desired_t desired;
  desired.cmd.command_id = "a";
  desired.cmd.exec_str = "run";
  desired.cmd.auto_respawn = 1;
  desired.cmd.stop_signal = 2;
  desired.cmd.stop_time_allowed = 1.0f;
  desired.desired_runid = 3;
  orders.cmds = {desired, desired};
  orders.cmds[1].cmd.command_id = "b";
  orders.cmds[1].force_quit = 1;
  orders.ncmds = 2;
  std::string data(static_cast<std::size_t>(orders.getEncodedSize()), '\0');
  orders.encode(data.data(), 0, static_cast<int>(data.size()));
  const std::string body = data.substr(8);
  return {body, body + "\xFF" + body};
}

}  // namespace waymark::fuzz
