// main() of every process.
#pragma once

#include "processes/support/process_class.h"

namespace waymark {

// Flags, configuration, bus, loop until SIGINT or SIGTERM, flush. Returns the
// exit code: 0 done; 2 with one line on stderr where flags, configuration, log
// or network cannot be used; 1 with one line where the process failed (a
// handler threw, an offline run was interrupted).
//
//   --config FILE   configuration; without it the shipped <process>.yaml
//                   (../config or ../share/waymark/config beside the
//                   executable's folder), without that the defaults
//   --set A.B=V     one value, after the file; may be repeated
//   --lcm-url URL   live, on this LCM network (else LCM_DEFAULT_URL)
//   --log-in LOG    offline, on a recorded log
//   --log-out LOG   offline: its copy with this process's outputs; --force
//                   replaces a file
//   --check-config  load, check, exit
//   --print-config  all values as YAML
//
// On SIGTERM what has arrived is handled, the process's Finish() called, and
// the last STATUS sent; a second signal skips what still waits.
[[nodiscard]] int RunProcessClass(const ProcessClass& process_class,
                                  int argc,
                                  char** argv);

// P as in process_class.h.
template <typename P>
[[nodiscard]] int RunProcess(int argc, char** argv) {
  return RunProcessClass(MakeProcessClass<P>(), argc, argv);
}

// The configuration shipped for a process with this executable, empty if none.
[[nodiscard]] std::string ShippedConfiguration(const std::string& process);

}  // namespace waymark
