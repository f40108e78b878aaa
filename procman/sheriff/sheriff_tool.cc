#include "procman/sheriff/sheriff_tool.h"

#include "estimation/base/input_error.h"
#include "processes/support/run_tool.h"
#include "procman/deployment/deployment_parser.h"
#include "procman/sheriff/sheriff_link.h"
#include "procman/sheriff/sheriff_operator.h"
#include "procman/sheriff/sheriff_table.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

constexpr char kName[] = "waymark-sheriff";

struct Flags {
  std::string url;
  std::string file;
  double timeout_s = 20.0;
  std::vector<std::string> ids;
  std::string group;
  bool is_all = false;
  bool is_json = false;
  std::string script;
  std::string status = "running";
  double for_s = 0.0;
};

int Complain(const std::string& text) {
  std::fprintf(stderr, "%s: %s\n", kName, text.c_str());
  return 1;
}

// One call of the tool: connected, with what the file says.
class Session {
 public:
  Session(const Flags& flags, bool is_observer)
      : flags_(flags), link_({flags.url, is_observer}) {
    if (!flags.file.empty()) {
      deployment_ = ReadDeployment(flags.file);
      link_.state.Load(deployment_);
    }
    link_.on_conflict = [](const std::string& sheriff_id) {
      std::fprintf(stderr,
                   "%s: another sheriff gives orders: %s\n",
                   kName,
                   sheriff_id.c_str());
    };
  }

  // Exit code of `work`, with what is wrong as one line.
  int Run(const std::function<void(SheriffOperator*)>& work) {
    link_.Adopt();
    if (link_.state.deputies().empty()) {
      return Complain(
          "no deputy answers: does waymark-deputy run, on this "
          "LCM network?");
    }
    SheriffOperator sheriff(
        &link_, deployment_, flags_.timeout_s, [](const std::string& line) {
          std::printf("%s\n", line.c_str());
          std::fflush(stdout);
        });
    try {
      work(&sheriff);
    } catch (const SheriffTimeout& e) {
      return Complain(e.what());
    } catch (const std::invalid_argument& e) {
      return Complain(e.what());
    } catch (const std::logic_error& e) {
      return Complain(e.what());
    }
    return 0;
  }

  [[nodiscard]] std::vector<std::string> Named(
      const SheriffOperator& sheriff) const {
    using Kind = ScriptTarget::Kind;
    if (flags_.is_all) return sheriff.Named({Kind::kEverything, ""});
    if (!flags_.group.empty()) {
      return sheriff.Named({Kind::kGroup, flags_.group});
    }
    if (flags_.ids.empty()) {
      throw InputError("which command? Its id, --group NAME or --all");
    }
    std::vector<std::string> ids;
    for (const std::string& id : flags_.ids) {
      for (const std::string& named : sheriff.Named({Kind::kCommand, id})) {
        ids.push_back(named);
      }
    }
    return ids;
  }

  // What has ended though it should run.
  int Failed(const std::vector<std::string>& ids) {
    std::string failed;
    for (const std::string& id : ids) {
      const auto found = link_.state.commands().find(id);
      if (found != link_.state.commands().end() &&
          found->second.status() == CommandStatus::kFailed) {
        failed += (failed.empty() ? "" : ", ") + id + " (" +
                  ExitText(found->second.report->exit_code) + ")";
      }
    }
    return failed.empty() ? 0 : Complain("failed: " + failed);
  }

  SheriffLink& link() { return link_; }
  const Deployment& deployment() const { return deployment_; }

 private:
  const Flags& flags_;
  Deployment deployment_;
  SheriffLink link_;
};

int Change(const Flags& flags, StartStopAction::Kind kind) {
  Session session(flags, false);
  std::vector<std::string> ids;
  const bool is_stop = kind == StartStopAction::Kind::kStop;
  const int code = session.Run([&](SheriffOperator* sheriff) {
    ids = session.Named(*sheriff);
    if (is_stop) {
      sheriff->Stop(ids);
      sheriff->Wait(ids, WaitFor::kStopped, 0.0);
    } else {
      sheriff->Start(ids, kind);
      sheriff->Wait(ids, WaitFor::kRunning, 0.0);
    }
  });
  return code != 0 || is_stop ? code : session.Failed(ids);
}

int Status(const Flags& flags) {
  Session session(flags, true);
  session.link().Adopt();
  const std::string text =
      flags.is_json ? StatusJson(session.link().state)
                    : StatusTable(session.link().state, SheriffLink::Now());
  std::fputs(text.c_str(), stdout);
  return 0;
}

int Load(const Flags& flags) {
  Session session(flags, false);
  return session.Run([&](SheriffOperator*) {
    session.link().Send();
    session.link().Look(1.0);
    std::fputs(StatusTable(session.link().state, SheriffLink::Now()).c_str(),
               stdout);
  });
}

