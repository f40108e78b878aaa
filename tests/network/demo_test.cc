// The demo as people start it, on one sample: real LCM from end to end.
#include "tests/network/network_test.h"
#include "tests/support/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

class DemoTest : public NetworkTest {
 protected:
  DemoTest()
      : folder_(std::filesystem::path(testing::TempDir()) / "demo_test") {
    std::filesystem::remove_all(folder_);
    // No recordings here: what is played are the samples.
    ::setenv("WAYMARK_DATA", (folder_ / "none").c_str(), 1);
  }
  ~DemoTest() override { std::filesystem::remove_all(folder_); }

  ChildResult RunDemo(const std::vector<std::string>& arguments) const {
    const char* source = std::getenv("WAYMARK_SOURCE");
    std::vector<std::string> all{std::string(source == nullptr ? "." : source) +
                                 "/logs/demo.sh"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--out", (folder_ / "out").string()});
    return RunChild(all);
  }

  std::filesystem::path folder_;
};

TEST_F(DemoTest, PlaysASampleAndWritesTheReport) {
  const ChildResult demo = RunDemo({"zigzag", "--speed", "20"});
  ASSERT_EQ(demo.exit_code, 0) << demo.err << demo.out;
  EXPECT_THAT(demo.out, HasSubstr("zigzag"));
  EXPECT_THAT(demo.out, HasSubstr("report.html"));
  for (const char* file : {"report.html", "report.json", "zigzag.lcm"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / file)) << file;
  }
  const ChildResult evaluated =
      RunChild({BuildPath("bin/waymark-log"),
                "evaluate",
                (folder_ / "out" / "zigzag.lcm").string()});
  EXPECT_EQ(evaluated.exit_code, 0);
  // Everything took part: the filter, the refiner, the recorder.
  EXPECT_THAT(evaluated.out, HasSubstr("online (POSE_SETTLED)"));
  EXPECT_THAT(evaluated.out, testing::ContainsRegex("batch  +[0-9.]+ ±"));
  EXPECT_THAT(evaluated.out, HasSubstr("latency of POSE:"));
}

TEST_F(DemoTest, RefusesWhatItCannotPlay) {
  const ChildResult unknown = RunDemo({"nothing_of_this_name"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("no recording 'nothing_of_this_name'"));
  EXPECT_EQ(RunDemo({"--speed", "fast"}).exit_code, 2);
  EXPECT_EQ(RunDemo({"--bogus"}).exit_code, 2);
}

}  // namespace
}  // namespace waymark
