#include "processes/collision_guard/stop_latch.h"

#include "estimation/base/input_error.h"
#include "processes/support/state_file.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace waymark {
namespace {

using testing::HasSubstr;

stop_t Stop(bool is_stopped, const char* reason = "space") {
  stop_t stop;
  stop.utime = 1;
  stop.source = "teleop";
  stop.is_stopped = is_stopped ? 1 : 0;
  stop.reason = reason;
  return stop;
}

class StopLatchTest : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) {
    std::ofstream(name) << text;
  }
  TemporaryDirectory folder_;
  std::string path_ = folder_ / "stop";
};

TEST_F(StopLatchTest, HoldsOverARestart) {
  {
    StopLatch latch(path_);
    EXPECT_FALSE(latch.is_stopped());
    latch.Set(Stop(true));
    EXPECT_EQ(latch.reason(), "stopped by teleop: space");
    EXPECT_EQ(latch.fault(), "");
  }
  {
    StopLatch latch(path_);
    EXPECT_TRUE(latch.is_stopped());
    EXPECT_EQ(latch.reason(), "stopped by teleop: space (before a restart)");
    latch.Set(Stop(false));
    EXPECT_FALSE(latch.is_stopped());
    EXPECT_EQ(latch.reason(), "");
  }
  EXPECT_FALSE(StopLatch(path_).is_stopped());
}

TEST_F(StopLatchTest, WithoutAFileItIsKeptInMemory) {
  StopLatch latch("");
  latch.Set(Stop(true));
  EXPECT_TRUE(latch.is_stopped());
  EXPECT_FALSE(StopLatch("").is_stopped());
}

TEST_F(StopLatchTest, WhatCannotBeTrustedIsAStop) {
  for (const char* text : {"",
                           "is_stopped: maybe\n",
                           "is_stopped: false\nis_stopped: false\n",
                           "is_moving: true\n",
                           "is_stopped: fal",
                           "\x01\x02\xff",
                           "- 1\n- 2\n"}) {
    Write(path_, text);
    EXPECT_TRUE(StopLatch(path_).is_stopped()) << text;
  }
  Write(path_, "is_stopped: false\n");
  EXPECT_FALSE(StopLatch(path_).is_stopped());
  std::filesystem::remove(path_);
  std::filesystem::create_directory(path_);
  EXPECT_TRUE(StopLatch(path_).is_stopped());
}

TEST_F(StopLatchTest, AWriteThatWasCutShortIsAStop) {
  // Killed between writing and renaming: the old file still says 'go'.
  StopLatch(path_).Set(Stop(false));
  Write(UnfinishedStateFile(path_), "is_stopped: tr");
  StopLatch latch(path_);
  EXPECT_TRUE(latch.is_stopped());
  EXPECT_THAT(latch.reason(), HasSubstr("cut short"));
  latch.Set(Stop(false));
  EXPECT_FALSE(StopLatch(path_).is_stopped());
}

TEST_F(StopLatchTest, AnyTextComesBack) {
  StopLatch(path_).Set(Stop(true, "\"quoted\": {a, b} # no comment\n\x1b[2J"));
  StopLatch latch(path_);
  EXPECT_TRUE(latch.is_stopped());
  EXPECT_THAT(latch.reason(),
              HasSubstr("\"quoted\": {a, b} # no comment??[2J"));
}

TEST_F(StopLatchTest, SaysWhereItCannotBeKept) {
  EXPECT_THROW(StopLatch(folder_ / "missing/stop"), InputError);
  StopLatch latch(path_);
  std::filesystem::create_directories(path_ + "/not_empty");
  latch.Set(Stop(true));
  EXPECT_TRUE(latch.is_stopped());
  EXPECT_THAT(latch.fault(), HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace waymark
