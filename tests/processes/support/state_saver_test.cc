#include "processes/support/state_saver.h"

#include "estimation/base/input_error.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <new>
#include <sstream>
#include <string>
#include <thread>

namespace waymark {
namespace {

using testing::HasSubstr;
using Steady = std::chrono::steady_clock;

std::string TextOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// A disk that takes its time: what is written first is a pipe, whose opening
// waits for a reader.
class SlowDisk {
 public:
  explicit SlowDisk(const std::string& path) : pipe_(path + ".new") {
    EXPECT_EQ(::mkfifo(pipe_.c_str(), 0600), 0);
  }
  // Lets the write go on.
  void Release() const { std::ifstream(pipe_).get(); }

 private:
  std::string pipe_;
};

TEST(StateSaverTest, ASlowDiskHoldsNobodyAndTheNewestTextIsKept) {
  const TemporaryDirectory directory;
  const std::string path = directory / "state";
  StateSaver saver(path, false);
  const SlowDisk disk(path);
  const auto begin = Steady::now();
  for (int i = 0; i < 100; ++i) saver.Save("text " + std::to_string(i));
  // The first write hangs until someone reads; the loop does not.
  EXPECT_LT(Steady::now() - begin, std::chrono::seconds(5));
  EXPECT_FALSE(std::filesystem::exists(path));
  disk.Release();
  saver.Save("newest");
  saver.Flush();
  EXPECT_EQ(TextOf(path), "newest");
}

TEST(StateSaverTest, WhatWaitsIsWrittenAtTheEnd) {
  const TemporaryDirectory directory;
  const std::string path = directory / "state";
  for (const bool is_offline : {false, true}) {
    {
      StateSaver saver(path, is_offline);
      saver.Save("first");
      saver.Save("last");
    }
    EXPECT_EQ(TextOf(path), "last") << is_offline;
    std::filesystem::remove(path);
  }
}

TEST(StateSaverTest, OfflineEachTextIsThereAtOnce) {
  const TemporaryDirectory directory;
  StateSaver saver(directory / "state", true);
  for (const char* text : {"one", "two", "three"}) {
    saver.Save(text);
    EXPECT_EQ(TextOf(directory / "state"), text);
  }
}

TEST(StateSaverTest, AFaultLastsUntilTheNextWriteThatGoesWell) {
  const TemporaryDirectory directory;
  const std::string path = directory / "state";
  StateSaver saver(path, false);
  // In the way of what is written first.
  std::filesystem::create_directory(path + ".new");
  saver.Save("lost");
  saver.Flush();
  EXPECT_THAT(saver.fault(), HasSubstr("state: cannot be written"));
  std::filesystem::remove(path + ".new");
  saver.Save("kept");
  saver.Flush();
  EXPECT_EQ(saver.fault(), "");
  EXPECT_EQ(TextOf(path), "kept");
}

TEST(StateSaverTest, WhateverAWriteThrowsIsAFaultAndTheNextIsTried) {
  const TemporaryDirectory directory;
  const std::string path = directory / "state";
  for (const bool is_offline : {false, true}) {
    bool is_full = true;
    StateSaver saver(
        path, is_offline, [&](const std::string& to, const std::string& text) {
          if (is_full) throw std::bad_alloc();
          SaveStateFile(to, text);
        });
    for (int i = 0; i < 3; ++i) {
      saver.Save("lost");
      EXPECT_NO_THROW(saver.Flush());
      EXPECT_EQ(saver.fault(),
                path + ": cannot be written: " + std::bad_alloc().what());
    }
    is_full = false;
    saver.Save("kept");
    saver.Flush();
    EXPECT_EQ(saver.fault(), "");
    EXPECT_EQ(TextOf(path), "kept");
    std::filesystem::remove(path);
  }
}

TEST(StateSaverTest, RefusesAFolderThatIsNotThere) {
  const TemporaryDirectory directory;
  EXPECT_THROW(StateSaver(directory / "absent/state", false), InputError);
  StateSaver nothing("", false);
  nothing.Save("text");
  nothing.Flush();
  EXPECT_EQ(nothing.fault(), "");
}

}  // namespace
}  // namespace waymark
