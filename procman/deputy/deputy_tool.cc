#include "procman/deputy/deputy_tool.h"

#include "estimation/base/input_error.h"
#include "processes/support/run_tool.h"
#include "procman/deployment/deployment_parser.h"
#include "procman/deputy/deputy.h"

#include <CLI/CLI.hpp>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>

namespace waymark {
namespace {

struct Flags {
  std::string id;
  std::string url;
  std::string deployment;
  bool trusts_network = false;
  bool is_root_allowed = false;
};

std::string HostName() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) return "localhost";
  return name.data();
}

int Run(const Flags& flags) {
  if (geteuid() == 0 && !flags.is_root_allowed) {
    throw InputError(
        "as root it would run commands as root: start it as an ordinary user, "
        "or with --allow-root");
  }
  if (flags.deployment.empty() != flags.trusts_network) {
    throw InputError(
        "either --deployment FILE, whose commands alone are run, or "
        "--trust-network, which runs whatever is ordered");
  }
  DeputyOptions options;
  options.id = flags.id.empty() ? HostName() : flags.id;
  options.lcm_url = flags.url;
  if (flags.trusts_network) {
    std::fprintf(stderr,
                 "waymark-deputy: warning: --trust-network: whoever reaches "
                 "this LCM network can run any command here\n");
  } else {
    options.deployment = ReadDeployment(flags.deployment);
    const auto& commands = options.deployment->commands;
    if (std::none_of(
            commands.begin(), commands.end(), [&](const auto& command) {
              return command.deputy == options.id;
            })) {
      throw InputError(flags.deployment + ": no command for the deputy \"" +
                       options.id + "\" (--id)");
    }
  }
  Deputy deputy(options);
  const int code = deputy.Run();
  if (code == 2) {
    throw InputError("another deputy \"" + options.id +
                     "\" is on this network; use --id");
  }
  return code;
}

}  // namespace

int RunDeputyTool(int argc, char** argv) {
  const auto flags = std::make_shared<Flags>();
  return RunTool(
      argc,
      argv,
      "waymark-deputy",
      "Runs commands on this host as a sheriff orders over LCM (procman).",
      [flags](CLI::App* app, int* exit_code) {
        app->add_option("-i,--id", flags->id, "Its name (the host's)");
        app->add_option("-u,--lcm-url,--lcmurl",
                        flags->url,
                        "LCM network (else LCM_DEFAULT_URL)");
        app->add_option("DEPLOYMENT,--deployment",
                        flags->deployment,
                        "File (.pmd) with what may be run here");
        app->add_flag("--trust-network",
                      flags->trusts_network,
                      "Run whatever is ordered, as stock deputies do");
        app->add_flag("--allow-root", flags->is_root_allowed, "Also as root");
        app->callback([flags, exit_code] { *exit_code = Run(*flags); });
      });
}

}  // namespace waymark
