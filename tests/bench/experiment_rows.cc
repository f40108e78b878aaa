#include "tests/bench/experiment_rows.h"

#include "processes/support/configuration.h"
#include "processes/tools/experiment/results_file.h"
#include "processes/tools/experiment/sweep.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <thread>

namespace waymark {
namespace {

constexpr char kFolder[] = "out/bench";

// Sets the experiment up; returns its configuration, as text.
std::string Prepare(Experiment* experiment,
                    const std::vector<std::string>& settings) {
  const DescribeFunction describe = [&](Describer& d) {
    experiment->Describe(d);
  };
  for (const std::string& setting : settings) ApplySetting(setting, describe);
  experiment->Prepare();
  return PrintConfiguration(describe) + experiment->Subject();
}

// FNV-1a.
std::uint64_t HashOf(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  }
  return hash;
}

std::string OwnExecutable() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Results of another executable or configuration are removed.
std::string FileOf(const std::string& name, const std::string& subject) {
  std::filesystem::create_directories(kFolder);
  char hash[32];
  std::snprintf(
      hash,
      sizeof(hash),
      "%016llx",
      static_cast<unsigned long long>(HashOf(OwnExecutable() + subject)));
  const std::string file = name + "." + hash + ".jsonl";
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    const std::string other = entry.path().filename().string();
    if (other.starts_with(name + ".") && other.ends_with(".jsonl") &&
        other != file) {
      std::filesystem::remove(entry.path());
    }
  }
  return std::string(kFolder) + "/" + file;
}

}  // namespace

std::vector<double> BenchSweep::Figure(const std::string& name) const {
  std::vector<double> values;
  for (const RunResult& result : results) {
    const auto found = std::find_if(
        result.figures.begin(), result.figures.end(), [&](const auto& figure) {
          return figure.first == name;
        });
    if (found == result.figures.end()) throw std::logic_error("no " + name);
    values.push_back(found->second);
  }
  return values;
}

BenchSweep RunSeeds(Experiment* experiment,
                    const std::vector<std::string>& settings,
                    int num_seeds) {
  Prepare(experiment, settings);
  BenchSweep sweep;
  double simulated_s = 0.0;
  const auto start = std::chrono::steady_clock::now();
  for (int seed = 1; seed <= num_seeds; ++seed) {
    sweep.results.push_back(
        experiment->Run(static_cast<std::uint64_t>(seed), ""));
    simulated_s += sweep.results.back().duration_s;
  }
  const std::chrono::duration<double> took =
      std::chrono::steady_clock::now() - start;
  sweep.summary = SummariseRuns(sweep.results);
  sweep.times_real_time = simulated_s / took.count();
  return sweep;
}

BenchSweep RunSeedsInParts(Experiment* experiment,
                           const std::vector<std::string>& settings,
                           int num_seeds,
                           const std::string& name) {
  const std::string subject = Prepare(experiment, settings);
  SweepOptions options;
  options.seeds.resize(static_cast<std::size_t>(num_seeds));
  std::iota(options.seeds.begin(), options.seeds.end(), std::uint64_t{1});
  options.num_jobs =
      std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  ResultsFile file(FileOf(name, subject), name, subject);
  // Of the runs progress says enough.
  spdlog::set_level(spdlog::level::warn);
  std::fprintf(stderr,
               "%s: %d runs, %zu of them kept from before\n",
               name.c_str(),
               num_seeds,
               file.results().size());
  const SweepReport report = RunSweep(*experiment, options, &file);
  if (!report.is_complete) {
    throw std::runtime_error("interrupted; the same command goes on");
  }
  if (report.has_crashed) throw std::runtime_error("a run of it crashed");
  BenchSweep sweep;
  sweep.results = report.results;
  sweep.summary = SummariseRuns(sweep.results);
  return sweep;
}

BenchRow SweepRow(const std::string& id,
                  const std::string& name,
                  double value,
                  const std::string& unit,
                  const BenchSweep& sweep) {
  BenchRow row;
  row.id = id;
  row.name = name;
  row.value = value;
  row.unit = unit;
  row.runs = sweep.summary.num_runs;
  return row;
}

BenchRow WithGoal(BenchRow row, const std::string& goal, bool holds) {
  row.goal = goal;
  row.holds = holds;
  return row;
}

}  // namespace waymark
