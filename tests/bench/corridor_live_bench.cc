// ./run demo corridor, live: does everything keep up, and how late are answers?
#include "tests/bench/bench_report.h"
#include "tests/support/child_process.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <regex>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

struct LiveDrive {
  nlohmann::json figures;  // Of waymark-log evaluate.
  double rate_hz = 0.0;
  int num_left_out = 0;  // By the camera, since they would have been late.
};

std::optional<LiveDrive> Drive(const std::string& task) {
  namespace fs = std::filesystem;
  // Of this build, wherever it is.
  const fs::path build =
      fs::read_symlink("/proc/self/exe").parent_path().parent_path();
  ::setenv("WAYMARK_BUILD", build.c_str(), 0);
  const fs::path folder =
      fs::temp_directory_path() / ("waymark_bench_corridor_" + task);
  std::fprintf(stderr, "corridor-live: %s\n", task.c_str());
  const ChildResult demo =
      RunChild({std::string(WAYMARK_SOURCE) + "/procman/demo_corridor.sh",
                "--task",
                task,
                "--out",
                folder.string()});
  const ChildResult evaluated = RunChild({(build / "bin/waymark-log").string(),
                                          "evaluate",
                                          (folder / "corridor.lcm").string(),
                                          "--json",
                                          "-"});
  fs::remove_all(folder);
  std::smatch found;
  const std::regex line(
      R"(camera:  ([0-9.]+) Hz of [0-9.]+ asked for, [0-9]+ images, ([0-9]+) left out)");
  if (demo.exit_code != 0 || evaluated.exit_code != 0 ||
      !std::regex_search(demo.out, found, line)) {
    std::fprintf(stderr, "corridor-live: %s", demo.err.c_str());
    return std::nullopt;
  }
  return LiveDrive{nlohmann::json::parse(evaluated.out),
                   std::stod(found[1]),
                   std::stoi(found[2])};
}

std::vector<BenchRow> RowsOf(const std::string& task, const LiveDrive& drive) {
  const auto& sight = drive.figures["health"]["sight"];
  const auto& corridor = drive.figures["corridor"];
  const int num = sight["num_images"];
  std::vector<BenchRow> rows;
  const auto add = [&](const std::string& what,
                       double value,
                       const std::string& unit,
                       const std::string& goal,
                       std::optional<bool> holds) {
    BenchRow row;
    row.id = "Y17";
    row.name = "live, " + task + ": " + what;
    row.value = value;
    row.unit = unit;
    row.goal = goal;
    row.holds = holds;
    row.runs = num;
    rows.push_back(row);
  };
  // One in a hundred may be left out where the goal is all of them.
  add("images", drive.rate_hz, "Hz", ">= 15", drive.rate_hz >= 14.85);
  const int num_lost = sight["num_lost"].get<int>() +
                       sight["num_unanswered"].get<int>() + drive.num_left_out;
  add("images left out, lost or without an answer",
      num_lost,
      "",
      "0",
      num_lost == 0);
  // The exposure, and 50 ms that a camera takes, are in both.
  add("exposure to CORRIDOR_POSE, p95",
      sight["to_answer"]["p95_ms"],
      "ms",
      "",
      std::nullopt);
  const double to_pose = sight["to_pose"]["p95_ms"];
  add("exposure to the next POSE, p95", to_pose, "ms", "< 80", to_pose < 80.0);
  const double took = corridor["lines"]["median_ms"].get<double>() +
                      corridor["pose"]["median_ms"].get<double>();
  add("lines and pose of an image, median", took, "ms", "", std::nullopt);
  rows.back().published = 75.0;  // 50 to 100, on 500 to 1200 MHz.
  return rows;
}

// No rows where LCM has no network.
std::vector<BenchRow> BenchLive(bool full) {
  std::vector<BenchRow> rows;
  std::vector<std::string> tasks{"turns"};
  if (full) tasks.insert(tasks.end(), {"zigzag", "blind", "learn"});
  for (const std::string& task : tasks) {
    const auto drive = Drive(task);
    if (!drive) continue;
    for (BenchRow& row : RowsOf(task, *drive)) rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  return waymark::RunBenches(
      argc,
      argv,
      "corridor_live",
      {{"Y17",
        "./run demo corridor: rate, loss and latency, live, 1 min a task",
        waymark::BenchLive}});
}
