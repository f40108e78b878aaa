#include "procman/sheriff/sheriff_state.h"

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

// Never 0, which is no opinion.
std::int32_t NextRunId(std::int32_t runid) {
  return runid < 0 || runid == std::numeric_limits<std::int32_t>::max()
             ? 1
             : runid + 1;
}

// By one of the signals with which one stops a command.
bool WasStopped(std::int32_t exit_code) {
  if (!WIFSIGNALED(exit_code)) return false;
  const int signal = WTERMSIG(exit_code);
  return signal == SIGTERM || signal == SIGINT || signal == SIGKILL;
}

CommandSpec SpecOf(const DeploymentCommand& command) {
  return {command.id,
          command.exec,
          command.group,
          command.auto_respawn,
          command.stop_signal,
          static_cast<double>(command.stop_time_allowed_s)};
}

}  // namespace

const char* NameOf(CommandStatus status) {
  switch (status) {
    case CommandStatus::kStarting:
      return "starting";
    case CommandStatus::kRestarting:
      return "restarting";
    case CommandStatus::kRunning:
      return "running";
    case CommandStatus::kStopping:
      return "stopping";
    case CommandStatus::kRemoving:
      return "removing";
    case CommandStatus::kStopped:
      return "stopped";
    case CommandStatus::kFailed:
      return "failed";
    default:
      return "unknown";
  }
}

CommandStatus SheriffCommand::status() const {
  if (!report) return CommandStatus::kUnknown;
  const bool is_as_ordered = desired_runid == report->actual_runid;
  if (!is_as_ordered && !force_quit) {
    return report->pid == 0 ? CommandStatus::kStarting
                            : CommandStatus::kRestarting;
  }
  if (!is_as_ordered) return CommandStatus::kUnknown;
  if (report->pid != 0) {
    return force_quit || is_removing ? CommandStatus::kStopping
                                     : CommandStatus::kRunning;
  }
  if (is_removing) return CommandStatus::kRemoving;
  const bool is_good =
      report->exit_code == 0 || (force_quit && WasStopped(report->exit_code));
  return is_good ? CommandStatus::kStopped : CommandStatus::kFailed;
}

SheriffState::SheriffState(std::string sheriff_id, bool is_observer)
    : sheriff_id_(std::move(sheriff_id)), is_observer_(is_observer) {}

void SheriffState::Load(const Deployment& deployment) {
  for (const DeploymentCommand& command : deployment.commands) {
    const auto found = commands_.find(command.id);
    if (found != commands_.end() &&
        found->second.command.deputy != command.deputy) {
      throw std::invalid_argument("\"" + command.id + "\" is a command of " +
                                  found->second.command.deputy + ", not of " +
                                  command.deputy);
    }
  }
  for (const DeploymentCommand& command : deployment.commands) {
    SheriffCommand& own = commands_[command.id];
    own.command = command;
    own.is_loaded = true;
  }
}

void SheriffState::Adopt(const std::string& deputy_id,
                         const CommandReport& report) {
  SheriffCommand& own = commands_[report.spec.id];
  const bool is_new = own.command.id.empty();
  if (is_new) {
    own.command.id = report.spec.id;
    own.command.exec = report.spec.exec;
    own.command.group = report.spec.group;
    own.command.deputy = deputy_id;
    own.command.auto_respawn = report.spec.auto_respawn;
    own.command.stop_signal = report.spec.stop_signal;
    own.command.stop_time_allowed_s =
        std::max(1, static_cast<int>(report.spec.stop_time_allowed_s + 0.5));
  }
  // Of another deputy: ids are unique, so that one is mistaken.
  if (own.command.deputy != deputy_id) return;
  const bool was_running = own.is_running();
  own.report = report;
  if (own.desired_runid == 0 && report.actual_runid != 0) {
    own.desired_runid = report.actual_runid;
    own.force_quit = report.pid == 0;
  }
  // What has ended by itself is not started again by a deputy that was.
  const bool has_ended = was_running && report.pid == 0 &&
                         own.desired_runid == report.actual_runid;
  if (has_ended && !own.command.auto_respawn) own.force_quit = true;
}

