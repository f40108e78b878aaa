#include "procman/deployment/deployment_types.h"

#include <algorithm>

namespace waymark {

const DeploymentCommand* Deployment::Find(const std::string& id) const {
  const auto found = std::find_if(
      commands.begin(), commands.end(), [&id](const auto& command) {
        return command.id == id;
      });
  return found == commands.end() ? nullptr : &*found;
}

const DeploymentScript* Deployment::FindScript(const std::string& name) const {
  const auto found =
      std::find_if(scripts.begin(), scripts.end(), [&name](const auto& script) {
        return script.name == name;
      });
  return found == scripts.end() ? nullptr : &*found;
}

bool IsInGroup(const DeploymentCommand& command, const std::string& group) {
  return command.group == group || command.group.starts_with(group + "/");
}

}  // namespace waymark
