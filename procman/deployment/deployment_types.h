// What a deployment consists of.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace waymark {

// In a file, both from 1.
struct TextPlace {
  int line = 1;
  int column = 1;
};

// One process on one host.
struct DeploymentCommand {
  std::string id;     // Unique within all deputies.
  std::string group;  // "a/b" of nested groups; empty: none.
  std::string exec;   // See exec_words.h.
  std::string deputy = "localhost";
  bool auto_respawn = false;
  int stop_signal = 2;                  // SIGINT; what is sent first.
  int stop_time_allowed_s = 7;          // SIGKILL after it.
  std::string working_dir;              // Empty: the deputy's.
  int nice = 0;                         // Added to the deputy's, in [0, 19].
  int memory_limit_mb = 0;              // 0: none.
  int max_processes = 0;                // With descendants; 0: any number.
  std::vector<std::string> depends_on;  // Commands that must be ready before.
  // Process whose STATUS says that the command is ready; empty: ready once it
  // runs.
  std::string ready_status;
  TextPlace place;
};

// What an action of a script is about.
struct ScriptTarget {
  enum class Kind : std::uint8_t { kEverything, kCommand, kGroup };
  Kind kind = Kind::kEverything;
  std::string name;
};

enum class WaitFor : std::uint8_t { kRunning, kStopped, kReady };

struct StartStopAction {
  enum class Kind : std::uint8_t { kStart, kStop, kRestart };
  Kind kind = Kind::kStart;
  ScriptTarget target;
  std::optional<WaitFor> wait;
  double timeout_s = 0.0;  // 0: as the one who runs the script says.
};
struct WaitMsAction {
  int wait_ms = 0;
};
struct WaitStatusAction {
  ScriptTarget target;
  WaitFor wait = WaitFor::kRunning;
  double timeout_s = 0.0;
};
struct RunScriptAction {
  std::string script;
};
using ScriptAction = std::
    variant<StartStopAction, WaitMsAction, WaitStatusAction, RunScriptAction>;

struct DeploymentScript {
  std::string name;
  std::vector<ScriptAction> actions;
  std::vector<TextPlace> places;  // Of the actions.
  TextPlace place;
};

struct Deployment {
  std::vector<DeploymentCommand> commands;  // In the order of the file.
  std::vector<DeploymentScript> scripts;

  [[nodiscard]] const DeploymentCommand* Find(const std::string& id) const;
  [[nodiscard]] const DeploymentScript* FindScript(
      const std::string& name) const;
};

// Also within groups of it.
[[nodiscard]] bool IsInGroup(const DeploymentCommand& command,
                             const std::string& group);

}  // namespace waymark
