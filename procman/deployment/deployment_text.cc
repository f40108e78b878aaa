#include "procman/deployment/deployment_parser.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <map>

namespace waymark {
namespace {

std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    switch (c) {
      case '\n':
        quoted += "\\n";
        break;
      case '\r':
        quoted += "\\r";
        break;
      case '\t':
        quoted += "\\t";
        break;
      case '"':
      case '\\':
        quoted += '\\';
        [[fallthrough]];
      default:
        quoted += c;
    }
  }
  return quoted + "\"";
}

// What differs from what is assumed without it.
std::string CommandText(const DeploymentCommand& command,
                        const std::string& indent) {
  const DeploymentCommand assumed;
  std::string text = indent + "cmd " + Quoted(command.id) + " {\n";
  const auto add = [&](const char* key, const std::string& value) {
    text += fmt::format("{}  {} = {};\n", indent, key, value);
  };
  const auto add_number = [&](const char* key, int value, int without) {
    if (value != without) add(key, std::to_string(value));
  };
  add("exec", Quoted(command.exec));
  add("deputy", Quoted(command.deputy));
  if (command.auto_respawn) add("auto_respawn", Quoted("true"));
  add_number("stop_signal", command.stop_signal, assumed.stop_signal);
  add_number("stop_time_allowed",
             command.stop_time_allowed_s,
             assumed.stop_time_allowed_s);
  if (!command.working_dir.empty()) {
    add("working_dir", Quoted(command.working_dir));
  }
  add_number("nice", command.nice, assumed.nice);
  add_number(
      "memory_limit_mb", command.memory_limit_mb, assumed.memory_limit_mb);
  add_number("max_processes", command.max_processes, assumed.max_processes);
  std::string others;
  for (const std::string& other : command.depends_on) {
    others += (others.empty() ? "" : " ") + other;
  }
  if (!others.empty()) add("depends_on", Quoted(others));
  if (!command.ready_status.empty()) {
    add("ready_status", Quoted(command.ready_status));
  }
  return text + indent + "}\n";
}

// Commands by group, each where its first command stands.
class Groups {
 public:
  void Add(const DeploymentCommand& command) {
    Groups* at = this;
    std::size_t begin = 0;
    while (begin < command.group.size()) {
      const std::size_t end =
          std::min(command.group.find('/', begin), command.group.size());
      at = at->Inner(command.group.substr(begin, end - begin));
      begin = end + 1;
    }
    at->parts_.push_back({&command, {}});
  }

  [[nodiscard]] std::string Text(const std::string& indent) const {
    std::string text;
    for (const Part& part : parts_) {
      if (part.command != nullptr) {
        text += CommandText(*part.command, indent);
        continue;
      }
      text += indent + "group " + Quoted(part.name) + " {\n" +
              inner_.at(part.name).Text(indent + "  ") + indent + "}\n";
    }
    return text;
  }

 private:
  struct Part {
    const DeploymentCommand* command;
    std::string name;
  };

  Groups* Inner(const std::string& name) {
    if (inner_.count(name) == 0) parts_.push_back({nullptr, name});
    return &inner_[name];
  }

  std::vector<Part> parts_;
  std::map<std::string, Groups> inner_;
};

std::string TargetText(const ScriptTarget& target) {
  switch (target.kind) {
    case ScriptTarget::Kind::kEverything:
      return "everything";
    case ScriptTarget::Kind::kCommand:
      return "cmd " + Quoted(target.name);
    default:
      return "group " + Quoted(target.name);
  }
}

std::string StatusText(WaitFor wait, double timeout_s) {
  std::string text = wait == WaitFor::kRunning   ? "\"running\""
                     : wait == WaitFor::kStopped ? "\"stopped\""
                                                 : "\"ready\"";
  if (timeout_s > 0.0) {
    text += fmt::format(" timeout {}", std::lround(1e3 * timeout_s));
  }
  return text;
}

struct ActionText {
  std::string operator()(const StartStopAction& action) const {
    using Kind = StartStopAction::Kind;
    std::string text = action.kind == Kind::kStart  ? "start "
                       : action.kind == Kind::kStop ? "stop "
                                                    : "restart ";
    text += TargetText(action.target);
    if (action.wait)
      text += " wait " + StatusText(*action.wait, action.timeout_s);
    return text;
  }
  std::string operator()(const WaitMsAction& action) const {
    return fmt::format("wait ms {}", action.wait_ms);
  }
  std::string operator()(const WaitStatusAction& action) const {
    return "wait " + TargetText(action.target) + " status " +
           StatusText(action.wait, action.timeout_s);
  }
  std::string operator()(const RunScriptAction& action) const {
    return "run_script " + Quoted(action.script);
  }
};

}  // namespace

std::string DeploymentText(const Deployment& deployment) {
  Groups groups;
  for (const DeploymentCommand& command : deployment.commands) {
    groups.Add(command);
  }
  std::string text = groups.Text("");
  for (const DeploymentScript& script : deployment.scripts) {
    text += "\nscript " + Quoted(script.name) + " {\n";
    for (const ScriptAction& action : script.actions) {
      text += "  " + std::visit(ActionText{}, action) + ";\n";
    }
    text += "}\n";
  }
  return text;
}

}  // namespace waymark
