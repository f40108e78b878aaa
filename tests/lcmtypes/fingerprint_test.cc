// Every message type's fingerprint against the stored ones, and those that
// other projects' tools expect against theirs.
#include <gtest/gtest.h>
#include <waymark_all_types.hpp>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

namespace waymark {
namespace {

using Fingerprints = std::map<std::string, std::uint64_t>;

Fingerprints Compiled() {
  Fingerprints fingerprints;
#define ADD(package, type)           \
  fingerprints[#package "." #type] = \
      static_cast<std::uint64_t>(::package::type::getHash());
  WAYMARK_FOR_EACH_MESSAGE_TYPE(ADD)
#undef ADD
  return fingerprints;
}

// Lines "name fingerprint" in hexadecimal; # starts a comment.
Fingerprints Stored() {
  const char* source = std::getenv("WAYMARK_SOURCE");
  const std::string path = std::string(source != nullptr ? source : ".") +
                           "/tests/lcmtypes/fingerprints.txt";
  std::ifstream file(path);
  EXPECT_TRUE(file.good()) << path;
  Fingerprints fingerprints;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string name;
    std::string hexadecimal;
    if (words >> name >> hexadecimal) {
      fingerprints[name] = std::stoull(hexadecimal, nullptr, 16);
    }
  }
  return fingerprints;
}

std::string Hexadecimal(std::uint64_t value) {
  char text[17];
  std::snprintf(
      text, sizeof(text), "%016lx", static_cast<unsigned long>(value));
  return text;
}

// A changed fingerprint orphans every log recorded before.
TEST(Fingerprint, EqualsTheStoredOne) {
  const Fingerprints stored = Stored();
  for (const auto& [name, fingerprint] : Compiled()) {
    const auto found = stored.find(name);
    if (found == stored.end()) {
      ADD_FAILURE() << "new type: add this line to "
                       "tests/lcmtypes/fingerprints.txt\n"
                    << name << " " << Hexadecimal(fingerprint);
      continue;
    }
    EXPECT_EQ(Hexadecimal(fingerprint), Hexadecimal(found->second))
        << name
        << " changed: logs that hold it can no longer be read. Restore its "
           "members (names, types, order), and add a new type plus a "
           "converter in logs/ instead. Only while no log was published: "
           "store the new fingerprint and say so in CHANGELOG.md under "
           "'Breaks logs'.";
  }
}

TEST(Fingerprint, NoStoredTypeIsGone) {
  const Fingerprints compiled = Compiled();
  for (const auto& [name, fingerprint] : Stored()) {
    EXPECT_TRUE(compiled.contains(name))
        << name << " was removed: logs that hold it can no longer be read. "
        << "Restore lcmtypes/" << name.substr(name.find('.') + 1) << ".lcm.";
  }
}

// Observed on the wire of libbot2, procman and bot2-procman. These never
// change, whatever is stored above: viewers and process managers of others
// depend on them.
TEST(Fingerprint, EqualsThatOfOtherProjects) {
  const Fingerprints others = {
      {"waymark.image_t", 0x14739ffe13d5f5f0},           // bot_core.image_t
      {"waymark.image_metadata_t", 0x9a4b634d0577fb8e},  // bot_core
      {"waymark.bot_pose_t", 0x2e16efb052b0105e},        // bot_core.pose_t
      {"waymark.planar_lidar_t", 0xe3d17423180b5e8d},    // bot_core
      {"procman_lcm.cmd_t", 0x2277f449a855d330},
      {"procman_lcm.cmd_desired_t", 0xb2a6c7a09ba54539},
      {"procman_lcm.cmd_status_t", 0xa8e0208786cf86e3},
      {"procman_lcm.deputy_info_t", 0x8876aeb040efd01f},
      {"procman_lcm.orders_t", 0xd343f45b171ab855},
      {"procman_lcm.discovery_t", 0xb1c83182bed74b95},
      {"procman_lcm.output_t", 0x8efa5caf5da01eb3},
      {"bot_procman.command2_t", 0xf905d4ffa029810d},
      {"bot_procman.deputy_cmd2_t", 0x0f17aadccbe2f96e},
      {"bot_procman.sheriff_cmd2_t", 0x809fa6b3fc1ff2ad},
      {"bot_procman.info2_t", 0xd0cf2ed34edd8314},
      {"bot_procman.orders2_t", 0xef1277a9fdb17943},
      {"bot_procman.printf_t", 0x0abac44d8e3a7bad},
      {"bot_procman.discovery_t", 0x1116e1fff6333a71},
      {"bot_procman.deputy_cmd_t", 0xdabf7cb3055906a7},
      {"bot_procman.info_t", 0xda374b52bf1dd0fc},
      {"bot_procman.orders_t", 0x105068997663d542},
      {"bot_procman.sheriff_cmd_t", 0x7f7a2e53415dc6f0},
  };
  const Fingerprints compiled = Compiled();
  for (const auto& [name, fingerprint] : others) {
    const auto found = compiled.find(name);
    ASSERT_NE(found, compiled.end()) << name;
    EXPECT_EQ(Hexadecimal(found->second), Hexadecimal(fingerprint)) << name;
  }
}

// The dispatch by fingerprint needs them distinct.
TEST(Fingerprint, IsUnique) {
  std::map<std::uint64_t, std::string> names;
  for (const auto& [name, fingerprint] : Compiled()) {
    const auto [entry, is_new] = names.emplace(fingerprint, name);
    EXPECT_TRUE(is_new) << name << " and " << entry->second;
  }
}

}  // namespace
}  // namespace waymark
