#include "processes/convert/corridor_file.h"

#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace waymark {
namespace {

using ::testing::HasSubstr;

std::string Refusal(const std::string& yaml) {
  try {
    (void)CorridorsFromYaml(yaml, "c.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CorridorFile, SaysWhatIsKnown) {
  const auto corridors = CorridorsFromYaml(
      "corridors:\n"
      "  - {name: a, width: 2, height: 2.5, x: [1, 20], axis_W: [3, 4, 90]}\n"
      "  - {name: b, skirting_height: 0.1, skirting_depth: 0.02,\n"
      "     axis_W: [0, 1, -30]}\n",
      "c.yaml");
  ASSERT_EQ(corridors.size(), 2U);
  EXPECT_EQ(corridors[0].name, "a");
  EXPECT_EQ(corridors[0].width, 2.0);
  EXPECT_EQ(corridors[0].height, 2.5);
  EXPECT_FALSE(corridors[0].skirting_height);
  EXPECT_EQ(corridors[0].x_min, 1.0);
  EXPECT_EQ(corridors[0].x_max, 20.0);
  EXPECT_EQ(corridors[0].X_WL.y, 4.0);
  EXPECT_DOUBLE_EQ(corridors[0].X_WL.heading, RadiansFromDegrees(90.0));
  EXPECT_EQ(corridors[0].skirting_depth, 0.0);
  EXPECT_EQ(corridors[1].skirting_depth, 0.02);
  EXPECT_FALSE(corridors[1].width);
  EXPECT_FALSE(corridors[1].height);
}

TEST(CorridorFile, ShippedOnesLoad) {
  for (const char* name : {"corridor_plain",
                           "corridor_textured",
                           "corridor_office",
                           "corridor_mouth",
                           "t_corridors"}) {
    EXPECT_FALSE(LoadCorridorFile(FindCorridorFile(name)).empty()) << name;
  }
}

TEST(CorridorFile, OneLineForWhatIsWrong) {
  const std::string begin = "corridors:\n  - {name: a, axis_W: [0, 0, 0], ";
  EXPECT_THAT(Refusal(""), HasSubstr("none given"));
  EXPECT_THAT(Refusal("corridors:\n  - {name: a}\n"), HasSubstr("axis_W"));
  EXPECT_THAT(Refusal(begin + "width: 0}"), HasSubstr("c.yaml:2"));
  EXPECT_THAT(Refusal(begin + "width: 0}"), HasSubstr("width"));
  EXPECT_THAT(Refusal(begin + "depth: 1}"), HasSubstr("depth"));
  EXPECT_THAT(Refusal(begin + "x: [5, 2]}"), HasSubstr("beginning"));
  EXPECT_THAT(Refusal(begin + "height: 0.6, skirting_height: 0.9}"),
              HasSubstr("skirting_height"));
  EXPECT_THAT(Refusal("corridors:\n"
                      "  - {name: a, axis_W: [0, 0, 0]}\n"
                      "  - {name: a, axis_W: [0, 1, 0]}\n"),
              HasSubstr("twice"));
}

}  // namespace
}  // namespace waymark
