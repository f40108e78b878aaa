// What the kernel says of processes and of the machine.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// Of /proc/PID/stat.
struct ProcessStat {
  std::int32_t pid = 0;
  std::string name;
  char state = '?';
  std::int32_t parent = 0;
  std::int32_t session = 0;
  std::uint64_t user_ticks = 0;  // Of the process itself.
  std::uint64_t system_ticks = 0;
  std::uint64_t start_ticks = 0;  // After the boot: tells a pid used anew.
  std::uint64_t virtual_bytes = 0;
  std::int64_t resident_pages = 0;
};

// Reads behind the last ')': a name may hold blanks and brackets. nullopt where
// that is no such line.
[[nodiscard]] std::optional<ProcessStat> ParseProcessStat(
    std::string_view text);

// All processes of `root`; those that end meanwhile are left out.
[[nodiscard]] std::vector<ProcessStat> ReadProcesses(
    const std::string& root = "/proc");

// Descendants of a session's leader, nearest first, without itself: by their
// parents, and who is still in the session though its parent has ended. Without
// zombies.
[[nodiscard]] std::vector<ProcessStat> DescendantsOf(
    std::int32_t leader, const std::vector<ProcessStat>& processes);

// Of /proc/stat, all processors together.
struct MachineTicks {
  std::uint64_t busy = 0;  // User, nice, system: as procman counts.
  std::uint64_t idle = 0;
};
[[nodiscard]] std::optional<MachineTicks> ParseMachineTicks(
    std::string_view text);

// Of /proc/meminfo.
struct MachineMemory {
  std::int64_t total_bytes = 0;
  std::int64_t free_bytes = 0;
  std::int64_t swap_total_bytes = 0;
  std::int64_t swap_free_bytes = 0;
};
[[nodiscard]] MachineMemory ParseMachineMemory(std::string_view text);

// Of a file of the kernel's; empty where it cannot be read.
[[nodiscard]] std::string ReadKernelFile(const std::string& path);

}  // namespace waymark