bool SheriffState::OnReport(const DeputyReport& report,
                            Time wall,
                            Duration now) {
  if (!is_observer_ && wall - report.utime > kStale) return false;
  std::map<std::string, CommandStatus> before;
  for (const auto& [id, command] : commands_) before[id] = command.status();
  SheriffDeputy& deputy = deputies_[report.deputy_id];
  const bool is_new = deputy.report.deputy_id.empty();
  const Duration offset = report.utime - wall;
  // A message is late, never early: the largest is nearest. Clocks drift, so
  // it goes down again, slowly.
  constexpr Duration kForget = std::chrono::microseconds(100);
  deputy.clock_offset =
      is_new ? offset : std::max(offset, deputy.clock_offset - kForget);
  deputy.report = report;
  deputy.report.commands.clear();
  deputy.heard = now;
  std::set<std::string> named;
  for (const CommandReport& command : report.commands) {
    named.insert(command.spec.id);
    Adopt(report.deputy_id, command);
  }
  for (auto it = commands_.begin(); it != commands_.end();) {
    SheriffCommand& own = it->second;
    if (own.command.deputy != report.deputy_id || named.count(it->first) != 0) {
      ++it;
    } else if (own.is_removing || !own.is_loaded) {
      it = commands_.erase(it);
    } else {
      // The deputy does not know of it yet, or no longer: it was started anew.
      own.report = CommandReport{SpecOf(own.command)};
      ++it;
    }
  }
  if (is_new || before.size() != commands_.size()) return true;
  return std::any_of(
      commands_.begin(), commands_.end(), [&before](const auto& entry) {
        const auto found = before.find(entry.first);
        return found == before.end() || found->second != entry.second.status();
      });
}

bool SheriffState::OnOrders(const DeputyOrders& orders) {
  if (orders.sheriff_id == sheriff_id_) return false;
  const bool is_first = other_ != orders.sheriff_id;
  other_ = orders.sheriff_id;
  is_observer_ = true;
  // What the other wants is what is to be expected.
  for (const CommandOrder& order : orders.commands) {
    const auto found = commands_.find(order.spec.id);
    if (found == commands_.end()) continue;
    found->second.desired_runid = order.desired_runid;
    found->second.force_quit = order.force_quit;
  }
  return is_first;
}

SheriffCommand* SheriffState::Find(const std::string& id) {
  if (is_observer_) {
    throw std::logic_error(other_.empty()
                               ? "an observer gives no orders"
                               : "another sheriff gives orders: " + other_);
  }
  const auto found = commands_.find(id);
  if (found == commands_.end()) {
    throw std::invalid_argument("there is no command \"" + id + "\"");
  }
  return &found->second;
}

void SheriffState::Start(const std::string& id) {
  SheriffCommand* command = Find(id);
  const bool is_on = command->is_running() && !command->force_quit;
  if (!is_on) command->desired_runid = NextRunId(command->desired_runid);
  command->force_quit = false;
  command->is_removing = false;
}

void SheriffState::Stop(const std::string& id) {
  Find(id)->force_quit = true;
}

void SheriffState::Restart(const std::string& id) {
  SheriffCommand* command = Find(id);
  command->desired_runid = NextRunId(command->desired_runid);
  command->force_quit = false;
  command->is_removing = false;
}

void SheriffState::Remove(const std::string& id) {
  SheriffCommand* command = Find(id);
  command->is_removing = true;
  command->force_quit = true;
  // Nobody would ever say that it is gone.
  if (deputies_.count(command->command.deputy) == 0) commands_.erase(id);
}

std::vector<DeputyOrders> SheriffState::Orders(Time wall) const {
  std::vector<DeputyOrders> all;
  if (is_observer_) return all;
  for (const auto& [deputy_id, deputy] : deputies_) {
    DeputyOrders orders;
    orders.utime = wall;
    orders.deputy_id = deputy_id;
    orders.sheriff_id = sheriff_id_;
    for (const auto& [id, command] : commands_) {
      if (command.command.deputy != deputy_id || command.is_removing) continue;
      orders.commands.push_back(
          {SpecOf(command.command), command.desired_runid, command.force_quit});
    }
    all.push_back(std::move(orders));
  }
  return all;
}

}  // namespace waymark
