// The simulator as it runs live, on a clock that the test sets.
#include "tests/processes/simulator/simulator_test.h"

#include <waymark/encoders_t.hpp>
#include <waymark/image_t.hpp>
#include <waymark/truth_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;

// Live as far as a process can tell.
class ManualBus final : public Bus {
 public:
  explicit ManualBus(Time start) : now_(start) {}

  // Lets so much pass, then calls the timers that are due once, as for a loop
  // that was held.
  void Pass(Duration time) {
    now_ += time;
    for (Timer& timer : timers_) {
      if (timer.next > now_) continue;
      timer.next = now_ + timer.period;
      timer.action(now_);
    }
  }
  void Run(Duration time) {
    const Time end = now_ + time;
    while (true) {
      Time next = end;
      bool is_due = false;
      for (const Timer& timer : timers_) {
        if (timer.next > next) continue;
        next = timer.next;
        is_due = true;
      }
      if (!is_due) break;
      Pass(next - now_);
    }
    now_ = end;
  }
  template <typename M>
  [[nodiscard]] std::vector<M> Messages(const std::string& channel) const {
    std::vector<M> messages;
    const auto found = sent_.find(channel);
    if (found == sent_.end()) return messages;
    for (const auto& data : found->second) {
      messages.push_back(DecodeMessage<M>(data).value());
    }
    return messages;
  }
  [[nodiscard]] const std::string& fault() const { return fault_; }

  void Every(Duration period, std::function<void(Time)> action) override {
    timers_.push_back({period, now_ + period, std::move(action)});
  }
  [[nodiscard]] Time now() const override { return now_; }
  void ReportBad(std::string_view, Bad, std::string_view) override {}
  void SetFault(std::string_view fault) override { fault_ = fault; }
  [[nodiscard]] bool is_offline() const override { return false; }

 private:
  void SubscribeRaw(Subscription) override {}
  void AdvertiseRaw(Advertisement) override {}
  void PublishRaw(std::string_view channel,
                  std::span<const std::uint8_t> data,
                  Time) override {
    sent_[std::string(channel)].emplace_back(data.begin(), data.end());
  }

  struct Timer {
    Duration period{0};
    Time next;
    std::function<void(Time)> action;
  };

  Time now_;
  std::vector<Timer> timers_;
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> sent_;
  std::string fault_;
};

using SimulatorLiveTest = SimulatorTest;

Time Newest(const ManualBus& bus) {
  return TimeFromMicroseconds(bus.Messages<truth_t>("TRUTH").back().utime);
}

Time Oldest(const ManualBus& bus) {
  return TimeFromMicroseconds(bus.Messages<truth_t>("TRUTH").front().utime);
}

TEST_F(SimulatorLiveTest, AfterAStopOfTheMachineItSendsATenthOfASecondNoMore) {
  config_.speed = 10.0;
  ManualBus bus(kStart);
  SimulatorProcess process(config_, &bus);
  bus.Run(seconds(1));
  EXPECT_EQ(bus.fault(), "");
  const std::size_t before = bus.Messages<encoders_t>("ENCODERS").size();
  bus.Pass(seconds(3600));
  EXPECT_EQ(bus.Messages<encoders_t>("ENCODERS").size(), before + 50);
  EXPECT_THAT(bus.fault(), HasSubstr("lost 35999.00 s in all"));
  bus.Run(seconds(6));
  EXPECT_EQ(bus.fault(), "");
}

TEST_F(SimulatorLiveTest, SlowTicksAreInTimeToo) {
  for (const auto& [rate_hz, speed] :
       {std::pair(0.5, 1.0), {5.0, 1.0}, {50.0, 0.1}}) {
    config_.encoder_rate_hz = rate_hz;
    config_.speed = speed;
    ManualBus bus(kStart);
    SimulatorProcess process(config_, &bus);
    bus.Run(seconds(40));
    const auto encoders = bus.Messages<encoders_t>("ENCODERS");
    ASSERT_FALSE(encoders.empty());
    EXPECT_NEAR(1e-6 * static_cast<double>(encoders.back().utime -
                                           encoders.front().utime),
                40.0 * speed,
                2.0 / rate_hz)
        << rate_hz << " Hz";
    EXPECT_EQ(bus.fault(), "") << rate_hz << " Hz";
  }
}

