// Deployment files: refused in one line, or read to what can be written and
// read again; exec strings split or refused.
#include "procman/deployment/deployment_parser.h"
#include "procman/deployment/exec_words.h"
#include "tests/fuzz/fuzz_target.h"

#include <optional>
#include <stdexcept>

namespace waymark::fuzz {

void RunOne(Bytes data) {
  Deployment deployment;
  const bool taken = TakesOrRefuses(
      [&] { deployment = ParseDeployment(Text(data), "fuzz.pmd"); });
  if (!taken) return;
  const std::string text = DeploymentText(deployment);
  Expect(DeploymentText(ParseDeployment(text, "written.pmd")) == text,
         "what is written is read to the same");
  for (const DeploymentCommand& command : deployment.commands) {
    Expect(!command.id.empty() && !command.exec.empty(), "it can be run");
    try {
      const ExecWords exec = SplitExec(command.exec, [](std::string_view name) {
        return name.size() % 2 == 0 ? std::optional<std::string>("$A ${B}")
                                    : std::nullopt;
      });
      Expect(!exec.words.empty() && !exec.words[0].empty(), "a program");
    } catch (const std::invalid_argument&) {
    }
  }
}

std::vector<std::string> Seeds() {
  return {
      "cmd \"a\" { exec = \"A=1 run '$B' ${C}\"; deputy = \"robot\"; "
      "auto_respawn = \"true\"; stop_signal = 15; stop_time_allowed = 3; }",
      "group \"g\" { group \"h\" { cmd \"a\" { exec = \"x\"; nice = 3; "
      "working_dir = \"/\"; memory_limit_mb = 9; max_processes = 4; } "
      "cmd \"b\" { exec = \"y\"; depends_on = \"a\"; ready_status = \"z\"; "
      "} } }\nscript \"s\" { start group \"g/h\" wait \"running\"; wait ms "
      "5; wait cmd \"a\" status \"ready\" timeout 7; restart cmd \"b\"; "
      "stop everything wait \"stopped\"; run_script \"t\"; }\nscript \"t\" "
      "{ }",
      "# nothing\n"};
}

}  // namespace waymark::fuzz
