#include "tests/bench/bench_report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <vector>

namespace waymark {
namespace {

BenchRow FullRow() {
  BenchRow row;
  row.id = "Y4";
  row.name = "lines";
  row.value = 20.5;
  row.unit = "x";
  row.published = 15.0;
  row.peer = "OpenCV";
  row.peer_value = 1.0;
  row.ratio = 20.5;
  row.goal = ">= 15";
  row.holds = true;
  row.runs = 30;
  return row;
}

int RunWith(std::vector<std::string> arguments,
            const std::vector<Bench>& benches) {
  arguments.insert(arguments.begin(), "bench");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  return RunBenches(
      static_cast<int>(argv.size()), argv.data(), "line", benches);
}

TEST(BenchJson, AbsentIsNull) {
  BenchRow bare;
  bare.id = "Y1";
  bare.name = "n";
  bare.value = std::nan("");
  const auto list = nlohmann::json::parse(BenchJson({FullRow(), bare}));
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0]["published"], 15.0);
  EXPECT_EQ(list[0]["holds"], true);
  EXPECT_EQ(list[0]["runs"], 30);
  EXPECT_EQ(list[1].size(), 11u);
  for (const char* key : {"value",
                          "unit",
                          "published",
                          "peer",
                          "peer_value",
                          "ratio",
                          "goal",
                          "holds"}) {
    EXPECT_TRUE(list[1][key].is_null()) << key;
  }
}

TEST(BenchTable, ColumnsAreAligned) {
  BenchRow other = FullRow();
  other.name = "a longer name";
  const std::string table = BenchTable({FullRow(), other});
  const auto column = [&](int line, const std::string& text) {
    std::size_t start = 0;
    for (int i = 0; i < line; ++i) start = table.find('\n', start) + 1;
    return table.find(text, start) - start;
  };
  EXPECT_EQ(column(0, "value"), column(1, "20.5"));
  EXPECT_EQ(column(1, "20.5"), column(2, "20.5"));
}

TEST(RunBenches, RunsWhatIsAskedForAndWritesJson) {
  std::vector<std::string> ran;
  const std::vector<Bench> benches = {
      {"A1",
       "",
       [&](bool full) {
         ran.push_back(full ? "A1 full" : "A1");
         return std::vector<BenchRow>{FullRow()};
       }},
      {"A2", "", [&](bool) {
         ran.push_back("A2");
         return std::vector<BenchRow>{};
       }}};
  const std::string path = testing::TempDir() + "bench_report_test.json";
  EXPECT_EQ(RunWith({"A1", "--full", "--json", path}, benches), 0);
  EXPECT_EQ(ran, std::vector<std::string>{"A1 full"});
  std::ifstream file(path);
  EXPECT_EQ(nlohmann::json::parse(file).size(), 1u);
  std::remove(path.c_str());
  EXPECT_EQ(RunWith({"line"}, benches), 0);
  EXPECT_EQ(ran.size(), 3u);
}

TEST(RunBenches, RefusesUnknownIdAndUnwritableFile) {
  const std::vector<Bench> benches = {
      {"A1", "", [](bool) { return std::vector<BenchRow>{}; }}};
  EXPECT_EQ(RunWith({"A7"}, benches), 2);
  EXPECT_EQ(RunWith({"--nonsense"}, benches), 2);
  EXPECT_EQ(RunWith({"--json", "/nowhere/at/all.json"}, benches), 2);
}

}  // namespace
}  // namespace waymark
