// What a grammar does not see. Internal to the parser of deployment files.
#pragma once

#include "procman/deployment/deployment_types.h"

#include <functional>
#include <string>

namespace waymark {

// Calls `refuse`, which does not return, with the first of these: a name given
// twice or unknown, a script that runs itself, commands that depend on each
// other in a circle, a dependency on another that a stock '/' in names spoils.
void CheckDeployment(
    const Deployment& deployment,
    const std::function<void(const TextPlace&, const std::string&)>& refuse);

}  // namespace waymark
