#include "tests/bench/bench_report.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>

namespace waymark {
namespace {

std::string NumberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string OptionalText(const std::optional<double>& value) {
  return value ? NumberText(*value) : "-";
}

std::string TextOrDash(const std::string& text) {
  return text.empty() ? "-" : text;
}

nlohmann::json NumberJson(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? nlohmann::json(*value)
                                        : nlohmann::json();
}

nlohmann::json TextJson(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

std::vector<std::string> Cells(const BenchRow& row) {
  return {row.id,
          row.name,
          NumberText(row.value),
          row.unit,
          OptionalText(row.published),
          TextOrDash(row.peer),
          OptionalText(row.peer_value),
          OptionalText(row.ratio),
          TextOrDash(row.goal),
          row.holds ? (*row.holds ? "yes" : "no") : "-",
          std::to_string(row.runs)};
}

}  // namespace

std::string BenchTable(const std::vector<BenchRow>& rows) {
  std::vector<std::vector<std::string>> lines = {{"id",
                                                  "name",
                                                  "value",
                                                  "unit",
                                                  "published",
                                                  "peer",
                                                  "peer value",
                                                  "ratio",
                                                  "goal",
                                                  "holds",
                                                  "runs"}};
  for (const BenchRow& row : rows) lines.push_back(Cells(row));
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      widths[i] = std::max(widths[i], line[i].size());
    }
  }
  std::string table;
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      table += line[i];
      if (i + 1 == line.size()) break;
      table.append(widths[i] - line[i].size() + 2, ' ');
    }
    table += '\n';
  }
  return table;
}

std::string BenchJson(const std::vector<BenchRow>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const BenchRow& row : rows) {
    nlohmann::ordered_json item;
    item["id"] = row.id;
    item["name"] = row.name;
    item["value"] = NumberJson(row.value);
    item["unit"] = TextJson(row.unit);
    item["published"] = NumberJson(row.published);
    item["peer"] = TextJson(row.peer);
    item["peer_value"] = NumberJson(row.peer_value);
    item["ratio"] = NumberJson(row.ratio);
    item["goal"] = TextJson(row.goal);
    item["holds"] = row.holds ? nlohmann::json(*row.holds) : nlohmann::json();
    item["runs"] = row.runs;
    list.push_back(item);
  }
  return list.dump(2) + "\n";
}

BenchRow RowOf(const std::string& id,
               const std::string& name,
               double value,
               const std::string& unit,
               std::int64_t runs) {
  BenchRow row;
  row.id = id;
  row.name = name;
  row.value = value;
  row.unit = unit;
  row.runs = runs;
  return row;
}

int RunBenches(int argc,
               char** argv,
               const std::string& area,
               const std::vector<Bench>& benches) {
  CLI::App app("Benchmarks of the area " + area, area + "_bench");
  std::vector<std::string> ids;
  bool full = false;
  bool list = false;
  std::string json_path;
  app.add_option("ID", ids, "Rows to run, or the area; all without");
  app.add_flag("--full", full, "The long form");
  app.add_flag("--list", list, "Print the IDs and what they measure");
  app.add_option("--json", json_path, "Write the rows to this file");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::cerr << area << "_bench: " << e.what() << '\n';
    return 2;
  }
  if (list) {
    for (const Bench& bench : benches) {
      std::cout << bench.id << '\t' << bench.help << '\n';
    }
    return 0;
  }
  std::string known = area;
  for (const Bench& bench : benches) known += ", " + bench.id;
  for (const std::string& id : ids) {
    if (id != area &&
        std::none_of(benches.begin(), benches.end(), [&](const Bench& b) {
          return b.id == id;
        })) {
      std::cerr << area << "_bench: no benchmark '" << id << "'; has " << known
                << '\n';
      return 2;
    }
  }
  std::vector<BenchRow> rows;
  for (const Bench& bench : benches) {
    const bool wanted =
        std::any_of(ids.begin(), ids.end(), [&](const std::string& id) {
          return id == area || id == bench.id;
        });
    if (!ids.empty() && !wanted) continue;
    std::vector<BenchRow> added;
    try {
      added = bench.run(full);
    } catch (const std::exception& error) {
      std::cerr << area << "_bench: " << bench.id << ": " << error.what()
                << '\n';
      return 1;
    }
    rows.insert(rows.end(), added.begin(), added.end());
  }
  std::cout << BenchTable(rows) << std::flush;
  if (!json_path.empty()) {
    std::ofstream out(json_path, std::ios::trunc);
    out << BenchJson(rows) << std::flush;
    if (!out) {
      std::cerr << area << "_bench: --json: cannot write " << json_path << '\n';
      return 2;
    }
  }
  return 0;
}

}  // namespace waymark
