#include "procman/deputy/deputy_state.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <csignal>
#include <set>
#include <utility>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kFirstDelay = milliseconds(10);
constexpr Duration kLongestDelay = seconds(1);
// Who lived shorter failed at its start.
constexpr Duration kShortLife = seconds(1);
// SIGKILL again, for what it did not reach: it may wait for a disk.
constexpr Duration kKillAgain = seconds(1);

// The wait before the next start, from the last one and how long it ran.
Duration NextDelay(Duration delay, Duration lived) {
  if (lived < kShortLife) {
    return std::clamp(2 * delay, kFirstDelay, kLongestDelay);
  }
  const auto whole = std::chrono::duration_cast<seconds>(lived).count();
  return std::max(kFirstDelay,
                  Duration(delay.count() >> std::min<std::int64_t>(whole, 30)));
}

}  // namespace

DeputyState::DeputyState(DeputyStateOptions options)
    : options_(std::move(options)) {}

void DeputyState::Start(CommandState* command, Actions* actions) {
  command->respawn_at.reset();
  command->exit_code = 0;
  command->is_starting = true;
  ++command->num_starts;
  has_changed_ = true;
  actions->push_back(StartChild{command->spec.id});
}

void DeputyState::Stop(CommandState* command, Duration now, Actions* actions) {
  command->respawn_at.reset();
  if (!command->is_running() || command->kill_at) return;
  // Signals to 0 would go to the deputy itself.
  WAYMARK_CHECK(command->pid > 0, command->spec.id);
  command->kill_at =
      now + DurationFromSeconds(command->spec.stop_time_allowed_s);
  has_changed_ = true;
  actions->push_back(
      SignalFamily{command->spec.id, command->pid, command->spec.stop_signal});
}

bool DeputyState::Refuse(const CommandOrder& order,
                         CommandState* command,
                         Duration now,
                         Actions* actions) {
  const std::string why =
      options_.refuse ? options_.refuse(order.spec) : std::string();
  if (why.empty()) {
    command->refusal.clear();
    return false;
  }
  ++num_refused_;
  if (command->refusal != why) {
    command->refusal = why;
    has_changed_ = true;
    actions->push_back(SayText{order.spec.id, "refused: " + why + "\n"});
  }
  // Who may not have it run may stop it.
  command->force_quit = order.force_quit;
  if (order.force_quit) Stop(command, now, actions);
  if (!command->is_running()) {
    command->respawn_at.reset();
    command->actual_runid = order.desired_runid;
    command->exit_code = order.force_quit ? command->exit_code : kRefused;
  }
  return true;
}

void DeputyState::Follow(const CommandOrder& order,
                         Duration now,
                         Actions* actions) {
  if (commands_.size() >= kMostCommands &&
      commands_.count(order.spec.id) == 0) {
    ++num_refused_;
    return;
  }
  const auto [entry, is_new] = commands_.try_emplace(order.spec.id);
  CommandState& command = entry->second;
  if (is_new) {
    command.spec.id = order.spec.id;
    command.spec.group = order.spec.group;
    command.respawn_delay = kFirstDelay;
    has_changed_ = true;
  }
  if (command.is_removing) {
    command.is_removing = false;
    has_changed_ = true;
  }
  if (Refuse(order, &command, now, actions)) return;
  has_changed_ |=
      !(command.spec == order.spec) || command.force_quit != order.force_quit;
  command.spec = order.spec;
  command.force_quit = order.force_quit;
  command.desired_runid = order.desired_runid;
  const bool has_opinion = order.desired_runid != 0 ||
                           options_.dialect == DeputyDialect::kBotProcman;
  const bool is_another =
      has_opinion && order.desired_runid != command.actual_runid;
  if (order.force_quit || (command.is_running() && is_another)) {
    Stop(&command, now, actions);
  } else if (!command.is_running() && is_another) {
    command.respawn_delay = kFirstDelay;
    command.actual_runid = order.desired_runid;
    Start(&command, actions);
  }
  // Of what is stopped for good the sheriff's number is taken over.
  if (order.force_quit && has_opinion && is_another) {
    command.actual_runid = order.desired_runid;
    has_changed_ = true;
  }
}

