#include "procman/deployment/deployment_parser.h"

#include "estimation/base/whole_file.h"
#include "procman/deployment/deployment_check.h"
#include "procman/deployment/deployment_lexer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr std::size_t kMostBytes = 16 << 20;
// Deeper nesting is a broken file.
constexpr int kMostGroups = 32;
// Of commands, and of scripts.
constexpr std::size_t kMostNames = 4096;
constexpr int kMostMs = 24 * 3600 * 1000;

std::string Lower(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

std::vector<std::string> SplitAtBlanks(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : text + " ") {
    if (c != ' ' && c != '\t' && c != '\n' && c != '\r') {
      word += c;
    } else if (!word.empty()) {
      words.push_back(std::move(word));
      word.clear();
    }
  }
  return words;
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& source)
      : lexer_(text, source), token_(lexer_.Next()) {}

  Deployment File() {
    while (token_.kind != TokenKind::kEnd) {
      if (IsWord("cmd")) {
        Command("");
      } else if (IsWord("group")) {
        Group("", 0);
      } else if (IsWord("script")) {
        Script();
      } else {
        Refuse("cmd, group or script is expected, not " + token_.Described());
      }
    }
    CheckDeployment(deployment_,
                    [this](const TextPlace& place, const std::string& text) {
                      lexer_.Refuse(place, text);
                    });
    return std::move(deployment_);
  }

 private:
  [[noreturn]] void Refuse(const std::string& message) const {
    lexer_.Refuse(token_.place, message);
  }

  Token Take() {
    Token taken = std::move(token_);
    token_ = lexer_.Next();
    return taken;
  }

  [[nodiscard]] bool IsWord(std::string_view word) const {
    return token_.kind == TokenKind::kIdentifier && token_.text == word;
  }

  void Expect(char symbol) {
    if (!token_.Is(symbol)) {
      Refuse(
          fmt::format("'{}' is expected, not {}", symbol, token_.Described()));
    }
    Take();
  }

  // Of a command, a group or a script.
  Token Name(const char* of) {
    if (token_.kind != TokenKind::kString) {
      Refuse(fmt::format(
          "{} needs a name in quotes, not {}", of, token_.Described()));
    }
    if (token_.text.empty()) Refuse(fmt::format("{}: its name is empty", of));
    return Take();
  }

  std::string Text(const Token& attribute) {
    if (token_.kind != TokenKind::kString) {
      Refuse(fmt::format(
          "{} = text in quotes, not {}", attribute.text, token_.Described()));
    }
    return Take().text;
  }

  int Integer(const std::string& what, int min, int max) {
    int value = 0;
    const char* end = token_.text.data() + token_.text.size();
    const bool is_good =
        token_.kind == TokenKind::kInteger &&
        std::from_chars(token_.text.data(), end, value).ec == std::errc() &&
        value >= min && value <= max;
    if (!is_good) {
      Refuse(fmt::format("{}: a whole number from {} to {} is expected, not {}",
                         what,
                         min,
                         max,
                         token_.Described()));
    }
    Take();
    return value;
  }

  bool Flag(const Token& attribute) {
    const Token value = token_;
    const std::string text = Lower(Text(attribute));
    if (text == "true" || text == "yes") return true;
    // Stock sheriffs take all else for false, also what is misspelt.
    if (text == "false" || text == "no") return false;
    lexer_.Refuse(value.place,
                  fmt::format("{} = \"true\" or \"false\", not {}",
                              attribute.text,
                              value.Described()));
  }

  void Attribute(const Token& name, DeploymentCommand* command) {
    const std::string& key = name.text;
    if (key == "exec") {
      command->exec = Text(name);
    } else if (key == "deputy" || key == "host") {
      command->deputy = Text(name);
    } else if (key == "auto_respawn") {
      command->auto_respawn = Flag(name);
    } else if (key == "group") {
      // Nesting says it; stock sheriffs pass over this one, too.
      Text(name);
    } else if (key == "stop_signal") {
      command->stop_signal = Integer(key, 1, 64);
    } else if (key == "stop_time_allowed") {
      command->stop_time_allowed_s = Integer(key, 1, 24 * 3600);
    } else if (key == "working_dir") {
      command->working_dir = Text(name);
    } else if (key == "nice") {
      command->nice = Integer(key, 0, 19);
    } else if (key == "memory_limit_mb") {
      command->memory_limit_mb = Integer(key, 1, 1 << 24);
    } else if (key == "max_processes") {
      command->max_processes = Integer(key, 1, 1 << 22);
    } else if (key == "depends_on") {
      command->depends_on = SplitAtBlanks(Text(name));
    } else if (key == "ready_status") {
      command->ready_status = Text(name);
    } else {
      lexer_.Refuse(
          name.place,
          "unknown attribute " + name.Described() +
              ": exec, deputy, host, auto_respawn, group, stop_signal, "
              "stop_time_allowed, working_dir, nice, memory_limit_mb, "
              "max_processes, depends_on or ready_status");
    }
  }

  void Command(const std::string& group) {
    Take();
    const Token name = Name("cmd");
    DeploymentCommand command;
    command.id = name.text;
    command.group = group;
    command.place = name.place;
    Expect('{');
    std::vector<std::string> given;
    while (!token_.Is('}')) {
      if (token_.kind != TokenKind::kIdentifier) {
        Refuse("an attribute or '}' is expected, not " + token_.Described());
      }
      const Token attribute = Take();
      const std::string key =
          attribute.text == "host" ? "deputy" : attribute.text;
      if (std::find(given.begin(), given.end(), key) != given.end()) {
        lexer_.Refuse(attribute.place,
                      attribute.Described() + " is given twice");
      }
      given.push_back(key);
      Expect('=');
      Attribute(attribute, &command);
      Expect(';');
    }
    Take();
    if (command.exec.empty()) {
      lexer_.Refuse(name.place, "cmd " + name.Described() + " has no exec");
    }
    deployment_.commands.push_back(std::move(command));
    if (deployment_.commands.size() > kMostNames) {
      lexer_.Refuse(name.place, fmt::format("more than {} cmds", kMostNames));
    }
  }

  void Group(const std::string& around, int depth) {
    if (depth == kMostGroups) {
      Refuse(fmt::format("more than {} groups in each other", kMostGroups));
    }
    Take();
    const Token name = Name("group");
    if (name.text.find('/') != std::string::npos) {
      lexer_.Refuse(name.place, name.Described() + ": no '/' in names");
    }
    const std::string group =
        around.empty() ? name.text : around + "/" + name.text;
    Expect('{');
    while (!token_.Is('}')) {
      if (IsWord("cmd")) {
        Command(group);
      } else if (IsWord("group")) {
        Group(group, depth + 1);
      } else {
        Refuse("cmd, group or '}' is expected, not " + token_.Described());
      }
    }
    Take();
  }

  // cmd "name" or group "name".
  ScriptTarget Target() {
    ScriptTarget target;
    if (IsWord("cmd")) {
      target.kind = ScriptTarget::Kind::kCommand;
    } else if (IsWord("group")) {
      target.kind = ScriptTarget::Kind::kGroup;
    } else {
      Refuse("cmd or group is expected, not " + token_.Described());
    }
    const std::string of = Take().text;
    target.name = Name(of.c_str()).text;
    return target;
  }

  std::pair<WaitFor, double> Status() {
    constexpr std::array<std::pair<std::string_view, WaitFor>, 3> kNames{
        {{"running", WaitFor::kRunning},
         {"stopped", WaitFor::kStopped},
         {"ready", WaitFor::kReady}}};
    const auto* found =
        std::find_if(kNames.begin(), kNames.end(), [this](const auto& entry) {
          return token_.kind == TokenKind::kString &&
                 token_.text == entry.first;
        });
    if (found == kNames.end()) {
      Refuse("\"running\", \"stopped\" or \"ready\" is expected, not " +
             token_.Described());
    }
    Take();
    double timeout_s = 0.0;
    if (IsWord("timeout")) {
      Take();
      timeout_s = 1e-3 * Integer("timeout, ms", 1, kMostMs);
    }
    return {found->second, timeout_s};
  }

  StartStopAction StartStop(StartStopAction::Kind kind) {
    Take();
    StartStopAction action;
    action.kind = kind;
    if (IsWord("everything")) {
      Take();
    } else {
      action.target = Target();
    }
    if (IsWord("wait")) {
      Take();
      std::tie(action.wait, action.timeout_s) = Status();
    }
    return action;
  }

  ScriptAction Action() {
    if (IsWord("start")) return StartStop(StartStopAction::Kind::kStart);
    if (IsWord("stop")) return StartStop(StartStopAction::Kind::kStop);
    if (IsWord("restart")) return StartStop(StartStopAction::Kind::kRestart);
    if (IsWord("run_script")) {
      Take();
      return RunScriptAction{Name("run_script").text};
    }
    if (!IsWord("wait")) {
      Refuse("start, stop, restart, wait, run_script or '}' is expected, not " +
             token_.Described());
    }
    Take();
    if (IsWord("ms")) {
      Take();
      return WaitMsAction{Integer("wait ms", 0, kMostMs)};
    }
    WaitStatusAction action;
    action.target = Target();
    if (!IsWord("status")) {
      Refuse("status is expected, not " + token_.Described());
    }
    Take();
    std::tie(action.wait, action.timeout_s) = Status();
    return action;
  }

  void Script() {
    Take();
    const Token name = Name("script");
    DeploymentScript script;
    script.name = name.text;
    script.place = name.place;
    Expect('{');
    while (!token_.Is('}')) {
      script.places.push_back(token_.place);
      script.actions.push_back(Action());
      Expect(';');
    }
    Take();
    deployment_.scripts.push_back(std::move(script));
    if (deployment_.scripts.size() > kMostNames) {
      lexer_.Refuse(name.place,
                    fmt::format("more than {} scripts", kMostNames));
    }
  }

  DeploymentLexer lexer_;
  Token token_;
  Deployment deployment_;
};

}  // namespace

Deployment ParseDeployment(std::string_view text, const std::string& source) {
  return Parser(text, source).File();
}

Deployment ReadDeployment(const std::string& path) {
  return ParseDeployment(ReadWholeFile(path, kMostBytes), path);
}

}  // namespace waymark
