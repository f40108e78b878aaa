#include "procman/deployment/deployment_check.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <variant>
#include <vector>

namespace waymark {
namespace {

using RefuseFunction =
    std::function<void(const TextPlace&, const std::string&)>;

std::string Quoted(const std::string& text) {
  return "\"" + text + "\"";
}

std::string LineText(const TextPlace& place) {
  return "line " + std::to_string(place.line);
}

// The names on a way from `name` back to itself, in order; empty where there is
// none. `next_of` gives the names after one.
class Circle {
 public:
  using NextFunction =
      std::function<std::vector<std::string>(const std::string&)>;

  explicit Circle(NextFunction next_of) : next_of_(std::move(next_of)) {}

  std::string Through(const std::string& name) {
    way_.clear();
    return Walk(name) ? Text() : "";
  }

 private:
  bool Walk(const std::string& name) {
    const auto begin = std::find(way_.begin(), way_.end(), name);
    if (begin != way_.end()) {
      way_.erase(way_.begin(), begin);
      way_.push_back(name);
      return true;
    }
    if (done_.count(name) != 0) return false;
    way_.push_back(name);
    for (const std::string& next : next_of_(name)) {
      if (Walk(next)) return true;
    }
    way_.pop_back();
    done_.insert(name);
    return false;
  }

  [[nodiscard]] std::string Text() const {
    std::string text;
    for (const std::string& name : way_) {
      text += (text.empty() ? "" : " -> ") + Quoted(name);
    }
    return text;
  }

  NextFunction next_of_;
  std::vector<std::string> way_;
  std::set<std::string> done_;
};

void CheckCommands(const Deployment& deployment, const RefuseFunction& refuse) {
  std::map<std::string, TextPlace> places;
  for (const DeploymentCommand& command : deployment.commands) {
    if (command.id.find('/') != std::string::npos) {
      refuse(command.place, Quoted(command.id) + ": no '/' in names");
    }
    const auto [before, is_new] = places.emplace(command.id, command.place);
    if (!is_new) {
      refuse(command.place,
             "cmd " + Quoted(command.id) + " is given twice, first in " +
                 LineText(before->second));
    }
  }
  for (const DeploymentCommand& command : deployment.commands) {
    for (const std::string& other : command.depends_on) {
      if (places.count(other) == 0) {
        refuse(command.place,
               "cmd " + Quoted(command.id) + " depends on " + Quoted(other) +
                   ", which there is not");
      }
    }
  }
  Circle circle([&deployment](const std::string& id) {
    return deployment.Find(id)->depends_on;
  });
  for (const DeploymentCommand& command : deployment.commands) {
    const std::string way = circle.Through(command.id);
    if (!way.empty()) {
      refuse(command.place, "commands depend on each other: " + way);
    }
  }
}

bool HasGroup(const Deployment& deployment, const std::string& group) {
  return std::any_of(deployment.commands.begin(),
                     deployment.commands.end(),
                     [&group](const DeploymentCommand& command) {
                       return IsInGroup(command, group);
                     });
}

void CheckTarget(const Deployment& deployment,
                 const ScriptTarget& target,
                 const TextPlace& place,
                 const RefuseFunction& refuse) {
  if (target.kind == ScriptTarget::Kind::kCommand &&
      deployment.Find(target.name) == nullptr) {
    refuse(place, "there is no cmd " + Quoted(target.name));
  }
  if (target.kind == ScriptTarget::Kind::kGroup &&
      !HasGroup(deployment, target.name)) {
    refuse(place,
           "there is no group " + Quoted(target.name) +
               " with commands (of nested ones: \"a/b\")");
  }
}

void CheckScripts(const Deployment& deployment, const RefuseFunction& refuse) {
  std::map<std::string, TextPlace> places;
  for (const DeploymentScript& script : deployment.scripts) {
    const auto [before, is_new] = places.emplace(script.name, script.place);
    if (!is_new) {
      refuse(script.place,
             "script " + Quoted(script.name) + " is given twice, first in " +
                 LineText(before->second));
    }
  }
  for (const DeploymentScript& script : deployment.scripts) {
    for (std::size_t i = 0; i < script.actions.size(); ++i) {
      const ScriptAction& action = script.actions[i];
      const TextPlace& place = script.places[i];
      if (const auto* run = std::get_if<RunScriptAction>(&action)) {
        if (places.count(run->script) == 0) {
          refuse(place, "there is no script " + Quoted(run->script));
        }
      } else if (const auto* start = std::get_if<StartStopAction>(&action)) {
        CheckTarget(deployment, start->target, place, refuse);
      } else if (const auto* wait = std::get_if<WaitStatusAction>(&action)) {
        CheckTarget(deployment, wait->target, place, refuse);
      }
    }
  }
  Circle circle([&deployment](const std::string& name) {
    std::vector<std::string> next;
    for (const ScriptAction& action : deployment.FindScript(name)->actions) {
      if (const auto* run = std::get_if<RunScriptAction>(&action)) {
        next.push_back(run->script);
      }
    }
    return next;
  });
  for (const DeploymentScript& script : deployment.scripts) {
    const std::string way = circle.Through(script.name);
    if (!way.empty()) refuse(script.place, "scripts run each other: " + way);
  }
}

}  // namespace

void CheckDeployment(const Deployment& deployment,
                     const RefuseFunction& refuse) {
  CheckCommands(deployment, refuse);
  CheckScripts(deployment, refuse);
}

}  // namespace waymark