int RunScript(const Flags& flags) {
  if (flags.file.empty()) throw InputError("a script needs --deployment FILE");
  Session session(flags, false);
  const DeploymentScript* script =
      session.deployment().FindScript(flags.script);
  if (script == nullptr) {
    std::string known;
    for (const auto& other : session.deployment().scripts) {
      known += (known.empty() ? "" : ", ") + other.name;
    }
    throw InputError(flags.file + " has no script \"" + flags.script +
                     "\"; it has: " + (known.empty() ? "none" : known));
  }
  return session.Run([&](SheriffOperator* sheriff) { sheriff->Run(*script); });
}

int WaitUntil(const Flags& flags) {
  Session session(flags, true);
  const WaitFor wait = flags.status == "running"   ? WaitFor::kRunning
                       : flags.status == "stopped" ? WaitFor::kStopped
                                                   : WaitFor::kReady;
  return session.Run([&](SheriffOperator* sheriff) {
    sheriff->Wait(session.Named(*sheriff), wait, 0.0);
  });
}

// Until it is interrupted, or for a time.
int Follow(const Flags& flags, bool shows_output) {
  Session session(flags, true);
  SheriffLink& link = session.link();
  const auto is_asked = [&flags](const std::string& id) {
    return flags.ids.empty() ||
           std::find(flags.ids.begin(), flags.ids.end(), id) != flags.ids.end();
  };
  if (shows_output) {
    link.on_output = [&](const std::string& id, const std::string& text) {
      if (!is_asked(id)) return;
      std::fputs(text.c_str(), stdout);
      std::fflush(stdout);
    };
  } else {
    link.on_change = [&] {
      std::printf("%s\n", StatusTable(link.state, SheriffLink::Now()).c_str());
      std::fflush(stdout);
    };
  }
  link.Adopt();
  const Duration end = SheriffLink::Now() + DurationFromSeconds(flags.for_s);
  while (flags.for_s == 0.0 || SheriffLink::Now() < end) link.Look(0.2);
  return 0;
}

}  // namespace

int RunSheriffTool(int argc, char** argv) {
  const auto flags = std::make_shared<Flags>();
  return RunTool(
      argc,
      argv,
      kName,
      "Commands deputies over LCM (procman): what they run is adopted first.",
      [flags](CLI::App* app, int* exit_code) {
        app->require_subcommand(1);
        const auto add = [&](const char* name,
                             const char* help,
                             const std::function<int(const Flags&)>& run) {
          CLI::App* command = app->add_subcommand(name, help);
          command->add_option(
              "-u,--lcm-url", flags->url, "LCM network (else LCM_DEFAULT_URL)");
          command->add_option("-d,--deployment",
                              flags->file,
                              "File (.pmd) with commands and scripts");
          RequireRange(
              command->add_option(
                  "--timeout", flags->timeout_s, "Give up after so long, s"),
              0.1,
              86400.0)
              ->capture_default_str();
          command->callback(
              [flags, run, exit_code] { *exit_code = run(*flags); });
          return command;
        };
        const auto add_named = [&](CLI::App* command) {
          command->add_option("COMMAND", flags->ids, "Ids");
          command->add_option("--group", flags->group, "All of a group");
          command->add_flag("--all", flags->is_all, "All there are");
        };
        using Kind = StartStopAction::Kind;
        add("load", "Makes a file's commands known to its deputies", Load)
            ->get_option("--deployment")
            ->required();
        add_named(add("start",
                      "Starts commands, with what they depend on",
                      [](const Flags& f) { return Change(f, Kind::kStart); }));
        add_named(add("stop", "Stops commands", [](const Flags& f) {
          return Change(f, Kind::kStop);
        }));
        add_named(
            add("restart", "Stops and starts commands", [](const Flags& f) {
              return Change(f, Kind::kRestart);
            }));
        add("status", "Prints what deputies run", Status)
            ->add_flag("--json", flags->is_json, "As JSON");
        add("run", "Runs a script of the file", RunScript)
            ->add_option("SCRIPT", flags->script, "Its name")
            ->required();
        CLI::App* wait =
            add("wait", "Waits until commands are in a state", WaitUntil);
        add_named(wait);
        wait->add_option("--status", flags->status, "running, stopped, ready")
            ->check(CLI::IsMember({"running", "stopped", "ready"}))
            ->capture_default_str();
        CLI::App* output = add("output",
                               "Shows what commands print",
                               [](const Flags& f) { return Follow(f, true); });
        output->add_option("COMMAND", flags->ids, "Ids; all without");
        CLI::App* observe =
            add("observe",
                "Prints the table again whenever it changes",
                [](const Flags& f) { return Follow(f, false); });
        for (CLI::App* command : {output, observe}) {
          RequireRange(
              command->add_option(
                  "--for", flags->for_s, "So long, s (0: until Ctrl-C)"),
              0.0,
              86400.0);
        }
      });
}

}  // namespace waymark
