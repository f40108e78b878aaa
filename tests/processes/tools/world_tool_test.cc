#include "processes/tools/world/world_tool.h"

#include "drivers/simulator/build_scene.h"
#include "processes/convert/world_file.h"
#include "processes/tools/world/plan_drawing.h"
#include "processes/tools/world/world_check.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <fstream>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kYaml =
    "rooms:\n"
    "  - {name: hall, rectangle: [0, 0, 5, 4], walls: brick, floor: tiles}\n"
    "people:\n"
    "  - {motion: stand, at: [3, 2], heading_deg: 180}\n"
    "starts: [[1, 2, 0]]\n"
    "places: {end: [4, 1, 90]}\n";

class WorldTool : public testing::Test {
 protected:
  WorldTool() { std::ofstream(world_) << kYaml; }

  int Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "waymark-world");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const int code = RunWorldTool(static_cast<int>(argv.size()), argv.data());
    error_ = testing::internal::GetCapturedStderr();
    output_ = testing::internal::GetCapturedStdout();
    return code;
  }

  TemporaryDirectory folder_;
  std::string world_ = folder_ / "w.yaml";
  std::string error_;
  std::string output_;
};

TEST_F(WorldTool, RendersImageDepthSurfacesAndEdges) {
  const std::string at = folder_ / "";
  ASSERT_EQ(Run({"render",
                 world_,
                 "--pose=1,2,0",
                 "--quality=live",
                 "--out=" + at + "a.png",
                 "--depth=" + at + "d.png",
                 "--surfaces=" + at + "s.png",
                 "--edges=" + at + "e.png"}),
            0)
      << error_;
  const cv::Mat image = cv::imread(at + "a.png");
  EXPECT_EQ(image.cols, 640);
  const cv::Mat depth = cv::imread(at + "d.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(depth.type(), CV_16UC1);
  // The person at x = 3 from a camera at x = 1.1, then the wall at x = 5.
  double nearest = 0.0;
  cv::minMaxLoc(depth(cv::Rect(300, 200, 40, 40)), &nearest);
  EXPECT_NEAR(nearest, 1800, 150);
  EXPECT_NEAR(depth.at<std::uint16_t>(240, 100), 4200, 300);
  EXPECT_EQ(cv::imread(at + "s.png").size(), image.size());
  EXPECT_EQ(cv::imread(at + "e.png").size(), image.size());
  // What is there is not overwritten.
  EXPECT_EQ(Run({"render", world_, "--out=" + at + "a.png"}), 2);
  EXPECT_THAT(error_, HasSubstr("a.png"));
}

TEST_F(WorldTool, ListsTheWorldsThatComeWithIt) {
  ASSERT_EQ(Run({"list"}), 0) << error_;
  EXPECT_THAT(output_,
              HasSubstr("office_u             18 x 9 m   A U-shaped hallway "
                        "with a pillar, and three offices.\n"));
  EXPECT_THAT(output_, HasSubstr("t_corridors          15 x 12 m "));
}

// Kind, name, pose: scripts take the second word for the name.
TEST_F(WorldTool, InfoHasOneWordForEachName) {
  ASSERT_EQ(Run({"info", world_}), 0) << error_;
  EXPECT_THAT(output_, HasSubstr("start 0 1,2,0\n"));
  EXPECT_THAT(output_, HasSubstr("\nplace end "));
}

TEST_F(WorldTool, ChecksStartsPlacesAndBrightness) {
  EXPECT_EQ(Run({"check", world_, "-v"}), 0) << output_;
  EXPECT_THAT(output_, HasSubstr("good: start 0, 0 deg, perspective: mean"));
  EXPECT_THAT(output_, HasSubstr("good: end, 90 deg, mirror: mean grey"));
  // Without light.
  std::ofstream(world_) << "rooms:\n"
                           "  - {name: a, rectangle: [0, 0, 5, 4], light: 0}\n"
                           "ambient: 0\n"
                           "starts: [[1, 2, 0]]\n";
  EXPECT_EQ(Run({"check", world_}), 1);
  EXPECT_THAT(output_, HasSubstr("BAD: start 0, 0 deg, perspective: mean"));
}

TEST_F(WorldTool, CheckNamesWhatIsWhereItCannotBe) {
  std::ofstream(world_)
      << "rooms:\n"
         "  - {name: hall, rectangle: [0, 0, 5, 4]}\n"
         "furniture:\n"
         "  - {kind: box, at: [100, 2]}\n"
         "  - {kind: cabinet, at: [4.9, 3]}\n"
         "  - {kind: table, at: [3, 3.4], size: [0.8, 1.2, 0.74]}\n"
         "people:\n"
         "  - {motion: stand, at: [-3, 2]}\n"
         "  - {motion: walk, path: [[1, 1], [9, 1]]}\n"
         "  - {motion: walk, path: [[3, 1], [3, 3.7]]}\n"
         "  - {motion: walk, path: [[1, 1], [4, 1]]}\n"
         "starts: [[1, 2, 0]]\n"
         "routes: {below: [[1, 2], [3, 3.4]]}\n";
  EXPECT_EQ(Run({"check", world_}), 1);
  for (const char* line :
       {":4: furniture[0] (box): is outside of all rooms, or in a wall, at x "
        "99",
        ":5: furniture[1] (cabinet): is outside of all rooms, or in a wall, at "
        "x 5",
        ":8: people[0] (person 1): at: is outside of all rooms, or in a wall, "
        "at x -3",
        ":9: people[1] (person 2): path: is outside of all rooms",
        ":10: people[2] (person 3): path: is in furniture[2] (table), at x 3",
        ": routes (below): is in furniture[2] (table), at x 3.00, y 3.40"}) {
    EXPECT_THAT(output_, HasSubstr(line));
  }
  EXPECT_THAT(output_, Not(HasSubstr("furniture[2] (table): ")));
  EXPECT_THAT(output_, Not(HasSubstr("people[3]")));
}

// Each once, with its field and what is in the way; its views say nothing.
TEST_F(WorldTool, CheckNamesWhatIsInTheWayOfAStart) {
  std::ofstream(world_) << "rooms:\n"
                           "  - {name: hall, rectangle: [0, 0, 5, 4]}\n"
                           "pillars:\n"
                           "  - {at: [1, 2], size: 0.5}\n"
                           "furniture:\n"
                           "  - {kind: cabinet, at: [3, 2], "
                           "size: [0.5, 1, 1.8]}\n"
                           "starts: [[1.1, 2, 0], [2.6, 2, 0]]\n"
                           "places: {far: [40, 1, 90], low: [0.1, 1, 0]}\n";
  EXPECT_EQ(Run({"check", world_}), 1);
  for (const char* line :
       {": starts[0]: is in pillars[0], at x 1.10, y 2.00\n",
        ": starts[1]: is 0.15 m from furniture[0] (cabinet) at x 2.60, y 2.00, "
        "needs 0.25 m\n",
        ": places (far): is outside of all rooms, or in a wall, at x 40.00, y "
        "1.00\n",
        ": places (low): is 0.09 m from a wall, door or model at x 0.10, y "
        "1.00, needs 0.25 m\n"}) {
    EXPECT_THAT(output_, HasSubstr(line));
  }
  EXPECT_THAT(output_, Not(HasSubstr("mean grey")));
}

TEST_F(WorldTool, RefusesBadInputInOneLine) {
  const std::string out = "--out=" + (folder_ / "x.png");
  EXPECT_EQ(Run({"render", "no_world", out}), 2);
  EXPECT_THAT(error_, HasSubstr("'no_world' is neither"));
  EXPECT_EQ(Run({"render", world_, out, "--camera=eye"}), 2);
  EXPECT_EQ(Run({"render", world_, out, "--pose=1,2"}), 2);
  EXPECT_EQ(Run({"render", world_, "--out=x.gif"}), 2);
  EXPECT_THAT(error_, HasSubstr("must end in .png or .jpg"));
  EXPECT_EQ(Run({"render",
                 world_,
                 out,
                 "--depth=" + (folder_ / "d.png"),
                 "--edges=" + (folder_ / "./x.png")}),
            2);
  EXPECT_THAT(error_, HasSubstr("x.png: is that of --out too"));
  EXPECT_EQ(Run({"plan", world_, out, "--pixels=3"}), 2);
  EXPECT_EQ(Run({}), 2);
}

TEST(PlanDrawing, ShowsFloorsWallsAndPeopleToScale) {
  const World world = WorldFromYaml(kYaml, "w.yaml");
  PlanOptions options;
  options.pixels = 640;
  const cv::Mat3b plan = DrawPlan(world, BuildScene(world), options);
  // 5 x 4 m with 70 pixels around: 100 pixels a metre, north up; below it a
  // legend of one row.
  ASSERT_EQ(plan.cols, 640);
  ASSERT_EQ(plan.rows, 558);
  const auto at = [&](double x, double y) {
    return plan(static_cast<int>(470 - 100 * y),
                static_cast<int>(70 + 100 * x));
  };
  EXPECT_EQ(at(2.55, 3.55), cv::Vec3b(255, 255, 255));  // Floor.
  EXPECT_EQ(at(-0.6, 2.6), cv::Vec3b(236, 238, 240));   // Outside.
  EXPECT_LT(at(0.0, 3.0)[0], 120);                      // Wall.
  EXPECT_EQ(at(3.1, 2.1), cv::Vec3b(70, 90, 210));      // The person.
  EXPECT_EQ(at(1.05, 2.0), cv::Vec3b(70, 150, 40));     // The start.
}

// Metres along the edges, and below them what the colours mean: of what there
// is alone.
TEST(PlanDrawing, HasCoordinatesAndALegend) {
  const World world = WorldFromYaml(kYaml, "w.yaml");
  PlanOptions options;
  options.pixels = 640;
  const cv::Mat3b bare = DrawPlan(world, BuildScene(world), options);
  options.paths = {{PlanPath::Kind::kDriven, {{1.0, 1.0}, {2.0, 1.0}}},
                   {PlanPath::Kind::kDeadReckoning, {}}};
  const cv::Mat3b plan = DrawPlan(world, BuildScene(world), options);
  const auto num_of = [](const cv::Mat3b& image, const cv::Vec3b& color) {
    cv::Mat1b is_it;
    cv::inRange(image, color, color, is_it);
    return cv::countNonZero(is_it);
  };
  const auto legend = [](const cv::Mat3b& image) {
    return image.rowRange(image.rows - 22, image.rows);
  };
  EXPECT_GT(num_of(legend(bare), {70, 90, 210}), 20);  // The person.
  EXPECT_EQ(num_of(legend(bare), {90, 160, 60}), 0);
  EXPECT_GT(num_of(legend(plan), {90, 160, 60}), 20);  // The way driven,
  EXPECT_EQ(num_of(legend(plan), {40, 140, 240}), 0);  // nothing else.
  // The tick at x = 2 m, six pixels below the wall: 70 + 100 * 2 px.
  EXPECT_LT(bare(470 + 9, 270)[0], 200);
  EXPECT_EQ(bare(470 + 9, 220)[0], 236);
}

TEST(Exposure, CountsWhatIsBurntAndBlack) {
  cv::Mat3b image(10, 10, cv::Vec3b(100, 100, 100));
  image(0, 0) = {255, 255, 255};
  image(0, 1) = {1, 0, 0};
  // Pure colours are bright or dark, but not lost.
  image(1, 0) = {0, 0, 255};
  image(1, 1) = {255, 0, 0};
  const Exposure exposure = ExposureOf(image, {});
  EXPECT_NEAR(exposure.burnt_share, 0.01, 1e-12);
  EXPECT_NEAR(exposure.black_share, 0.01, 1e-12);
  EXPECT_TRUE(exposure.IsGood());
  image(0, 2) = {0, 0, 0};
  EXPECT_FALSE(ExposureOf(image, {}).IsGood());
  // Pixels that no ray belongs to do not count.
  cv::Mat1b seen(10, 10, std::uint8_t{255});
  seen(0, 2) = 0;
  EXPECT_NEAR(ExposureOf(image, seen).black_share, 1.0 / 99.0, 1e-12);
  EXPECT_FALSE(ExposureOf(cv::Mat3b(4, 4, cv::Vec3b(49, 49, 49)), {}).IsGood());
  EXPECT_FALSE(
      ExposureOf(cv::Mat3b(4, 4, cv::Vec3b(201, 201, 201)), {}).IsGood());
}

TEST(GreyChange, IsTheMeanOfPixelsThatCount) {
  const cv::Mat3b first(2, 2, cv::Vec3b(100, 100, 100));
  cv::Mat3b second = first.clone();
  second(0, 1) = {106, 106, 106};
  second(1, 1) = {98, 98, 98};
  EXPECT_NEAR(GreyChange(first, second, {}), 2.0, 1e-12);
  cv::Mat1b seen(2, 2, std::uint8_t{255});
  seen(1, 1) = 0;
  EXPECT_NEAR(GreyChange(first, second, seen), 2.0, 1e-12);
  seen(0, 0) = 0;
  EXPECT_NEAR(GreyChange(first, second, seen), 3.0, 1e-12);
}

}  // namespace
}  // namespace waymark
