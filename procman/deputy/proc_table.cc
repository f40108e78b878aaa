#include "procman/deputy/proc_table.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <set>
#include <system_error>

namespace waymark {
namespace {

// Words of `text` between blanks.
std::vector<std::string_view> WordsOf(std::string_view text) {
  std::vector<std::string_view> words;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end =
        std::min(text.find_first_of(" \t\n", begin), text.size());
    if (end > begin) words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

template <typename T>
bool Read(std::string_view word, T* value) {
  const char* end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, *value);
  return result.ec == std::errc() && result.ptr == end;
}

}  // namespace

std::string ReadKernelFile(const std::string& path) {
  std::string text;
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return text;
  std::array<char, 4096> piece;
  ssize_t num = 0;
  while ((num = read(fd, piece.data(), piece.size())) > 0) {
    text.append(piece.data(), static_cast<std::size_t>(num));
  }
  close(fd);
  return text;
}

// proc(5): field 3 is the first behind the name.
std::optional<ProcessStat> ParseProcessStat(std::string_view text) {
  const std::size_t open_at = text.find('(');
  const std::size_t close_at = text.rfind(')');
  if (open_at == std::string_view::npos || close_at == std::string_view::npos ||
      close_at < open_at || open_at < 2) {
    return std::nullopt;
  }
  ProcessStat stat;
  const auto words = WordsOf(text.substr(close_at + 1));
  constexpr std::size_t kFirstField = 3;
  constexpr std::size_t kResident = 24;
  if (words.size() <= kResident - kFirstField || words[0].size() != 1) {
    return std::nullopt;
  }
  const auto field = [&](std::size_t number) {
    return words[number - kFirstField];
  };
  stat.name = std::string(text.substr(open_at + 1, close_at - open_at - 1));
  stat.state = words[0][0];
  if (!Read(text.substr(0, open_at - 1), &stat.pid) ||
      !Read(field(4), &stat.parent) || !Read(field(6), &stat.session) ||
      !Read(field(14), &stat.user_ticks) ||
      !Read(field(15), &stat.system_ticks) ||
      !Read(field(22), &stat.start_ticks) ||
      !Read(field(23), &stat.virtual_bytes) ||
      !Read(field(kResident), &stat.resident_pages)) {
    return std::nullopt;
  }
  return stat;
}

std::vector<ProcessStat> ReadProcesses(const std::string& root) {
  std::vector<ProcessStat> processes;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator(root, error);
       !error && it != std::filesystem::directory_iterator();
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    std::int32_t pid = 0;
    if (!Read(name, &pid)) continue;
    auto stat = ParseProcessStat(ReadKernelFile(root + "/" + name + "/stat"));
    if (stat) processes.push_back(std::move(*stat));
  }
  return processes;
}

std::vector<ProcessStat> DescendantsOf(
    std::int32_t leader, const std::vector<ProcessStat>& processes) {
  std::vector<ProcessStat> found;
  std::set<std::int32_t> family{leader};
  bool has_grown = true;
  while (has_grown) {
    has_grown = false;
    for (const ProcessStat& process : processes) {
      if (family.count(process.pid) != 0 || process.state == 'Z') continue;
      if (family.count(process.parent) == 0 && process.session != leader) {
        continue;
      }
      family.insert(process.pid);
      found.push_back(process);
      has_grown = true;
    }
  }
  return found;
}

std::optional<MachineTicks> ParseMachineTicks(std::string_view text) {
  const auto words = WordsOf(text.substr(0, text.find('\n')));
  std::uint64_t user = 0;
  std::uint64_t nice = 0;
  std::uint64_t system = 0;
  std::uint64_t idle = 0;
  if (words.size() < 5 || words[0] != "cpu" || !Read(words[1], &user) ||
      !Read(words[2], &nice) || !Read(words[3], &system) ||
      !Read(words[4], &idle)) {
    return std::nullopt;
  }
  return MachineTicks{user + nice + system, idle};
}

MachineMemory ParseMachineMemory(std::string_view text) {
  MachineMemory memory;
  const auto words = WordsOf(text);
  constexpr std::int64_t kKib = 1024;
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    std::int64_t* value = words[i] == "MemTotal:"    ? &memory.total_bytes
                          : words[i] == "MemFree:"   ? &memory.free_bytes
                          : words[i] == "SwapTotal:" ? &memory.swap_total_bytes
                          : words[i] == "SwapFree:"  ? &memory.swap_free_bytes
                                                     : nullptr;
    std::int64_t number = 0;
    if (value != nullptr && Read(words[i + 1], &number)) *value = kKib * number;
  }
  return memory;
}

}  // namespace waymark