DeputyState::Actions DeputyState::OnOrders(const DeputyOrders& orders,
                                           Time wall,
                                           Duration now) {
  Actions actions;
  if (is_quitting_ || orders.deputy_id != options_.deputy_id) return actions;
  ++num_orders_;
  if (wall - orders.utime > kStale) {
    ++num_stale_;
    for (const CommandOrder& order : orders.commands) {
      actions.push_back(SayText{
          order.spec.id,
          "orders are passed over: by this host's clock they are older than a "
          "minute\n"});
    }
    return actions;
  }
  has_changed_ = false;
  std::set<std::string> named;
  for (const CommandOrder& order : orders.commands) {
    // Of two with the same id the first counts.
    if (named.insert(order.spec.id).second) Follow(order, now, &actions);
  }
  for (auto it = commands_.begin(); it != commands_.end();) {
    CommandState& command = it->second;
    if (named.count(it->first) != 0) {
      ++it;
    } else if (command.is_running()) {
      has_changed_ |= !command.is_removing;
      command.is_removing = true;
      command.force_quit = true;
      Stop(&command, now, &actions);
      ++it;
    } else {
      has_changed_ = true;
      it = commands_.erase(it);
    }
  }
  if (has_changed_) actions.push_back(PublishInfo{});
  return actions;
}

DeputyState::Actions DeputyState::OnStarted(const std::string& id,
                                            std::int32_t pid,
                                            Duration now) {
  const auto found = commands_.find(id);
  WAYMARK_CHECK(found != commands_.end() && found->second.is_starting, id);
  WAYMARK_CHECK(pid > 0 && ids_.count(pid) == 0, pid);
  CommandState& command = found->second;
  command.is_starting = false;
  command.pid = pid;
  command.started = now;
  ids_.emplace(pid, id);
  return {};
}

void DeputyState::Ended(const std::string& id,
                        std::int32_t status,
                        Duration now,
                        Actions* actions) {
  const auto found = commands_.find(id);
  CommandState& command = found->second;
  const Duration lived = now - command.started;
  command.pid = 0;
  command.is_starting = false;
  command.exit_code = status;
  command.kill_at.reset();
  actions->push_back(PublishInfo{});
  if (command.is_removing) {
    commands_.erase(found);
    return;
  }
  if (is_quitting_ || command.force_quit || !command.refusal.empty()) return;
  const bool has_opinion = command.desired_runid != 0 ||
                           options_.dialect == DeputyDialect::kBotProcman;
  if (has_opinion && command.desired_runid != command.actual_runid) {
    command.respawn_delay = kFirstDelay;
    command.actual_runid = command.desired_runid;
    Start(&command, actions);
  } else if (command.spec.auto_respawn) {
    command.respawn_delay = NextDelay(command.respawn_delay, lived);
    command.respawn_at = now + command.respawn_delay;
  }
}

DeputyState::Actions DeputyState::OnStartFailed(const std::string& id,
                                                const std::string& why,
                                                Duration now) {
  const auto found = commands_.find(id);
  WAYMARK_CHECK(found != commands_.end() && found->second.is_starting, id);
  found->second.started = now;
  Actions actions{SayText{id, why + "\n"}};
  Ended(id, kCannotStart, now, &actions);
  return actions;
}

DeputyState::Actions DeputyState::OnExit(std::int32_t pid,
                                         std::int32_t status,
                                         Duration now) {
  Actions actions;
  const auto found = ids_.find(pid);
  if (found == ids_.end()) return actions;
  const std::string id = found->second;
  ids_.erase(found);
  actions.push_back(EndFamily{id, pid});
  Ended(id, status, now, &actions);
  return actions;
}

DeputyState::Actions DeputyState::OnTimer(Duration now) {
  Actions actions;
  for (auto& [id, command] : commands_) {
    if (command.kill_at && *command.kill_at <= now) {
      command.kill_at = now + kKillAgain;
      actions.push_back(SignalFamily{id, command.pid, SIGKILL});
    }
    if (command.respawn_at && *command.respawn_at <= now) {
      ++command.num_respawns;
      Start(&command, &actions);
    }
  }
  return actions;
}

DeputyState::Actions DeputyState::OnQuit(Duration now) {
  Actions actions;
  is_quitting_ = true;
  for (auto& [id, command] : commands_) Stop(&command, now, &actions);
  return actions;
}

std::optional<Duration> DeputyState::next_timer() const {
  std::optional<Duration> next;
  for (const auto& [id, command] : commands_) {
    for (const auto& due : {command.kill_at, command.respawn_at}) {
      if (due && (!next || *due < *next)) next = due;
    }
  }
  return next;
}

bool DeputyState::is_done() const {
  return is_quitting_ &&
         std::none_of(
             commands_.begin(), commands_.end(), [](const auto& entry) {
               return entry.second.is_running();
             });
}

}  // namespace waymark
