#include "processes/support/message_schema.h"

#include "estimation/base/input_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <waymark_all_types.hpp>

namespace waymark {
namespace {

using testing::HasSubstr;

const SchemaSet& BuiltIn() {
  static const SchemaSet kSet(BuiltInSchemaSources());
  return kSet;
}

std::uint64_t FingerprintOfType(const std::string& name) {
  const auto* schema = BuiltIn().FindByName(name);
  if (schema == nullptr) throw std::runtime_error("no type " + name);
  return Fingerprint(*schema);
}

SchemaSet Parse(const std::string& text) {
  return SchemaSet(std::vector<SchemaSet::Source>{{"x.lcm", text}});
}

std::string ErrorOf(const std::string& text) {
  try {
    Parse(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(MessageSchemaTest, FingerprintsEqualThoseOfLcmGen) {
#define WAYMARK_EXPECT_SAME(package, type)                        \
  EXPECT_EQ(FingerprintOfType(#package "." #type),                \
            static_cast<std::uint64_t>(package::type::getHash())) \
      << #package "." #type;
  WAYMARK_FOR_EACH_MESSAGE_TYPE(WAYMARK_EXPECT_SAME)
#undef WAYMARK_EXPECT_SAME
}

// Observed on the wire: libbot, and MAEBot recordings.
TEST(MessageSchemaTest, FingerprintsOfOthers) {
  const std::vector<std::pair<std::string, std::uint64_t>> observed = {
      {"bot_core.image_t", 0x14739ffe13d5f5f0},
      {"bot_core.image_metadata_t", 0x9a4b634d0577fb8e},
      {"bot_core.images_t", 0x20ba4f05e8f5e33a},
      {"bot_core.pose_t", 0x2e16efb052b0105e},
      {"bot_core.rigid_transform_t", 0xea9ffbf2acc5c5ae},
      {"bot_core.planar_lidar_t", 0xe3d17423180b5e8d},
      {"bot_core.raw_t", 0x30571b45b804c18e},
      {"bot_core.ins_t", 0x88a7df61422b0840},
      {"bot_core.gps_data_t", 0xd7d20e1e68a41516},
      {"bot_core.vector_3d_t", 0xae7e5fba5eeca11e},
      {"bot_core.quaternion_t", 0x365bdd4bf9100a1f},
      {"bot_core.position_3d_t", 0xee9ff44647af3f79},
      {"bot_core.twist_t", 0x6505e8bef050b34b},
      {"bot_core.joint_state_t", 0x3e377b4cebc593a4},
      {"bot_core.pointcloud_t", 0x0d89dc76eb295069},
      {"bot_core.system_status_t", 0x22c7cc36e9099eb6},
      {"bot_core.sensor_status_t", 0x22bd8eb19e834aad},
      {"bot_frames.update_t", 0xd02808b04613a4e7},
      {"bot_param.request_t", 0x4d0d41c1f105b12f},
      {"bot_param.set_t", 0x16cddeac03462e67},
      {"bot_param.update_t", 0x2b278b90880d6535},
      {"bot_param.entry_t", 0x2eae802baa5ddbbd},
      {"bot_lcmgl.data_t", 0xc9f0a88256b8dd9b},
      {"maebot.encoders_t", 0x7d090bfb221d74f9},
      {"maebot.pose_t", 0x1f317af1246276ac},
      {"maebot.laser_t", 0x89dc5b879a5056cf},
      {"maebot.imu_t", 0xed966784146237ec},
  };
  for (const auto& [name, fingerprint] : observed) {
    EXPECT_EQ(FingerprintOfType(name), fingerprint) << name;
  }
}

TEST(MessageSchemaTest, TypesWithTheSameMembersAreAllFound) {
  const auto found = BuiltIn().FindByFingerprint(0x14739ffe13d5f5f0);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]->name, "waymark.image_t");
  EXPECT_EQ(found[1]->name, "bot_core.image_t");
  EXPECT_TRUE(BuiltIn().FindByFingerprint(1).empty());
}

TEST(MessageSchemaTest, ReadsTheWholeLanguage) {
  const SchemaSet set = Parse(R"(
/* A comment
   of two lines */
package a.b;  // Packages nest.
struct outer_t {
  const int32_t kA = -3, kB = 0x10;
  int32_t num, width;   // Two of a type.
  double grid[num][3], flat[width];
  inner_t nested[num];
  other.thing_t thing;
}
struct inner_t { string text; }
package other;
struct thing_t { boolean is_on; }
)");
  const auto* outer = set.FindByName("a.b.outer_t");
  ASSERT_NE(outer, nullptr);
  EXPECT_EQ(outer->origin, "x.lcm:5");
  ASSERT_EQ(outer->fields.size(), 6U);
  EXPECT_EQ(outer->fields[2].dimensions[0].length_field, 0);
  EXPECT_EQ(outer->fields[2].dimensions[1].length, 3);
  EXPECT_EQ(outer->fields[3].dimensions[0].length_field, 1);
  EXPECT_EQ(outer->fields[4].nested, set.FindByName("a.b.inner_t"));
  EXPECT_EQ(outer->fields[5].nested, set.FindByName("other.thing_t"));
}

TEST(MessageSchemaTest, ATypeMayContainItself) {
  const SchemaSet set =
      Parse("struct node_t { int32_t n; node_t children[n]; byte b; }");
  // As lcm-gen 1.3.1 gives it.
  EXPECT_EQ(Fingerprint(*set.FindByName("node_t")), 0x58f00f5559780307);
}

// Each type holds the next one twice: 2^60 paths, one hash per type.
TEST(MessageSchemaTest, HostileNestingTakesBoundedTime) {
  const auto chain = [](int length, const std::string& last) {
    std::string text;
    for (int i = 0; i < length; ++i) {
      const std::string next = "t" + std::to_string(i + 1);
      text += "struct t" + std::to_string(i) + " { " + next + " a; " + next +
              " b; }\n";
    }
    return text + "struct t" + std::to_string(length) + " { " + last + " }\n";
  };
  EXPECT_EQ(ErrorOf(chain(60, "byte b;")), "no error");
  EXPECT_THAT(ErrorOf(chain(100, "byte b;")), HasSubstr("too deeply"));
  EXPECT_THAT(ErrorOf(chain(60, "t0 a;")), HasSubstr("too deeply"));
}

TEST(MessageSchemaTest, ErrorsNameFileAndLine) {
  EXPECT_THAT(ErrorOf("struct a_t {\n int32_t n\n}"),
              HasSubstr("x.lcm:3: expected ';', found '}'"));
  EXPECT_THAT(ErrorOf("struct a_t { int32_t n; "), HasSubstr("closing"));
  EXPECT_THAT(ErrorOf("\nnonsense"), HasSubstr("x.lcm:2"));
  EXPECT_THAT(ErrorOf("struct a_t { b_t b; }"), HasSubstr("b_t"));
  EXPECT_THAT(ErrorOf("struct a_t { byte b[m]; }"),
              HasSubstr("m is no earlier integer member"));
  EXPECT_THAT(ErrorOf("struct a_t { byte b[0]; }"), HasSubstr("positive"));
  EXPECT_THAT(ErrorOf("struct a_t { byte b; byte b; }"), HasSubstr("twice"));
  EXPECT_THAT(ErrorOf("enum e_t { kOne }"), HasSubstr("enum"));
  EXPECT_THAT(ErrorOf("/* no end"), HasSubstr("comment"));
  EXPECT_THAT(ErrorOf("struct a_t { byte b; } struct a_t { byte c; }"),
              HasSubstr("other members than in x.lcm:1"));
  EXPECT_EQ(ErrorOf("struct a_t { byte b; } struct a_t { byte b; }"),
            "no error");
  EXPECT_THROW(ReadSchemaFolder("/nowhere"), InputError);
}

}  // namespace
}  // namespace waymark
