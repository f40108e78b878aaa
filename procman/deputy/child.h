// A command's process, on a terminal of its own.
#pragma once

#include "procman/deployment/exec_words.h"

#include <cstdint>
#include <string>

namespace waymark {

struct ChildOptions {
  std::string id;  // Of the command; in the environment, WAYMARK_COMMAND.
  ExecWords exec;
  std::string working_dir;        // Empty: the caller's.
  int nice = 0;                   // Added to the caller's.
  std::int64_t memory_bytes = 0;  // Address space of each process; 0: no limit.
  int max_processes = 0;          // Of the user, as rlimits count; 0: no limit.
};

struct Child {
  std::int32_t pid = 0;
  int terminal = -1;  // What it prints, to be read and closed by the caller.
  std::string error;  // Why there is none; empty: there is one.
};

// Leader of a session, with stdin, stdout and stderr on a terminal of 80 x 24
// that changes nothing of what is printed. Signals are as a shell would leave
// them. No file of the caller's is open in it.
[[nodiscard]] Child SpawnChild(const ChildOptions& options);

// Processes whose parent has ended become children of this process, from now
// on: to be reaped, and found by what follows.
void AdoptOrphans();

// To the process and all of its command's, also those that have left its
// session or lost their parents. SIGKILL reaches those that are made meanwhile,
// too.
void SignalFamilyOf(std::int32_t pid, const std::string& id, int signal);

// SIGKILL to all that the process, which has ended and was reaped, has left.
void KillLeftFamily(std::int32_t pid, const std::string& id);

}  // namespace waymark
