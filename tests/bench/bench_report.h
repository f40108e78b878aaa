// Frame of every benchmark executable: arguments, rows, table and JSON.
//
//   int main(int argc, char** argv) {
//     return waymark::RunBenches(argc, argv, "odometry",
//                                {{"Y23", "what it measures", BenchY23}});
//   }
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

// One measured figure. What is absent becomes null in JSON and '-' in the
// table.
struct BenchRow {
  std::string id;    // Row of SEEDS.md, for example "Y23".
  std::string name;  // What was measured, within the row.
  double value = 0.0;
  std::string unit;
  std::optional<double> published;   // The seed's figure, same unit.
  std::string peer;                  // What ran beside it.
  std::optional<double> peer_value;  // Measured in the same run, same unit.
  // How many times better than the peer: 2 = twice as fast, half the error.
  std::optional<double> ratio;
  std::string goal;           // For example "<= 1.2".
  std::optional<bool> holds;  // Whether the goal is reached.
  std::int64_t runs = 0;      // Repetitions, frames or seeds behind the value.
};

[[nodiscard]] BenchRow RowOf(const std::string& id,
                             const std::string& name,
                             double value,
                             const std::string& unit,
                             std::int64_t runs);

struct Bench {
  std::string id;
  std::string help;
  // `full` asks for the long form (--full).
  std::function<std::vector<BenchRow>(bool full)> run;
};

// Arguments: [ID or area...] --full --json FILE --list. Without IDs all run.
// Prints the table on stdout and writes the JSON list. Returns 0; 2 with one
// line for bad arguments, for an ID that none of `benches` has, or for a file
// that cannot be written; 1 where a benchmark throws. A goal that is missed is
// a row, not an error.
[[nodiscard]] int RunBenches(int argc,
                             char** argv,
                             const std::string& area,
                             const std::vector<Bench>& benches);

[[nodiscard]] std::string BenchTable(const std::vector<BenchRow>& rows);
[[nodiscard]] std::string BenchJson(const std::vector<BenchRow>& rows);

}  // namespace waymark
