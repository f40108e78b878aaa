// The runner on a real network: nothing that arrived is lost at SIGTERM.
#include "processes/support/channels.h"
#include "processes/support/lcm_bus.h"
#include "processes/support/lcm_url.h"
#include "tests/network/network_test.h"
#include "tests/support/child_process.h"

#include <waymark/config_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/pose_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;
using Steady = std::chrono::steady_clock;

std::string EchoPath() {
  return BuildPath("tests/echo_for_tests");
}

// The other end: sends ENCODERS, keeps what echo publishes.
class Peer {
 public:
  Peer() : bus_("peer", LcmUrl("")) {
    bus_.Advertise<encoders_t>(kEncoders);
    bus_.Subscribe<pose_t>(
        kOdometry, Keep::All(100000), [this](const pose_t& m, Time) {
          odometry.push_back(m);
        });
    bus_.Subscribe<pose_t>(kPose, Keep::All(), [this](const pose_t& m, Time) {
      poses.push_back(m);
    });
    bus_.Subscribe<status_t>(
        kStatus, Keep::All(), [this](const status_t& m, Time) {
          statuses.push_back(m);
        });
    bus_.Subscribe<config_t>(
        kConfig, Keep::All(), [this](const config_t& m, Time) {
          configs.push_back(m);
        });
    bus_.Start();
  }

  void Send(std::int32_t seq) {
    encoders_t message;
    message.utime = 1'700'000'000'000'000 + seq;
    message.seq = seq;
    message.left_ticks = seq;
    bus_.Publish(kEncoders, message);
  }

  // Handles until `done`, half a minute at most.
  [[nodiscard]] bool Until(const std::function<bool()>& done) {
    const auto deadline = Steady::now() + std::chrono::seconds(30);
    while (!done()) {
      if (Steady::now() > deadline) return false;
      if (bus_.HandleOne()) continue;
      pollfd wait{bus_.wake_fd(), POLLIN, 0};
      ::poll(&wait, 1, 50);
    }
    return true;
  }

  std::vector<pose_t> odometry;
  std::vector<pose_t> poses;
  std::vector<status_t> statuses;
  std::vector<config_t> configs;

 private:
  LcmBus bus_;
};

class RunProcessNetworkTest : public NetworkTest {};

TEST_F(RunProcessNetworkTest, SigtermHandlesAllThatArrivedAndFinishes) {
  Peer peer;
  ChildProcess echo({EchoPath(), "--set", "sleep_us=3000"});
  ASSERT_TRUE(peer.Until([&] { return !peer.statuses.empty(); }));
  ASSERT_FALSE(peer.configs.empty());
  EXPECT_THAT(peer.configs[0].yaml, HasSubstr("sleep_us: 3000\n"));
  constexpr int kNum = 400;  // 1.2 s of work.
  for (int i = 0; i < kNum; ++i) peer.Send(i);
  // One answer has come, so those behind it have been sent, and have arrived.
  ASSERT_TRUE(peer.Until([&] { return peer.odometry.size() > 1; }));
  EXPECT_LT(peer.odometry.size(), kNum / 2);
  echo.Signal(SIGTERM);
  const ChildResult result = echo.Wait();
  EXPECT_EQ(result.exit_code, 0);
  const auto is_last = [](const status_t& s) {
    return s.num_received >= kNum && s.num_published > 2 * kNum;
  };
  ASSERT_TRUE(peer.Until(
      [&] { return !peer.statuses.empty() && is_last(peer.statuses.back()); }));
  EXPECT_EQ(peer.odometry.size(), kNum);
  ASSERT_EQ(peer.poses.size(), 1u);
  // 0 + 1 + ... + 399.
  EXPECT_THAT(peer.poses[0].reason, HasSubstr("sum 79800.000000"));
  const status_t& last = peer.statuses.back();
  EXPECT_EQ(last.process, "echo");
  EXPECT_EQ(last.fault, "");
  EXPECT_EQ(last.num_lost + last.num_dropped + last.num_bad, 0);
  EXPECT_NE(last.has_timing, 0);
  EXPECT_GE(last.worst_handler_us, 3000);
  EXPECT_EQ(last.utime, 1'700'000'000'000'000 + kNum - 1);
}

TEST_F(RunProcessNetworkTest, SecondSignalSkipsWhatWaits) {
  Peer peer;
  ChildProcess echo({EchoPath(), "--set", "sleep_us=50000"});
  ASSERT_TRUE(peer.Until([&] { return !peer.statuses.empty(); }));
  for (int i = 0; i < 2000; ++i) peer.Send(i);  // 100 s of work.
  ASSERT_TRUE(peer.Until([&] { return !peer.odometry.empty(); }));
  const auto begin = Steady::now();
  echo.Signal(SIGTERM);
  ASSERT_TRUE(peer.Until([&] { return peer.odometry.size() > 10; }));
  echo.Signal(SIGTERM);
  EXPECT_EQ(echo.Wait().exit_code, 0);
  EXPECT_LT(Steady::now() - begin, std::chrono::seconds(50));
  EXPECT_TRUE(peer.Until([&] { return !peer.poses.empty(); }));
}

TEST_F(RunProcessNetworkTest, HandlerThatThrowsEndsItWithItsMessage) {
  Peer peer;
  ChildProcess echo({EchoPath(), "--set", "throw_at=2"});
  ASSERT_TRUE(peer.Until([&] { return !peer.statuses.empty(); }));
  for (int i = 0; i < 3; ++i) peer.Send(i);
  const ChildResult result = echo.Wait();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("\necho: handler threw as configured\n"));
  EXPECT_TRUE(peer.Until([&] {
    return peer.statuses.back().fault == "handler threw as configured";
  }));
  EXPECT_EQ(peer.odometry.size(), 2u);
}

