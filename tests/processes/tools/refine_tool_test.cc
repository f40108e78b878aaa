#include "processes/tools/refine/refine_tool.h"

#include "processes/pose_filter/parameter_file.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

class RefineTool : public testing::Test {
 protected:
  void SetUp() override {
    const char* source = std::getenv("WAYMARK_SOURCE");
    if (source == nullptr) GTEST_SKIP() << "run by ctest";
    samples_ = std::filesystem::path(source) / "logs" / "samples";
  }

  int Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "waymark-refine");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = RunRefineTool(static_cast<int>(argv.size()), argv.data());
    out_ = testing::internal::GetCapturedStdout();
    error_ = testing::internal::GetCapturedStderr();
    return code;
  }
  [[nodiscard]] std::string Sample(const std::string& name) const {
    return (samples_ / (name + ".log")).string();
  }
  static std::string ReadAll(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TemporaryDirectory directory_;
  std::filesystem::path samples_;
  std::string out_;
  std::string error_;
};

TEST_F(RefineTool, FindsTheWheelsOfTwoLogsJointly) {
  const std::string json_path = directory_ / "refined.json";
  const std::string out_path = directory_ / "wheels.yaml";
  ASSERT_EQ(Run({Sample("square"),
                 Sample("zigzag"),
                 "--joint",
                 "--json",
                 json_path,
                 "--out",
                 out_path}),
            0)
      << error_;
  EXPECT_THAT(out_, HasSubstr("wheel_base"));
  const auto json = nlohmann::json::parse(ReadAll(json_path));
  ASSERT_EQ(json.size(), 1u);
  EXPECT_EQ(json[0]["status"], "solved");
  // The samples' README: true k_right 1.00e-4, k_left 1.02e-4, base 0.27.
  const double truth[3] = {1.00e-4, 1.02e-4, 0.27};
  for (std::size_t i = 0; i < 3; ++i) {
    const double sigma = std::sqrt(json[0]["covariance"][4 * i].get<double>());
    EXPECT_NEAR(json[0]["parameters"][i].get<double>(), truth[i], 4.0 * sigma);
  }
  // Fitted lies nearer to the measurements than nominal.
  EXPECT_LT(json[0]["final_cost"], json[0]["nominal_cost"]);
  // pose_filter loads what was written.
  const auto loaded = LoadParameterFile(out_path);
  ASSERT_TRUE(loaded.has_value());
  EXPECT_EQ(loaded->parameters.wheel_base, json[0]["parameters"][2]);
}

TEST_F(RefineTool, SameLogsGiveTheSameBytes) {
  const std::string a = directory_ / "a.json";
  const std::string b = directory_ / "b.json";
  ASSERT_EQ(Run({Sample("scan_matched"), "--json", a}), 0) << error_;
  const std::string out = out_;
  ASSERT_EQ(Run({Sample("scan_matched"), "--json", b}), 0) << error_;
  EXPECT_EQ(out, out_);
  EXPECT_EQ(ReadAll(a), ReadAll(b));
}

TEST_F(RefineTool, BadInputIsOneLine) {
  const auto expect_line = [&](const std::vector<std::string>& arguments,
                               const std::string& part) {
    EXPECT_EQ(Run(arguments), 2) << part;
    EXPECT_THAT(error_, HasSubstr(part));
    EXPECT_EQ(std::count(error_.begin(), error_.end(), '\n'), 1) << error_;
  };
  expect_line({directory_ / "none.log"}, "none.log");
  expect_line({Sample("square"), "--set", "foo=1"}, "unknown key");
  expect_line({Sample("square"), "--set", "nominal=[1,-1,1]"}, "positive");
  expect_line({Sample("square"), Sample("zigzag"), "--out", "x"}, "--joint");
  const std::string exists = directory_ / "exists.json";
  std::ofstream(exists) << "mine";
  expect_line({Sample("square"), "--json", exists}, "exists");
  EXPECT_EQ(ReadAll(exists), "mine");
  const std::string log = directory_ / "square.log";
  std::filesystem::copy_file(Sample("square"), log);
  for (const char* flag : {"--json", "--out"}) {
    expect_line({log, flag, log, "--force"}, "square.log: is an input too");
    EXPECT_EQ(ReadAll(log), ReadAll(Sample("square")));
  }
  const std::string empty = directory_ / "empty.log";
  std::ofstream(empty).close();
  EXPECT_EQ(Run({empty}), 2);
}

}  // namespace
}  // namespace waymark
