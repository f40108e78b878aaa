#include "procman/deputy/deputy_messages.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

namespace waymark {
namespace {

// A day; also what is not a number becomes something that can be waited for.
constexpr float kLongestStop = 86400.0f;

double StopTime(float seconds) {
  return seconds > 0.0f ? static_cast<double>(std::min(seconds, kLongestStop))
                        : 0.0;
}

int StopSignal(std::int8_t signal) {
  return signal > 0 && signal < NSIG ? signal : SIGINT;
}

}  // namespace

DeputyOrders ToOrders(const procman_lcm::orders_t& message) {
  DeputyOrders orders;
  orders.utime = TimeFromMicroseconds(message.utime);
  orders.deputy_id = message.deputy_id;
  orders.sheriff_id = message.sheriff_id;
  for (const procman_lcm::cmd_desired_t& desired : message.cmds) {
    CommandOrder order;
    order.spec = {desired.cmd.command_id,
                  desired.cmd.exec_str,
                  desired.cmd.group,
                  desired.cmd.auto_respawn != 0,
                  StopSignal(desired.cmd.stop_signal),
                  StopTime(desired.cmd.stop_time_allowed)};
    order.desired_runid = desired.desired_runid;
    order.force_quit = desired.force_quit != 0;
    orders.commands.push_back(std::move(order));
  }
  return orders;
}

procman_lcm::orders_t FromOrders(const DeputyOrders& orders) {
  procman_lcm::orders_t message;
  message.utime = Microseconds(orders.utime);
  message.deputy_id = orders.deputy_id;
  message.sheriff_id = orders.sheriff_id;
  for (const CommandOrder& order : orders.commands) {
    procman_lcm::cmd_desired_t desired;
    desired.cmd.command_id = order.spec.id;
    desired.cmd.exec_str = order.spec.exec;
    desired.cmd.group = order.spec.group;
    desired.cmd.auto_respawn = order.spec.auto_respawn ? 1 : 0;
    desired.cmd.stop_signal = static_cast<std::int8_t>(order.spec.stop_signal);
    desired.cmd.stop_time_allowed =
        static_cast<float>(order.spec.stop_time_allowed_s);
    desired.desired_runid = order.desired_runid;
    desired.force_quit = order.force_quit ? 1 : 0;
    message.cmds.push_back(std::move(desired));
  }
  message.ncmds = static_cast<std::int32_t>(message.cmds.size());
  return message;
}

procman_lcm::deputy_info_t ToInfo(
    const std::string& deputy_id,
    const std::map<std::string, CommandState>& commands,
    const std::map<std::string, CommandUse>& uses,
    const MachineMemory& memory,
    double cpu_load,
    Time utime) {
  procman_lcm::deputy_info_t message;
  message.utime = Microseconds(utime);
  message.deputy_id = deputy_id;
  message.cpu_load = static_cast<float>(cpu_load);
  message.phys_mem_total_bytes = memory.total_bytes;
  message.phys_mem_free_bytes = memory.free_bytes;
  message.swap_total_bytes = memory.swap_total_bytes;
  message.swap_free_bytes = memory.swap_free_bytes;
  for (const auto& [id, command] : commands) {
    procman_lcm::cmd_status_t status;
    status.cmd.command_id = id;
    status.cmd.exec_str = command.spec.exec;
    status.cmd.group = command.spec.group;
    status.cmd.auto_respawn = command.spec.auto_respawn ? 1 : 0;
    status.cmd.stop_signal = static_cast<std::int8_t>(command.spec.stop_signal);
    status.cmd.stop_time_allowed =
        static_cast<float>(command.spec.stop_time_allowed_s);
    status.pid = command.pid;
    status.actual_runid = command.actual_runid;
    status.exit_code = command.exit_code;
    const auto use = uses.find(id);
    const CommandUse used =
        command.is_running() && use != uses.end() ? use->second : CommandUse();
    status.cpu_usage = static_cast<float>(used.cpu_share);
    status.mem_vsize_bytes = used.virtual_bytes;
    status.mem_rss_bytes = used.resident_bytes;
    message.cmds.push_back(std::move(status));
  }
  message.ncmds = static_cast<std::int32_t>(message.cmds.size());
  return message;
}

}  // namespace waymark
