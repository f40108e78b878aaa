// POSE_SETTLED is the same bytes live and offline: the same inputs give the
// same answer, however the network and the scheduler mix them.
#include "processes/support/channels.h"
#include "processes/support/decode.h"
#include "processes/support/log_file.h"
#include "tests/network/log_recorder.h"
#include "tests/network/network_test.h"
#include "tests/support/child_process.h"

#include <waymark/pose_t.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {
namespace {

using std::chrono::milliseconds;

constexpr const char* kUrl = "udpm://239.255.76.67:7671?ttl=0";

std::vector<std::vector<std::uint8_t>> PayloadsOf(const std::string& log,
                                                  std::string_view channel) {
  std::vector<std::vector<std::uint8_t>> payloads;
  LogReader reader(log);
  while (auto event = reader.Next()) {
    if (event->channel == channel) payloads.push_back(std::move(event->data));
  }
  return payloads;
}

// Where two lists of payloads first differ, or "equal".
std::string Difference(const std::vector<std::vector<std::uint8_t>>& a,
                       const std::vector<std::vector<std::uint8_t>>& b) {
  const auto [i, j] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  if (i == a.end() && j == b.end()) return "equal";
  std::string text = std::to_string(a.size()) + " and " +
                     std::to_string(b.size()) + " messages, from number " +
                     std::to_string(i - a.begin());
  if (i == a.end() || j == b.end()) return text;
  const auto byte =
      std::mismatch(i->begin(), i->end(), j->begin(), j->end()).first;
  return text + ", from byte " + std::to_string(byte - i->begin());
}

// Of the sample's channels those that the filter does not publish itself.
constexpr std::array kInputs = {
    kEncoders, kPositionFix, kInitialPose, kRelativeMotion};

std::set<std::string> ChannelsOf(const std::string& log) {
  std::set<std::string> channels;
  LogReader reader(log);
  while (const auto event = reader.Next()) channels.insert(event->channel);
  return channels;
}

class SettledEqualityTest : public NetworkTest,
                            public testing::WithParamInterface<const char*> {
 protected:
  SettledEqualityTest() {
    const char* source = std::getenv("WAYMARK_SOURCE");
    sample_ = std::string(source == nullptr ? "." : source) + "/logs/samples/" +
              GetParam();
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("settled_equality_") + GetParam());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~SettledEqualityTest() override { std::filesystem::remove_all(folder_); }

  std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }

  // Real LCM: player to pose_filter to recorder.
  void PlayLive(const std::string& recorded, const std::string& speed) {
    std::set<std::string> channels = ChannelsOf(sample_);
    channels.emplace(kPoseSettled);
    LogRecorder recorder(kUrl, channels, recorded);
    ChildProcess filter({BuildPath("bin/pose_filter"), "--lcm-url", kUrl});
    // The player starts after STATUS is seen: then every input is heard.
    const ChildResult seen = RunChild({BuildPath("bin/waymark-wait"),
                                       "status",
                                       "pose_filter",
                                       "--timeout",
                                       "30",
                                       "--lcm-url",
                                       kUrl});
    ASSERT_EQ(seen.exit_code, 0) << seen.err;
    const ChildResult played = RunChild({"/usr/bin/lcm-logplayer",
                                         "--speed",
                                         speed,
                                         "--lcm-url",
                                         kUrl,
                                         sample_});
    ASSERT_EQ(played.exit_code, 0) << played.err;
    const ChildResult idle = RunChild({BuildPath("bin/waymark-wait"),
                                       "idle",
                                       "--for",
                                       "0.7",
                                       "--timeout",
                                       "30",
                                       "--lcm-url",
                                       kUrl});
    ASSERT_EQ(idle.exit_code, 0) << idle.err;
    filter.Signal(SIGTERM);
    const ChildResult filtered = filter.Wait();
    ASSERT_EQ(filtered.exit_code, 0) << filtered.err;
    recorder.Stop();
  }

  // A gap in the inputs, or in what the filter numbered from 0, says nothing of
  // the filter.
  bool RecorderLostNothing(const std::string& recorded) const {
    for (const std::string_view channel : kInputs) {
      const std::string difference = Difference(PayloadsOf(recorded, channel),
                                                PayloadsOf(sample_, channel));
      if (difference == "equal") continue;
      std::printf("%s: %s\n", std::string(channel).c_str(), difference.c_str());
      return false;
    }
    std::int32_t next = 0;
    for (const auto& payload : PayloadsOf(recorded, kPoseSettled)) {
      const auto pose = DecodeMessage<pose_t>(payload);
      if (pose && pose->seq == next++) continue;
      std::printf("%.*s: a gap at number %d\n",
                  static_cast<int>(kPoseSettled.size()),
                  kPoseSettled.data(),
                  next - 1);
      return false;
    }
    return true;
  }

  void ReplayOffline(const std::string& in, const std::string& out) {
    const ChildResult replayed = RunChild(
        {BuildPath("bin/pose_filter"), "--log-in", in, "--log-out", out});
    ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  }

  std::string sample_;
  std::filesystem::path folder_;
};

TEST_P(SettledEqualityTest, LiveEqualsOffline) {
  // What a socket holds outlasts a stop that is the longer, the slower the
  // player fills it.
  int speed = 10;
  const bool is_measured = OnARunningMachine(
      milliseconds(20),
      [this, &speed] {
        std::filesystem::remove(Path("live.lcm"));
        PlayLive(Path("live.lcm"), std::to_string(speed));
        speed = (speed + 1) / 2;
      },
      [this] { return RecorderLostNothing(Path("live.lcm")); });
  if (!is_measured) return;
  ASSERT_NO_FATAL_FAILURE(ReplayOffline(sample_, Path("from_sample.lcm")));
  ASSERT_NO_FATAL_FAILURE(
      ReplayOffline(Path("live.lcm"), Path("from_live.lcm")));
  // The same inputs were logged: nothing was lost on the way.
  for (const std::string_view channel : kInputs) {
    ASSERT_EQ(Difference(PayloadsOf(Path("live.lcm"), channel),
                         PayloadsOf(sample_, channel)),
              "equal")
        << channel;
  }
  const auto live = PayloadsOf(Path("live.lcm"), kPoseSettled);
  // 40 s at 20 Hz; a filter without a start settles nothing before its first
  // fix but says so.
  EXPECT_GT(live.size(), 700u);
  EXPECT_EQ(Difference(live, PayloadsOf(Path("from_sample.lcm"), kPoseSettled)),
            "equal");
  EXPECT_EQ(Difference(live, PayloadsOf(Path("from_live.lcm"), kPoseSettled)),
            "equal");
}

INSTANTIATE_TEST_SUITE_P(Samples,
                         SettledEqualityTest,
                         testing::Values("zigzag.log", "square.log"),
                         [](const auto& sample) {
                           const std::string name = sample.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace waymark
