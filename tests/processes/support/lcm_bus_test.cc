// On memq://, where a bus hears what it publishes itself. What needs a network
// is in tests/network.
#include "processes/support/lcm_bus.h"

#include "estimation/base/input_error.h"
#include "processes/support/channels.h"
#include "processes/support/status_reporter.h"

#include <waymark/config_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/truth_t.hpp>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

encoders_t Encoders(std::int32_t seq) {
  encoders_t message;
  message.utime = 1'700'000'000'000'000 + seq;
  message.seq = seq;
  return message;
}

// Handles until `done`, for a minute at most: the machine may be busy.
void HandleUntil(LcmBus* bus, const std::function<bool()>& done) {
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!done()) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    if (bus->HandleOne()) continue;
    pollfd wait{bus->wake_fd(), POLLIN, 0};
    ::poll(&wait, 1, 100);
  }
}

// Holds the bus's receiving thread where it wakes the handlers: the descriptor
// for that is full, and a write to it waits.
class HeldReceiver {
 public:
  explicit HeldReceiver(const LcmBus& bus) : fd_(bus.wake_fd()) {
    ::fcntl(fd_, F_SETFL, ::fcntl(fd_, F_GETFL) & ~O_NONBLOCK);
    const std::uint64_t full = std::numeric_limits<std::uint64_t>::max() - 1;
    EXPECT_EQ(::write(fd_, &full, sizeof(full)), ssize_t{sizeof(full)});
  }
  void Release() const {
    ::fcntl(fd_, F_SETFL, ::fcntl(fd_, F_GETFL) | O_NONBLOCK);
    std::uint64_t count = 0;
    EXPECT_EQ(::read(fd_, &count, sizeof(count)), ssize_t{sizeof(count)});
  }

 private:
  int fd_;
};

// Whether a thread of this process waits for something.
bool IsAsleep(pid_t thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/stat");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const std::size_t name_end = text.rfind(')');
  return name_end != std::string::npos && text.substr(name_end, 3) == ") S";
}

TEST(LcmBus, HandlesInOrderOfArrivalAcrossSubscriptions) {
  LcmBus bus("test", "memq://");
  std::vector<std::string> order;
  bus.Advertise<encoders_t>("A");
  bus.Advertise<truth_t>("B");
  bus.Subscribe<truth_t>("B", Keep::All(), [&](const truth_t& m, Time) {
    order.push_back("B" + std::to_string(m.seq));
  });
  bus.Subscribe<encoders_t>("A", Keep::All(), [&](const encoders_t& m, Time) {
    order.push_back("A" + std::to_string(m.seq));
  });
  bus.Start();
  std::vector<std::string> expected;
  for (int i = 0; i < 50; ++i) {
    bus.Publish("A", Encoders(i));
    expected.push_back("A" + std::to_string(i));
    if (i % 3 != 0) continue;
    truth_t truth;
    truth.seq = i / 3;
    bus.Publish("B", truth);
    expected.push_back("B" + std::to_string(i / 3));
  }
  HandleUntil(&bus, [&] { return order.size() == expected.size(); });
  EXPECT_EQ(order, expected);
  const status_t status = bus.MakeStatus();
  EXPECT_EQ(status.num_received, 67);
  EXPECT_EQ(status.num_published, 67);
  EXPECT_EQ(status.num_lost + status.num_dropped + status.num_bad, 0);
  EXPECT_NE(status.has_timing, 0);
  EXPECT_GT(status.pid, 0);
  EXPECT_EQ(status.utime, Encoders(49).utime);
}

TEST(LcmBus, ChannelNamesAreNoPatterns) {
  LcmBus bus("test", "memq://");
  std::vector<int> seen;
  for (const char* channel : {"AXB", "A.B", "A+B", "A"}) {
    bus.Advertise<encoders_t>(channel);
  }
  bus.Subscribe<encoders_t>(
      "A.B", Keep::All(), [&](const auto& m, Time) { seen.push_back(m.seq); });
  bus.Subscribe<encoders_t>(
      "A+B", Keep::All(), [&](const auto& m, Time) { seen.push_back(m.seq); });
  bus.Start();
  bus.Publish("AXB", Encoders(1));
  bus.Publish("A.B", Encoders(2));
  bus.Publish("A", Encoders(3));
  bus.Publish("A+B", Encoders(4));
  HandleUntil(&bus, [&] { return !seen.empty() && seen.back() == 4; });
  EXPECT_THAT(seen, ElementsAre(2, 4));
}

