// The demo as people start it, on one sample: real LCM from end to end.
#include "tests/network/network_test.h"
#include "tests/support/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
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

  ChildResult RunDemo(const std::vector<std::string>& arguments,
                      const std::string& script = "logs/demo.sh") const {
    const char* source = std::getenv("WAYMARK_SOURCE");
    std::vector<std::string> all{std::string(source == nullptr ? "." : source) +
                                 "/" + script};
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

// A robot in a room of the test's own, 1.5 m there and back.
TEST_F(DemoTest, DrivesASimulatedRobotAndWritesReportPlanAndRecording) {
  std::filesystem::create_directories(folder_);
  const std::string world = (folder_ / "room.yaml").string();
  std::ofstream(world)
      << "rooms:\n"
         "  - {name: room, rectangle: [0, 0, 6, 4], lamps: [1, 1]}\n"
         "starts: [[1, 2, 0]]\n"
         "routes:\n"
         "  short: [[1, 2], [2.5, 2]]\n";
  const std::string camera = (folder_ / "camera.yaml").string();
  std::ofstream(camera) << "{model: perspective, width: 160, height: 120, "
                           "fx: 120, fy: 120, cx: 79.5, cy: 59.5, "
                           "mounting: {x: 0.1, z: 0.5}}\n";
  const ChildResult demo =
      RunDemo({"--world", world, "--route", "short", "--camera", camera},
              "procman/demo_drive.sh");
  ASSERT_EQ(demo.exit_code, 0) << demo.err << demo.out;
  // The rate as it was recorded, and what was left out.
  EXPECT_THAT(demo.out,
              testing::ContainsRegex("camera:  [0-9.]+ Hz of 15 asked for, "
                                     "[0-9]+ images, [0-9]+ left out"));
  const std::filesystem::path out = folder_ / "out";
  for (const char* file : {"drive.html", "drive.png", "drive.lcm"}) {
    ASSERT_TRUE(std::filesystem::exists(out / file)) << file;
    EXPECT_GT(std::filesystem::file_size(out / file), 1000u) << file;
  }
  std::ostringstream report;
  report << std::ifstream(out / "drive.html").rdbuf();
  EXPECT_THAT(report.str(), HasSubstr("alt=\"The plan, with the paths\""));
  EXPECT_THAT(report.str(), HasSubstr("alt=\"IMAGE_FRONT, 0.0 s\""));
  const ChildResult info = RunChild(
      {BuildPath("bin/waymark-log"), "info", (out / "drive.lcm").string()});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("no damage"));
  for (const char* channel : {"TRUTH", "POSE", "RANGES", "TASK_STATUS"}) {
    EXPECT_THAT(info.out, HasSubstr(channel));
  }
}

// In a corridor of the test's own, 2 m there and back.
TEST_F(DemoTest, DrivesInACorridorByItsLines) {
  std::filesystem::create_directories(folder_);
  const std::string world = (folder_ / "corridor.yaml").string();
  std::ofstream(world)
      << "rooms:\n"
         "  - {name: corridor, rectangle: [0, 0, 12, 2], height: 2.5,\n"
         "     floor: grey, walls: white, lamps: [4, 1]}\n"
         "materials:\n"
         "  grey: {pattern: plaster, color: [150, 142, 130]}\n"
         "  white: {pattern: paint, color: [222, 220, 212]}\n"
         "starts: [[1.5, 1, 0]]\n";
  const std::string corridors = (folder_ / "corridors.yaml").string();
  std::ofstream(corridors)
      << "corridors:\n"
         "  - {name: corridor, width: 2, height: 2.5, skirting_height: 0.08, "
         "skirting_depth: 0.012, x: [0, 12], axis_W: [0, 1, 0]}\n";
  const std::string camera = (folder_ / "camera.yaml").string();
  std::ofstream(camera) << "{model: perspective, width: 320, height: 240, "
                           "fx: 230, fy: 230, cx: 159.5, cy: 119.5, "
                           "mounting: {x: 0.1, z: 0.6}}\n";
  const ChildResult demo = RunDemo({"--world",
                                    world,
                                    "--corridors",
                                    corridors,
                                    "--camera",
                                    camera,
                                    "--length",
                                    "2"},
                                   "procman/demo_corridor.sh");
  ASSERT_EQ(demo.exit_code, 0) << demo.err << demo.out;
  // While it drives, and in the end.
  EXPECT_THAT(demo.out,
              testing::ContainsRegex("way-points, .* m left; [0-9]+ of [0-9]+ "
                                     "images.*, off by [0-9.]+ cm"));
  EXPECT_THAT(demo.out, HasSubstr("Across the corridor"));
  EXPECT_THAT(demo.out, HasSubstr("camera:  "));
  const std::filesystem::path out = folder_ / "out";
  for (const char* file : {"corridor.html", "corridor.png", "corridor.lcm"}) {
    ASSERT_TRUE(std::filesystem::exists(out / file)) << file;
    EXPECT_GT(std::filesystem::file_size(out / file), 1000u) << file;
  }
  const ChildResult evaluated = RunChild({BuildPath("bin/waymark-log"),
                                          "evaluate",
                                          (out / "corridor.lcm").string(),
                                          "--json",
                                          "-"});
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.err;
  const auto figures = nlohmann::json::parse(evaluated.out);
  const auto& corridor = figures["corridor"];
  EXPECT_GT(corridor["num"], 20);
  // It turns on the spot at the far end and sees no corridor meanwhile.
  EXPECT_GT(corridor["accepted_share"], 0.5);
  // As the corridor system's tasks ask for.
  EXPECT_LT(corridor["fused"]["y"]["max_m"], 0.03);
  EXPECT_EQ(figures["health"]["sight"]["channel"], "IMAGE_FRONT");
  EXPECT_GT(figures["health"]["sight"]["to_answer"]["median_ms"], 0.0);
}

TEST_F(DemoTest, RefusesATaskThatIsNotThere) {
  const ChildResult demo =
      RunDemo({"--task", "sideways"}, "procman/demo_corridor.sh");
  EXPECT_EQ(demo.exit_code, 2);
  EXPECT_THAT(demo.err, HasSubstr("'sideways' is none of turns"));
  // A world that is no corridor.
  EXPECT_EQ(
      RunDemo({"--world", "office_u"}, "procman/demo_corridor.sh").exit_code,
      2);
}

TEST_F(DemoTest, RefusesARouteThatIsNotThere) {
  const ChildResult demo = RunDemo(
      {"--world", "office_u", "--route", "nowhere"}, "procman/demo_drive.sh");
  EXPECT_EQ(demo.exit_code, 2);
  EXPECT_THAT(demo.err, HasSubstr("has no route nowhere"));
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
