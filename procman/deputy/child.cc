#include "procman/deputy/child.h"

#include "procman/deputy/proc_table.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <pty.h>  // Also of terminals.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <vector>

namespace waymark {
namespace {

// In the environment of all processes of a command: its id.
constexpr char kCommandVariable[] = "WAYMARK_COMMAND";

// What failed in the child, before its program ran.
struct Failure {
  int step = 0;
  int error = 0;
};
constexpr std::array<const char*, 4> kSteps = {
    "cannot be run", "its working directory", "its limits", "its priority"};

// Whether the process, or who started it, was started as this command.
bool HasMarker(std::int32_t pid, const std::string& id) {
  const std::string all =
      '\0' + ReadKernelFile("/proc/" + std::to_string(pid) + "/environ");
  const std::string marker =
      std::string(1, '\0') + kCommandVariable + "=" + id + '\0';
  return all.find(marker) != std::string::npos;
}

// All processes of a command but its own one, which may have ended: its
// descendants, and those that were left by a parent that has ended. These have
// come to the deputy, wherever else they went.
std::vector<std::int32_t> FamilyOf(std::int32_t pid, const std::string& id) {
  const std::vector<ProcessStat> processes = ReadProcesses();
  std::vector<std::int32_t> family;
  const auto add = [&](std::int32_t leader) {
    for (const ProcessStat& process : DescendantsOf(leader, processes)) {
      family.push_back(process.pid);
    }
  };
  add(pid);
  for (const ProcessStat& process : processes) {
    if (process.parent != getpid() || process.pid == pid ||
        process.state == 'Z' || !HasMarker(process.pid, id)) {
      continue;
    }
    family.push_back(process.pid);
    add(process.pid);
  }
  std::sort(family.begin(), family.end());
  family.erase(std::unique(family.begin(), family.end()), family.end());
  return family;
}

// SIGKILL to `seen` and all their family. Who is stopped makes no more of them,
// and has not lost its children when these are looked for.
void KillAll(std::int32_t pid,
             const std::string& id,
             std::vector<std::int32_t> seen) {
  constexpr int kMostRounds = 20;
  for (const std::int32_t own : seen) kill(own, SIGSTOP);
  for (int round = 0; round < kMostRounds; ++round) {
    bool is_new = false;
    for (const std::int32_t other : FamilyOf(pid, id)) {
      if (std::find(seen.begin(), seen.end(), other) != seen.end()) continue;
      kill(other, SIGSTOP);
      seen.push_back(other);
      is_new = true;
    }
    if (!is_new) break;
  }
  for (const std::int32_t other : seen) kill(other, SIGKILL);
}

[[noreturn]] void Fail(int pipe, int step) {
  const Failure failure{step, errno};
  (void)!write(pipe, &failure, sizeof(failure));
  _exit(255);
}

bool SetLimit(__rlimit_resource resource, rlim_t value) {
  const rlimit limit{value, value};
  return setrlimit(resource, &limit) == 0;
}

// Only what may be called between fork and exec; all memory is there.
[[noreturn]] void RunInChild(const ChildOptions& options,
                             char* const* words,
                             char** environment,
                             int pipe) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (int signal = 1; signal < NSIG; ++signal) {
    if (signal != SIGKILL && signal != SIGSTOP) std::signal(signal, SIG_DFL);
  }
  if (!options.working_dir.empty() && chdir(options.working_dir.c_str()) != 0) {
    Fail(pipe, 1);
  }
  if ((options.memory_bytes > 0 &&
       !SetLimit(RLIMIT_AS, static_cast<rlim_t>(options.memory_bytes))) ||
      (options.max_processes > 0 &&
       !SetLimit(RLIMIT_NPROC, static_cast<rlim_t>(options.max_processes)))) {
    Fail(pipe, 2);
  }
  // Also sockets of libraries that do not close them.
  close_range(3, ~0u, CLOSE_RANGE_CLOEXEC);
  errno = 0;
  if (options.nice != 0 && nice(options.nice) == -1 && errno != 0) {
    Fail(pipe, 3);
  }
  environ = environment;
  execvp(words[0], words);
  Fail(pipe, 0);
}

}  // namespace

Child SpawnChild(const ChildOptions& options) {
  Child child;
  std::vector<std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::string name = text.substr(0, text.find('='));
    bool is_set_anew = name == kCommandVariable;
    for (const auto& [own, value] : options.exec.environment) {
      is_set_anew |= own == name;
    }
    if (!is_set_anew) variables.push_back(text);
  }
  for (const auto& [name, value] : options.exec.environment) {
    variables.push_back(name + "=" + value);
  }
  variables.push_back(std::string(kCommandVariable) + "=" + options.id);
  std::vector<char*> environment;
  for (std::string& text : variables) environment.push_back(text.data());
  environment.push_back(nullptr);
  std::vector<std::string> texts = options.exec.words;
  std::vector<char*> words;
  for (std::string& text : texts) words.push_back(text.data());
  words.push_back(nullptr);

  std::array<int, 2> pipe{-1, -1};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) {
    child.error = std::string("no pipe: ") + std::strerror(errno);
    return child;
  }
  const winsize size{24, 80, 0, 0};
  const pid_t pid = forkpty(&child.terminal, nullptr, nullptr, &size);
  if (pid == 0) {
    termios settings{};
    if (tcgetattr(STDOUT_FILENO, &settings) == 0) {
      settings.c_oflag &= ~static_cast<tcflag_t>(OPOST);
      tcsetattr(STDOUT_FILENO, TCSANOW, &settings);
    }
    RunInChild(options, words.data(), environment.data(), pipe[1]);
  }
  const int error = errno;
  close(pipe[1]);
  if (pid < 0) {
    close(pipe[0]);
    child.error = std::string("no process: ") + std::strerror(error);
    return child;
  }
  child.pid = pid;
  Failure failure;
  ssize_t num = 0;
  do {
    num = read(pipe[0], &failure, sizeof(failure));
  } while (num < 0 && errno == EINTR);
  close(pipe[0]);
  fcntl(child.terminal, F_SETFL, O_NONBLOCK);
  fcntl(child.terminal, F_SETFD, FD_CLOEXEC);
  if (num == static_cast<ssize_t>(sizeof(failure))) {
    child.error = options.exec.words[0] + ": " +
                  kSteps[static_cast<std::size_t>(failure.step)] + ": " +
                  std::strerror(failure.error);
  }
  return child;
}

void SignalFamilyOf(std::int32_t pid, const std::string& id, int signal) {
  if (signal == SIGKILL) {
    KillAll(pid, id, {pid});
    return;
  }
  std::vector<std::int32_t> all = FamilyOf(pid, id);
  all.push_back(pid);
  for (const std::int32_t process : all) kill(process, signal);
  // Who was stopped takes it only once it goes on.
  for (const std::int32_t process : all) kill(process, SIGCONT);
}

void KillLeftFamily(std::int32_t pid, const std::string& id) {
  KillAll(pid, id, {});
}

void AdoptOrphans() {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
}

}  // namespace waymark
