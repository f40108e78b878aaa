#include "procman/deployment/deployment_parser.h"

#include "estimation/base/input_error.h"
#include "estimation/base/random.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr char kRobot[] = R"(# A robot.
cmd "guard" {
  exec = "collision_guard --config \"my robot.yaml\"";
  host = "robot";
  auto_respawn = "Yes";
  stop_signal = 15;
  stop_time_allowed = 3;
}
group "vision" {
  cmd "camera" { exec = "video /dev/video0"; deputy = "eye"; }
  group "lines" {
    cmd "tracker" {
      exec = "corridor_tracker"; deputy = "eye"; nice = 5;
      working_dir = "/tmp"; memory_limit_mb = 500; max_processes = 20;
      depends_on = "camera  guard"; ready_status = "corridor_tracker";
    }
  }
}
script "go" {
  start group "vision" wait "running";
  wait ms 500;
  wait cmd "tracker" status "ready" timeout 20000;
  restart cmd "guard";
  stop everything wait "stopped" timeout 1500;
}
script "twice" { run_script "go"; run_script "go"; }
)";

TEST(DeploymentParser, ReadsCommandsGroupsAndScripts) {
  const Deployment d = ParseDeployment(kRobot, "robot.pmd");
  ASSERT_EQ(d.commands.size(), 3u);
  const DeploymentCommand& guard = d.commands[0];
  EXPECT_EQ(guard.id, "guard");
  EXPECT_EQ(guard.group, "");
  EXPECT_EQ(guard.exec, "collision_guard --config \"my robot.yaml\"");
  EXPECT_EQ(guard.deputy, "robot");
  EXPECT_TRUE(guard.auto_respawn);
  EXPECT_EQ(guard.stop_signal, 15);
  EXPECT_EQ(guard.stop_time_allowed_s, 3);
  EXPECT_EQ(guard.place.line, 2);
  EXPECT_EQ(guard.place.column, 5);
  const DeploymentCommand& camera = d.commands[1];
  EXPECT_EQ(camera.group, "vision");
  EXPECT_FALSE(camera.auto_respawn);
  EXPECT_EQ(camera.stop_signal, 2);
  EXPECT_EQ(camera.stop_time_allowed_s, 7);
  const DeploymentCommand& tracker = *d.Find("tracker");
  EXPECT_EQ(tracker.group, "vision/lines");
  EXPECT_TRUE(IsInGroup(tracker, "vision"));
  EXPECT_FALSE(IsInGroup(tracker, "vis"));
  EXPECT_THAT(tracker.depends_on, ElementsAre("camera", "guard"));
  EXPECT_EQ(tracker.nice, 5);
  EXPECT_EQ(tracker.working_dir, "/tmp");
  EXPECT_EQ(tracker.memory_limit_mb, 500);
  EXPECT_EQ(tracker.max_processes, 20);
  EXPECT_EQ(tracker.ready_status, "corridor_tracker");
  const DeploymentScript& go = *d.FindScript("go");
  ASSERT_EQ(go.actions.size(), 5u);
  const auto& start = std::get<StartStopAction>(go.actions[0]);
  EXPECT_EQ(start.kind, StartStopAction::Kind::kStart);
  EXPECT_EQ(start.target.kind, ScriptTarget::Kind::kGroup);
  EXPECT_EQ(start.target.name, "vision");
  EXPECT_EQ(start.wait, WaitFor::kRunning);
  EXPECT_EQ(std::get<WaitMsAction>(go.actions[1]).wait_ms, 500);
  const auto& wait = std::get<WaitStatusAction>(go.actions[2]);
  EXPECT_EQ(wait.wait, WaitFor::kReady);
  EXPECT_EQ(wait.timeout_s, 20.0);
  const auto& stop = std::get<StartStopAction>(go.actions[4]);
  EXPECT_EQ(stop.target.kind, ScriptTarget::Kind::kEverything);
  EXPECT_EQ(stop.timeout_s, 1.5);
  EXPECT_EQ(go.places[4].line, 24);
}

TEST(DeploymentParser, WhatIsWrittenIsReadToTheSame) {
  const Deployment d = ParseDeployment(kRobot, "robot.pmd");
  const std::string text = DeploymentText(d);
  EXPECT_EQ(DeploymentText(ParseDeployment(text, "written")), text);
  EXPECT_THAT(text, HasSubstr("stop_signal = 15;"));
  EXPECT_THAT(text, HasSubstr("stop_time_allowed = 3;"));
  Deployment odd;
  odd.commands.resize(1);
  odd.commands[0].id = "a \"b\" \\ \t\n\r";
  odd.commands[0].exec = "x";
  const Deployment read = ParseDeployment(DeploymentText(odd), "odd");
  EXPECT_EQ(read.commands[0].id, odd.commands[0].id);
}

