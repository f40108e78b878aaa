#include "processes/tools/experiment/sweep.h"

#include "estimation/base/input_error.h"
#include "processes/support/progress.h"
#include "processes/support/signals.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

namespace waymark {
namespace {

// A run under way in a process of its own.
struct Worker {
  std::uint64_t seed = 0;
  pid_t pid = -1;
  int fd = -1;
  std::string text;  // What it has said so far.
};

RunResult Failed(std::uint64_t seed, const std::string& reason) {
  RunResult result;
  result.seed = seed;
  result.reason = reason;
  return result;
}

// In the child: runs, says what came of it, and ends.
[[noreturn]] void Work(const Experiment& experiment,
                       std::uint64_t seed,
                       int fd) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  RunResult result;
  try {
    result = experiment.Run(seed, "");
    result.seed = seed;
  } catch (const std::exception& error) {
    result = Failed(seed, std::string("fault: ") + error.what());
  }
  const std::string line = LineOfResult(result) + "\n";
  for (std::size_t sent = 0; sent < line.size();) {
    const ssize_t n = write(fd, line.data() + sent, line.size() - sent);
    if (n <= 0) _exit(1);
    sent += static_cast<std::size_t>(n);
  }
  _exit(0);  // No destructor of the parent's runs twice.
}

Worker Start(const Experiment& experiment, std::uint64_t seed) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error(std::strerror(errno));
  std::fflush(nullptr);
  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error(std::strerror(errno));
  if (pid == 0) {
    close(ends[0]);
    Work(experiment, seed, ends[1]);
  }
  close(ends[1]);
  return {seed, pid, ends[0], ""};
}

// After its end of the pipe is closed. nullopt where it crashed.
std::optional<RunResult> ResultOf(const Worker& worker, std::string* crash) {
  int status = 0;
  while (waitpid(worker.pid, &status, 0) < 0 && errno == EINTR) {
  }
  close(worker.fd);
  if (!worker.text.empty() && worker.text.back() == '\n') {
    return ResultOfLine(worker.text.substr(0, worker.text.size() - 1));
  }
  *crash = WIFSIGNALED(status)
               ? std::string("crashed: ") + strsignal(WTERMSIG(status))
               : "crashed";
  return std::nullopt;
}

void Kill(const std::vector<Worker>& workers) {
  for (const Worker& worker : workers) {
    kill(worker.pid, SIGKILL);
    waitpid(worker.pid, nullptr, 0);
    close(worker.fd);
  }
}

// Waits until something was said or a signal came; returns who has ended.
std::vector<Worker> Wait(const Signals& signals, std::vector<Worker>* workers) {
  std::vector<pollfd> fds{{signals.fd(), POLLIN, 0}};
  for (const Worker& worker : *workers) fds.push_back({worker.fd, POLLIN, 0});
  std::vector<Worker> ended;
  if (poll(fds.data(), fds.size(), 200) <= 0) return ended;
  std::vector<Worker> running;
  for (std::size_t i = 0; i < workers->size(); ++i) {
    Worker& worker = (*workers)[i];
    bool has_ended = false;
    if (fds[i + 1].revents != 0) {
      char buffer[4096];
      const ssize_t n = read(worker.fd, buffer, sizeof(buffer));
      if (n > 0) worker.text.append(buffer, static_cast<std::size_t>(n));
      has_ended = n == 0 || (n < 0 && errno != EINTR);
    }
    (has_ended ? ended : running).push_back(worker);
  }
  *workers = running;
  return ended;
}

}  // namespace

SweepReport RunSweep(const Experiment& experiment,
                     const SweepOptions& options,
                     ResultsFile* file) {
  std::vector<std::uint64_t> waiting;  // The next one last.
  for (auto seed = options.seeds.rbegin(); seed != options.seeds.rend();
       ++seed) {
    if (!file->results().contains(*seed)) waiting.push_back(*seed);
  }
  std::map<std::uint64_t, RunResult> crashed;
  SweepReport report;
  {
    const auto total = static_cast<std::int64_t>(options.seeds.size());
    const std::int64_t already =
        total - static_cast<std::int64_t>(waiting.size());
    Progress progress(
        std::string(experiment.name()), total, ProgressUnit::kRuns, already);
    Signals signals;
    std::vector<Worker> workers;
    std::int64_t num_done = already;
    while (!waiting.empty() || !workers.empty()) {
      while (!waiting.empty() &&
             workers.size() < static_cast<std::size_t>(options.num_jobs)) {
        workers.push_back(Start(experiment, waiting.back()));
        waiting.pop_back();
      }
      for (const Worker& worker : Wait(signals, &workers)) {
        std::string crash;
        const std::optional<RunResult> result = ResultOf(worker, &crash);
        // What crashed has not ended, and is tried again by the next sweep.
        if (result) {
          file->Add(*result);
        } else {
          crashed[worker.seed] = Failed(worker.seed, crash);
        }
        ++num_done;
      }
      progress.Show(num_done);
      if (signals.Take()) {
        Kill(workers);
        report.is_complete = false;
        break;
      }
    }
  }
  file->Sort();
  for (const std::uint64_t seed : options.seeds) {
    const auto found = file->results().find(seed);
    if (found != file->results().end()) {
      report.results.push_back(found->second);
    } else if (crashed.contains(seed)) {
      report.results.push_back(crashed[seed]);
      report.has_crashed = true;
    }
  }
  return report;
}

}  // namespace waymark
