// All processes of the build on the sample logs: same log, same bytes.
#include "processes/support/log_file.h"
#include "tests/support/temporary_directory.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace waymark {
namespace {

class ReplaySamplesTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* build = std::getenv("WAYMARK_BUILD");
    const char* source = std::getenv("WAYMARK_SOURCE");
    if (build == nullptr || source == nullptr) {
      GTEST_SKIP() << "run by ctest";
    }
    tool_ = std::string(build) + "/bin/waymark-replay";
    for (const auto& entry : std::filesystem::directory_iterator(
             std::filesystem::path(source) / "logs" / "samples")) {
      if (entry.path().extension() == ".log") samples_.push_back(entry.path());
    }
    ASSERT_FALSE(samples_.empty());
    std::istringstream names(Run("--list"));
    for (std::string name; names >> name;) all_ += "-p " + name + " ";
    ASSERT_FALSE(all_.empty());
  }

  // Output of the tool, which must succeed.
  std::string Run(const std::string& arguments) const {
    std::FILE* pipe = popen((tool_ + " " + arguments + " 2>&1").c_str(), "r");
    std::string text;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
      text += static_cast<char>(c);
    }
    EXPECT_EQ(WEXITSTATUS(pclose(pipe)), 0) << arguments << "\n" << text;
    return text;
  }

  TemporaryDirectory directory_{TemporaryDirectory::FastParent()};
  std::string tool_;
  std::string all_;  // "-p pose_filter ..."
  std::vector<std::filesystem::path> samples_;
};

TEST_F(ReplaySamplesTest, SameLogSameBytes) {
  for (const auto& sample : samples_) {
    SCOPED_TRACE(sample);
    const std::string name = sample.stem().string();
    const std::string first = directory_ / (name + "1.log");
    const std::string second = directory_ / (name + "2.log");
    const std::string again = directory_ / (name + "3.log");
    Run(all_ + sample.string() + " " + first);
    Run(all_ + sample.string() + " " + second);
    Run(all_ + first + " " + again);
    const auto bytes = ReadBytes(first);
    EXPECT_GT(bytes.size(), std::filesystem::file_size(sample));
    EXPECT_EQ(ReadBytes(second), bytes);
    // What they published is left out and made again, in the same places.
    EXPECT_EQ(ReadBytes(again), bytes);
  }
}

// A torn and corrupt log is used as far as it can be read.
TEST_F(ReplaySamplesTest, DamagedLogsAreReplayedToo) {
  auto bytes = ReadBytes(samples_.front());
  for (std::size_t i = 0; i < 50; ++i) bytes[bytes.size() / 2 + i] = 0xA5;
  bytes.erase(bytes.end() - 5, bytes.end());
  const std::string damaged = directory_ / "damaged.log";
  const std::string out = directory_ / "out.log";
  WriteBytes(damaged, bytes);
  EXPECT_NE(Run(all_ + damaged + " " + out).find("is damaged"),
            std::string::npos);
  LogReader reader(out);
  std::int64_t num_poses = 0;
  while (const auto event = reader.Next())
    num_poses += event->channel == "POSE";
  EXPECT_TRUE(reader.report().is_sound());
  EXPECT_GT(num_poses, 10);
}

}  // namespace
}  // namespace waymark