TEST(DeploymentParser, ErrorsSayWhereAndWhat) {
  const struct {
    const char* text;
    const char* error;
  } kCases[] = {
      {"cmd guard {}", "f:1:5: cmd needs a name in quotes, not 'guard'"},
      {"cmd \"a\" {\n}", "f:1:5: cmd \"a\" has no exec"},
      {"cmd \"a\" {\n exec = \"x\"\n}", "f:3:1: ';' is expected, not '}'"},
      {"cmd \"a\" { exec = 3; }", "f:1:18: exec = text in quotes, not '3'"},
      {"cmd \"a\" { exec = \"x\"; exec = \"y\"; }",
       "f:1:23: 'exec' is given twice"},
      {"cmd \"a\" { host = \"x\"; deputy = \"y\"; }",
       "f:1:23: 'deputy' is given twice"},
      {"cmd \"a\" { colour = \"x\"; }", "f:1:11: unknown attribute 'colour': "},
      {"cmd \"a\" { stop_signal = 0; }",
       "f:1:25: stop_signal: a whole number from 1 to 64 is expected, not '0'"},
      {"cmd \"a\" { stop_time_allowed = 99999999999; }",
       "f:1:31: stop_time_allowed: a whole number from 1 to 86400"},
      {"cmd \"a\" { auto_respawn = \"ture\"; }",
       "f:1:26: auto_respawn = \"true\" or \"false\", not \"ture\""},
      {"cmd \"a\" { exec = \"x\n\"; }", "f:1:20: a string goes on over"},
      {"cmd \"a", "f:1:5: a string has no end"},
      {"cmd \"a\" { exec = \"x\"; }\ncmd \"a\" { exec = \"y\"; }",
       "f:2:5: cmd \"a\" is given twice, first in line 1"},
      {"cmd \"a/b\" { exec = \"x\"; }", "f:1:5: \"a/b\": no '/' in names"},
      {"group \"a/b\" {}", "f:1:7: \"a/b\": no '/' in names"},
      {"cmd \"a\" { exec = \"x\"; depends_on = \"b\"; }",
       "f:1:5: cmd \"a\" depends on \"b\", which there is not"},
      {"cmd \"a\" { exec = \"x\"; depends_on = \"b\"; }\n"
       "cmd \"b\" { exec = \"x\"; depends_on = \"a\"; }",
       "f:1:5: commands depend on each other: \"a\" -> \"b\" -> \"a\""},
      {"script \"s\" { start cmd \"a\"; }", "f:1:14: there is no cmd \"a\""},
      {"script \"s\" { stop group \"g\"; }", "f:1:14: there is no group \"g\""},
      {"script \"s\" { run_script \"t\"; }",
       "f:1:14: there is no script \"t\""},
      {"script \"s\" { run_script \"s\"; }",
       "f:1:8: scripts run each other: \"s\" -> \"s\""},
      {"script \"s\" { wait everything status \"stopped\"; }",
       "f:1:19: cmd or group is expected, not 'everything'"},
      {"script \"s\" { start everything wait \"done\"; }",
       "f:1:36: \"running\", \"stopped\" or \"ready\" is expected, not"},
      {"what", "f:1:1: cmd, group or script is expected, not 'what'"},
      {"cmd \"a\" { exec = \"x\";", "f:1:22: an attribute or '}' is expected"},
      {"\x01", "f:1:1: unexpected byte 0x01"},
  };
  for (const auto& [text, error] : kCases) {
    try {
      (void)ParseDeployment(text, "f");
      ADD_FAILURE() << text;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), testing::StartsWith(error)) << text;
    }
  }
}

// Cut anywhere, with bytes changed: read or refused, never worse.
TEST(DeploymentParser, BrokenFilesAreReadOrRefused) {
  Random random(3);
  const std::string text = kRobot;
  int num_read = 0;
  for (int round = 0; round < 5000; ++round) {
    std::string broken = text.substr(0, random.Index(text.size() + 1));
    for (int i = 0; i < 3 && !broken.empty(); ++i) {
      broken[random.Index(broken.size())] =
          "{}\"=;# \\\nax1\0"[random.Index(13)];
    }
    try {
      const Deployment d = ParseDeployment(broken, "f");
      const std::string written = DeploymentText(d);
      ASSERT_EQ(DeploymentText(ParseDeployment(written, "f")), written);
      ++num_read;
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(num_read, 10);
}

TEST(DeploymentParser, DeepAndLongFilesAreRefused) {
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "group \"g\" {";
  EXPECT_THROW((void)ParseDeployment(deep, "f"), InputError);
  std::string chain;
  for (int i = 0; i < 5000; ++i) {
    chain += "script \"" + std::to_string(i) + "\" { run_script \"" +
             std::to_string(i + 1) + "\"; }";
  }
  EXPECT_THROW((void)ParseDeployment(chain, "f"), InputError);
}

}  // namespace
}  // namespace waymark