TEST(LcmBus, BusyHandlerKeepsTheLatestAndCountsTheRest) {
  LcmBus bus("test", "memq://");
  std::vector<int> seen;
  bus.Advertise<encoders_t>("A");
  bus.Subscribe<encoders_t>("A", Keep::Latest(), [&](const auto& m, Time) {
    seen.push_back(m.seq);
    if (m.seq != 0) return;
    // While this handler is busy, all others arrive.
    for (int i = 1; i <= 20; ++i) bus.Publish("A", Encoders(i));
    while (bus.MakeStatus().num_received < 21) std::this_thread::yield();
  });
  bus.Start();
  bus.Publish("A", Encoders(0));
  HandleUntil(&bus, [&] { return !seen.empty() && seen.back() == 20; });
  EXPECT_THAT(seen, ElementsAre(0, 20));
  const status_t status = bus.MakeStatus();
  EXPECT_EQ(status.num_dropped, 19);
  EXPECT_EQ(status.num_lost, 0);
}

TEST(LcmBus, HandlerExceptionReachesTheCallerAndTheBusLivesOn) {
  LcmBus bus("test", "memq://");
  int num_handled = 0;
  bus.Advertise<encoders_t>("A");
  bus.Subscribe<encoders_t>("A", Keep::All(), [&](const auto& m, Time) {
    ++num_handled;
    if (m.seq == 0) throw std::runtime_error("as planned");
  });
  bus.Start();
  bus.Publish("A", Encoders(0));
  EXPECT_THROW(HandleUntil(&bus, [] { return false; }), std::runtime_error);
  // Had it passed through LCM, the next handle would abort.
  bus.Publish("A", Encoders(1));
  HandleUntil(&bus, [&] { return num_handled == 2; });
}

TEST(LcmBus, WrongTypeAndTornMessagesAreCounted) {
  LcmBus bus("test", "memq://");
  int num_handled = 0;
  bus.Advertise<encoders_t>("A");
  bus.Subscribe<encoders_t>(
      "A", Keep::All(), [&](const auto&, Time) { ++num_handled; });
  bus.Start();
  bus.Publish("A", Encoders(0));
  bus.Publish("A", truth_t());
  bus.Publish("A", truth_t());
  bus.Publish("A", Encoders(3));
  HandleUntil(&bus, [&] { return num_handled == 2; });
  const status_t status = bus.MakeStatus();
  EXPECT_EQ(status.num_bad, 2);
  EXPECT_EQ(status.num_lost, 0);  // They took the places of 1 and 2.
  EXPECT_EQ(status.num_received, 4);
}

TEST(LcmBus, TwinIsAFaultAndTheBusItselfIsNone) {
  LcmBus bus("test", "memq://");
  bus.WatchForTwins();
  bus.Start();
  bus.Publish(kStatus, bus.MakeStatus());
  status_t other = bus.MakeStatus();
  other.process = "other";
  other.pid += 1;
  bus.Publish(kStatus, other);
  while (!bus.HandleOne()) {
  }
  while (!bus.HandleOne()) {
  }
  EXPECT_EQ(bus.MakeStatus().fault, "");
  other.process = "test";
  other.host = "elsewhere";
  bus.Publish(kStatus, other);
  while (!bus.HandleOne()) {
  }
  EXPECT_THAT(bus.MakeStatus().fault, HasSubstr("another test publishes here"));
  EXPECT_THAT(bus.MakeStatus().fault, HasSubstr("on elsewhere"));
  // What the process says of itself stands beside it, and STATUS is no
  // channel of the process's own.
  bus.SetFault("no wheels");
  EXPECT_THAT(bus.MakeStatus().fault, HasSubstr("no wheels; another test"));
  EXPECT_EQ(bus.MakeStatus().num_channels, 0);
}

