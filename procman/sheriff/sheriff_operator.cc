#include "procman/sheriff/sheriff_operator.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <stdexcept>
#include <utility>
#include <variant>

namespace waymark {
namespace {

constexpr double kLookS = 0.05;
// A process that runs is heard once a second on STATUS.
constexpr Duration kStatusAge = std::chrono::seconds(3);
// Between an action with a wait and the next one.
constexpr double kPauseS = 0.1;

const char* NameOf(WaitFor wait) {
  return wait == WaitFor::kRunning   ? "running"
         : wait == WaitFor::kStopped ? "stopped"
                                     : "ready";
}

}  // namespace

SheriffOperator::SheriffOperator(SheriffLink* link,
                                 const Deployment& deployment,
                                 double timeout_s,
                                 std::function<void(const std::string&)> say)
    : link_(link),
      deployment_(deployment),
      timeout_s_(timeout_s),
      say_(std::move(say)) {}

std::vector<std::string> SheriffOperator::Named(
    const ScriptTarget& target) const {
  std::vector<std::string> ids;
  const auto add = [&](const DeploymentCommand& command) {
    const bool is_meant = target.kind == ScriptTarget::Kind::kEverything ||
                          (target.kind == ScriptTarget::Kind::kCommand
                               ? command.id == target.name
                               : IsInGroup(command, target.name));
    if (is_meant &&
        std::find(ids.begin(), ids.end(), command.id) == ids.end()) {
      ids.push_back(command.id);
    }
  };
  // In the file's order; then what deputies run besides.
  for (const DeploymentCommand& command : deployment_.commands) add(command);
  for (const auto& [id, command] : link_->state.commands()) {
    add(command.command);
  }
  if (ids.empty()) {
    throw std::invalid_argument(
        target.kind == ScriptTarget::Kind::kEverything ? "there are no commands"
        : target.kind == ScriptTarget::Kind::kCommand
            ? "there is no command \"" + target.name + "\""
            : "there is no group \"" + target.name + "\"");
  }
  return ids;
}

std::vector<std::string> SheriffOperator::WithDependencies(
    const std::vector<std::string>& ids) const {
  std::vector<std::string> ordered;
  std::set<std::string> seen;
  // Circles are refused where the file is read.
  const auto add = [&](const std::string& id, const auto& self) -> void {
    if (!seen.insert(id).second) return;
    if (const DeploymentCommand* command = deployment_.Find(id)) {
      for (const std::string& other : command->depends_on) self(other, self);
    }
    ordered.push_back(id);
  };
  for (const std::string& id : ids) add(id, add);
  return ordered;
}

bool SheriffOperator::Is(const std::string& id, WaitFor wait) const {
  const auto found = link_->state.commands().find(id);
  if (found == link_->state.commands().end()) return wait == WaitFor::kStopped;
  const CommandStatus status = found->second.status();
  const bool has_ended =
      status == CommandStatus::kStopped || status == CommandStatus::kFailed;
  if (wait == WaitFor::kStopped) return has_ended;
  // As stock sheriffs have it: what has ended did run.
  if (wait == WaitFor::kRunning) {
    return status == CommandStatus::kRunning || has_ended;
  }
  if (status != CommandStatus::kRunning) return false;
  const DeploymentCommand* command = deployment_.Find(id);
  if (command == nullptr || command->ready_status.empty()) return true;
  const auto heard = link_->heard_status().find(command->ready_status);
  if (heard == link_->heard_status().end()) return false;
  const auto ordered = ordered_.find(id);
  return ordered != ordered_.end()
             ? heard->second > ordered->second
             : SheriffLink::Now() - heard->second < kStatusAge;
}

void SheriffOperator::Wait(const std::vector<std::string>& ids,
                           WaitFor wait,
                           double timeout_s) {
  const double longest = timeout_s > 0.0 ? timeout_s : timeout_s_;
  const Duration end = SheriffLink::Now() + DurationFromSeconds(longest);
  while (true) {
    std::string missing;
    for (const std::string& id : ids) {
      if (!Is(id, wait)) missing += (missing.empty() ? "" : ", ") + id;
    }
    if (missing.empty()) return;
    // Who only looks may wait beside another sheriff.
    if (gives_orders_ && link_->state.is_observer()) {
      throw std::logic_error("another sheriff gives orders: " +
                             link_->state.other_sheriff());
    }
    if (SheriffLink::Now() >= end) {
      throw SheriffTimeout("not " + std::string(NameOf(wait)) +
                           " in time: " + missing);
    }
    link_->Look(kLookS);
  }
}

void SheriffOperator::Start(const std::vector<std::string>& ids,
                            StartStopAction::Kind kind) {
  gives_orders_ = true;
  const std::set<std::string> asked(ids.begin(), ids.end());
  for (const std::string& id : WithDependencies(ids)) {
    const DeploymentCommand* command = deployment_.Find(id);
    if (command != nullptr && !command->depends_on.empty()) {
      Wait(command->depends_on, WaitFor::kReady, 0.0);
    }
    const bool is_restart =
        kind == StartStopAction::Kind::kRestart && asked.count(id) != 0;
    const SheriffCommand& known = link_->state.commands().at(id);
    if (is_restart || !known.is_running() || known.force_quit) {
      ordered_[id] = SheriffLink::Now();
      say_((is_restart ? "restart " : "start ") + id);
    }
    if (is_restart) {
      link_->state.Restart(id);
    } else {
      link_->state.Start(id);
    }
    link_->Send();
  }
}

void SheriffOperator::Stop(const std::vector<std::string>& ids) {
  gives_orders_ = true;
  // What others depend on goes last.
  std::vector<std::string> ordered = WithDependencies(ids);
  std::reverse(ordered.begin(), ordered.end());
  for (const std::string& id : ordered) {
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) continue;
    say_("stop " + id);
    link_->state.Stop(id);
  }
  link_->Send();
}

void SheriffOperator::Run(const DeploymentScript& script) {
  for (const ScriptAction& action : script.actions) {
    if (const auto* change = std::get_if<StartStopAction>(&action)) {
      const std::vector<std::string> ids = Named(change->target);
      if (change->kind == StartStopAction::Kind::kStop) {
        Stop(ids);
      } else {
        Start(ids, change->kind);
      }
      if (change->wait) {
        Wait(ids, *change->wait, change->timeout_s);
        link_->Look(kPauseS);
      }
    } else if (const auto* pause = std::get_if<WaitMsAction>(&action)) {
      link_->Look(1e-3 * pause->wait_ms);
    } else if (const auto* wait = std::get_if<WaitStatusAction>(&action)) {
      Wait(Named(wait->target), wait->wait, wait->timeout_s);
    } else if (const auto* run = std::get_if<RunScriptAction>(&action)) {
      Run(*deployment_.FindScript(run->script));
    }
  }
}

}  // namespace waymark