TEST_F(RunProcessNetworkTest, MissingRouteIsOneLineThatSaysHowToMendIt) {
  RemoveMulticastRoute();
  const ChildResult result = RunChild({EchoPath()});
  AddMulticastRoute();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
  EXPECT_THAT(result.err, HasSubstr("LCM cannot use 239.255.76.67:7667"));
  EXPECT_THAT(result.err, HasSubstr("ip route add 224.0.0.0/4 dev lo"));
  // And that is the whole remedy.
  ChildProcess echo({EchoPath()});
  Peer peer;
  EXPECT_TRUE(peer.Until([&] { return !peer.statuses.empty(); }));
}

TEST_F(RunProcessNetworkTest, SecondInstanceIsAFaultOfBothAndWarnedOfOnce) {
  Peer peer;
  ChildProcess first({EchoPath()});
  auto second =
      std::make_unique<ChildProcess>(std::vector<std::string>{EchoPath()});
  const auto has_fault = [&](bool wanted) {
    const std::size_t num = peer.statuses.size();
    return num >= 2 && peer.statuses[num - 1].fault.empty() != wanted &&
           peer.statuses[num - 2].fault.empty() != wanted;
  };
  ASSERT_TRUE(peer.Until([&] { return has_fault(true); }));
  EXPECT_THAT(peer.statuses.back().fault, HasSubstr("another echo publishes"));
  second->Signal(SIGTERM);
  EXPECT_EQ(second->Wait().exit_code, 0);
  // Alone again for some seconds: healthy.
  ASSERT_TRUE(peer.Until([&] { return has_fault(false); }));
  first.Signal(SIGTERM);
  const std::string err = first.Wait().err;
  std::size_t num_warnings = 0;
  for (std::size_t at = err.find("another echo"); at != std::string::npos;
       at = err.find("another echo", at + 1)) {
    ++num_warnings;
  }
  EXPECT_EQ(num_warnings, 1u) << err;
}

TEST_F(RunProcessNetworkTest, AnotherPortIsAnotherBus) {
  Peer peer;
  ChildProcess echo({EchoPath(), "--lcm-url", "udpm://239.255.76.67:7668"});
  ASSERT_TRUE(peer.Until(
      [&] { return echo.ErrSoFar().find("live on") != std::string::npos; }));
  for (int i = 0; i < 3; ++i) peer.Send(i);
  echo.Signal(SIGTERM);
  echo.Wait();
  EXPECT_TRUE(peer.odometry.empty());
  EXPECT_TRUE(peer.statuses.empty());
}

}  // namespace
}  // namespace waymark