TEST(LcmBus, WorstHandlerTimeStartsAnewWithEachStatus) {
  LcmBus bus("test", "memq://");
  int num_handled = 0;
  bus.Advertise<encoders_t>("A");
  bus.Subscribe<encoders_t>("A", Keep::All(), [&](const auto& m, Time) {
    ++num_handled;
    if (m.seq == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  });
  bus.Start();
  bus.Publish("A", Encoders(0));
  HandleUntil(&bus, [&] { return num_handled == 1; });
  EXPECT_GE(bus.MakeStatus().worst_handler_us, 20'000);
  EXPECT_LT(bus.MakeStatus().worst_handler_us, 20'000);
}

TEST(LcmBus, ConfigurationTakesNothingFromTheStatusBesideIt) {
  LcmBus bus("test", "memq://");
  std::vector<status_t> statuses;
  std::vector<std::int64_t> configuration_utimes;
  bus.Advertise<encoders_t>("A");
  bus.Subscribe<encoders_t>("A", Keep::All(), [](const auto&, Time) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  });
  bus.Subscribe<status_t>(kStatus, Keep::All(), [&](const status_t& m, Time) {
    statuses.push_back(m);
  });
  bus.Subscribe<config_t>(kConfig, Keep::All(), [&](const config_t& m, Time) {
    configuration_utimes.push_back(m.utime);
  });
  bus.Start();
  bus.Publish("A", Encoders(7));
  while (!bus.HandleOne()) {
  }
  StatusReporter reporter(&bus, "");
  reporter.Report(std::chrono::seconds(1));  // Both are due.
  HandleUntil(&bus, [&] { return !statuses.empty(); });
  EXPECT_GE(statuses[0].worst_handler_us, 20'000);
  EXPECT_EQ(statuses[0].utime, Encoders(7).utime);
  EXPECT_THAT(configuration_utimes, ElementsAre(Encoders(7).utime));
}

TEST(LcmBus, MisuseIsRefused) {
  EXPECT_THROW(LcmBus("test", "nonsense"), InputError);
  LcmBus bus("test", "memq://");
  EXPECT_THROW(bus.Publish("A", Encoders(0)), std::logic_error);
  const std::string long_name(64, 'A');
  EXPECT_THROW(bus.Subscribe<encoders_t>(
                   long_name, Keep::All(), [](const encoders_t&, Time) {}),
               std::logic_error);
  bus.Start();
  EXPECT_THROW(bus.Subscribe<encoders_t>(
                   "A", Keep::All(), [](const encoders_t&, Time) {}),
               std::logic_error);
}

TEST(LcmBus, HandsOnAllThatLcmHeldWhenTheEndIsAskedFor) {
  constexpr int kNum = 100;
  LcmBus bus("test", "memq://");
  std::vector<int> seen;
  std::vector<int> expected;
  bus.Advertise<encoders_t>("A");
  bus.Subscribe<encoders_t>(
      "A", Keep::All(), [&](const auto& m, Time) { seen.push_back(m.seq); });
  const HeldReceiver held(bus);
  for (int i = 0; i < kNum; ++i) {
    bus.Publish("A", Encoders(i));
    expected.push_back(i);
  }
  bus.Start();  // It comes as far as the first message.
  std::atomic<pid_t> stopper{0};
  std::thread stop([&] {
    stopper = ::gettid();
    bus.Stop();
  });
  // The one thing that Stop() waits for is the receiver's end, which it has
  // asked for by then.
  while (stopper == 0 || !IsAsleep(stopper)) std::this_thread::yield();
  held.Release();
  stop.join();
  while (bus.HandleOne()) {
  }
  EXPECT_EQ(seen, expected);
}

TEST(LcmBus, StopsWhileMessagesCome) {
  for (int run = 0; run < 20; ++run) {
    LcmBus bus("test", "memq://");
    bus.Advertise<encoders_t>("A");
    bus.Subscribe<encoders_t>("A", Keep::All(), [](const encoders_t&, Time) {});
    bus.Start();
    for (int i = 0; i < 10; ++i) bus.Publish("A", Encoders(i));
    if (run % 2 == 0) bus.Stop();
  }
}

TEST(LcmBus, TimersRunOnItsOwnClock) {
  LcmBus bus("clock", "memq://");
  std::vector<Time> calls;
  bus.Every(std::chrono::milliseconds(5),
            [&](Time now) { calls.push_back(now); });
  EXPECT_EQ(bus.UntilNextTimer(), std::nullopt);
  const Time start = bus.now();
  bus.Start();
  bus.RunTimers();
  EXPECT_TRUE(calls.empty());
  while (calls.size() < 3) {
    ASSERT_TRUE(bus.UntilNextTimer().has_value());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    bus.RunTimers();
  }
  EXPECT_GE(calls[2] - start, std::chrono::milliseconds(15));
  EXPECT_LE(calls[2], bus.now());
}

}  // namespace
}  // namespace waymark
