#include "processes/tools/experiment/sweep_report.h"

#include "processes/tools/experiment/results_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>
#include <tuple>

namespace waymark {
namespace {

using json = nlohmann::ordered_json;

double Detour(const RunResult& result) {
  return result.shortest_m > 0.0 ? result.way_m / result.shortest_m : 1.0;
}

std::string ShareText(std::int64_t num, std::int64_t of, Interval interval) {
  return fmt::format(
      "{} of {} ({:.1f} %, 95 % in {:.1f} to {:.1f} %)",
      num,
      of,
      of > 0 ? 100.0 * static_cast<double>(num) / static_cast<double>(of) : 0.0,
      100.0 * interval.low,
      100.0 * interval.high);
}

json JsonOf(const Summary& summary) {
  return {{"num", summary.num},
          {"mean", summary.mean},
          {"median", summary.median},
          {"p95", summary.p95},
          {"max", summary.max}};
}

json JsonOf(const Interval& interval) {
  return json::array({interval.low, interval.high});
}

}  // namespace

SweepSummary SummariseRuns(std::span<const RunResult> results) {
  SweepSummary summary;
  std::vector<PathOutcome> outcomes;
  std::vector<double> detours;
  std::vector<double> ways;
  std::vector<double> durations;
  std::vector<std::string> names;  // In the order in which they come first.
  std::map<std::string, std::vector<double>> figures;
  for (const RunResult& result : results) {
    ++summary.num_runs;
    summary.num_touches += result.num_touches;
    summary.num_untouched += result.num_touches == 0 ? 1 : 0;
    outcomes.push_back({result.is_success, result.way_m, result.shortest_m});
    ways.push_back(result.way_m);
    for (const auto& [name, value] : result.figures) {
      if (!figures.contains(name)) names.push_back(name);
      figures[name].push_back(value);
    }
    summary.has_goals = summary.has_goals || result.shortest_m > 0.0;
    if (result.is_success) {
      ++summary.num_successes;
      detours.push_back(Detour(result));
      durations.push_back(result.duration_s);
    } else {
      ++summary.reasons[result.reason];
    }
  }
  summary.success = WilsonInterval(summary.num_successes, summary.num_runs);
  summary.untouched = WilsonInterval(summary.num_untouched, summary.num_runs);
  summary.spl = SuccessWeightedByPathLength(outcomes);
  summary.way_over_shortest = Summarise(detours);
  summary.way_m = Summarise(ways);
  summary.duration_s = Summarise(durations);
  for (const std::string& name : names) {
    summary.figures.emplace_back(name, Summarise(figures[name]));
  }
  return summary;
}

std::vector<std::uint64_t> WorstSeeds(std::span<const RunResult> results,
                                      int num) {
  std::vector<const RunResult*> bad;
  for (const RunResult& result : results) {
    if (!result.is_success || result.num_touches > 0) bad.push_back(&result);
  }
  std::sort(bad.begin(), bad.end(), [](const auto* a, const auto* b) {
    return std::tuple(a->is_success, -a->num_touches, -Detour(*a), a->seed) <
           std::tuple(b->is_success, -b->num_touches, -Detour(*b), b->seed);
  });
  std::vector<std::uint64_t> seeds;
  for (const RunResult* result : bad) {
    if (static_cast<int>(seeds.size()) < num) seeds.push_back(result->seed);
  }
  return seeds;
}

std::string SweepTable(const std::string& name, const SweepSummary& summary) {
  std::string text;
  auto out = std::back_inserter(text);
  fmt::format_to(
      out,
      "{}\n  success        {}\n",
      name,
      ShareText(summary.num_successes, summary.num_runs, summary.success));
  for (const auto& [reason, num] : summary.reasons) {
    fmt::format_to(out, "                 {} x {}\n", num, reason);
  }
  fmt::format_to(
      out,
      "  no touch       {}; {} touches in all\n",
      ShareText(summary.num_untouched, summary.num_runs, summary.untouched),
      summary.num_touches);
  if (summary.has_goals) {
    fmt::format_to(out, "  SPL            {:.3f}\n", summary.spl);
  }
  fmt::format_to(out,
                 "  {:<20} {:>6} {:>10} {:>10} {:>10} {:>10}\n",
                 "",
                 "runs",
                 "mean",
                 "median",
                 "p95",
                 "max");
  const auto row = [&](const std::string& title, const Summary& s) {
    fmt::format_to(out,
                   "  {:<20} {:>6} {:>10.4g} {:>10.4g} {:>10.4g} {:>10.4g}\n",
                   title,
                   s.num,
                   s.mean,
                   s.median,
                   s.p95,
                   s.max);
  };
  if (summary.has_goals) row("way / shortest *", summary.way_over_shortest);
  row("duration_s *", summary.duration_s);
  row("way_m", summary.way_m);
  for (const auto& [title, figure] : summary.figures) row(title, figure);
  text += "  * of the runs with success\n";
  return text;
}

std::string SweepJson(const std::string& name,
                      const std::string& configuration,
                      const SweepSummary& summary,
                      std::span<const RunResult> results) {
  json figures = json::object();
  for (const auto& [title, figure] : summary.figures) {
    figures[title] = JsonOf(figure);
  }
  json runs = json::array();
  for (const RunResult& result : results) {
    runs.push_back(json::parse(LineOfResult(result)));
  }
  const json report{{"experiment", name},
                    {"num_runs", summary.num_runs},
                    {"num_successes", summary.num_successes},
                    {"success_95", JsonOf(summary.success)},
                    {"reasons", summary.reasons},
                    {"num_touches", summary.num_touches},
                    {"num_untouched", summary.num_untouched},
                    {"untouched_95", JsonOf(summary.untouched)},
                    {"spl", summary.spl},
                    {"way_over_shortest", JsonOf(summary.way_over_shortest)},
                    {"duration_s", JsonOf(summary.duration_s)},
                    {"way_m", JsonOf(summary.way_m)},
                    {"figures", figures},
                    {"configuration", configuration},
                    {"runs", runs}};
  return report.dump(2) + "\n";
}

}  // namespace waymark