TEST_F(SimulatorLiveTest, ARestartDoesNotSetTimeBack) {
  config_.state_file = Path("state");
  for (const double speed : {1.0, 10.0}) {
    for (const bool is_killed : {false, true}) {
      config_.speed = speed;
      std::filesystem::remove(config_.state_file);
      ManualBus bus(kStart);
      {
        SimulatorProcess process(config_, &bus);
        bus.Run(milliseconds(6930));
        if (!is_killed) process.Finish();
      }
      ManualBus later(bus.now() + seconds(1));
      SimulatorProcess process(config_, &later);
      later.Run(milliseconds(100));
      EXPECT_GT(Oldest(later), Newest(bus)) << speed << is_killed;
      // What is sent before a state is on disk, and the stop.
      EXPECT_LE(Oldest(later), Newest(bus) + seconds(61)) << speed << is_killed;
      if (speed == 1.0) {
        EXPECT_LE(Newest(later), later.now());
      }
    }
  }
}

TEST_F(SimulatorLiveTest, AClockThatWasSetBackDoesNotSetTimeBack) {
  config_.state_file = Path("state");
  ManualBus bus(kStart);
  {
    SimulatorProcess process(config_, &bus);
    bus.Run(seconds(3));
    process.Finish();
  }
  for (const char* world : {"same", "other"}) {
    if (world == std::string("other")) {
      Write("other.yaml",
            "rooms: [{name: a, rectangle: [0, 0, 3, 3]}]\n"
            "starts: [[1, 1, 0]]\n");
      config_.world = Path("other.yaml");
    }
    ManualBus back(kStart - seconds(100));
    SimulatorProcess process(config_, &back);
    back.Run(milliseconds(100));
    EXPECT_GT(Oldest(back), Newest(bus)) << world;
  }
}

TEST_F(SimulatorLiveTest, FaultsAreJoinedAndGoWithTheirCauses) {
  config_.state_file = Path("state");
  ManualBus bus(kStart);
  SimulatorProcess process(config_, &bus);
  bus.Run(seconds(1));
  EXPECT_EQ(bus.fault(), "");
  // A disk that cannot be written, and a stop of the machine.
  const auto is_blocked = [&] {  // Once no write is under way.
    std::error_code error;
    return std::filesystem::create_directory(config_.state_file + ".new",
                                             error);
  };
  while (!is_blocked()) std::this_thread::sleep_for(milliseconds(1));
  bus.Pass(seconds(10));
  for (int i = 0; i < 500 && bus.fault().find("state") == std::string::npos;
       ++i) {
    bus.Pass(milliseconds(5));
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_THAT(
      bus.fault(),
      AllOf(HasSubstr("lost 9.90 s"), HasSubstr("; "), HasSubstr("written")));
  bus.Run(seconds(6));
  EXPECT_THAT(bus.fault(), HasSubstr("state: cannot be written"));
  EXPECT_THAT(bus.fault(), testing::Not(HasSubstr("lost")));
  std::filesystem::remove(config_.state_file + ".new");
  for (int i = 0; i < 500 && !bus.fault().empty(); ++i) {
    bus.Pass(SimulatedClock::kMaxCatchUp);
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_EQ(bus.fault(), "");
}

// The clock of this test is faster than any picture.
TEST_F(SimulatorLiveTest, AnImageThatWouldBeLateIsLeftOutAndCounted) {
  WriteCamera(10);
  config_.camera.name = "FRONT";
  config_.camera.timing.rate_hz = 30.0;
  ManualBus bus(kStart);
  SimulatorProcess process(config_, &bus);
  bus.Run(milliseconds(500));
  EXPECT_THAT(bus.fault(),
              AllOf(HasSubstr("IMAGE_FRONT: "), HasSubstr("not drawn")));
  // None comes twice or out of order, and those that come are good.
  std::vector<image_t> images;
  for (int i = 0; i < 1000 && images.size() < 3; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
    bus.Pass(milliseconds(40));
    images = bus.Messages<image_t>("IMAGE_FRONT");
  }
  ASSERT_EQ(images.size(), 3u);
  for (std::size_t i = 1; i < images.size(); ++i) {
    EXPECT_GT(images[i].utime, images[i - 1].utime);
  }
}

}  // namespace
}  // namespace waymark
