// The bus on a real network. Most of its tests need none: they are in
// tests/processes/support.
#include "processes/support/lcm_bus.h"

#include "processes/support/lcm_url.h"
#include "tests/network/network_test.h"

#include <waymark/encoders_t.hpp>

#include <gtest/gtest.h>
#include <sched.h>

#include <vector>

namespace waymark {
namespace {

// While one exists, the calling thread runs until it waits, before other
// threads of its processor and after none.
class UntilItWaits {
 public:
  UntilItWaits() {
    policy_ = ::sched_getscheduler(0);
    ::sched_getparam(0, &before_);
    sched_param as_lcm_bus_reads{};
    as_lcm_bus_reads.sched_priority = 1;
    is_set_ = ::sched_setscheduler(0, SCHED_FIFO, &as_lcm_bus_reads) == 0;
  }
  ~UntilItWaits() {
    if (is_set_) ::sched_setscheduler(0, policy_, &before_);
  }
  UntilItWaits(const UntilItWaits&) = delete;
  UntilItWaits& operator=(const UntilItWaits&) = delete;
  [[nodiscard]] bool is_set() const { return is_set_; }

 private:
  int policy_ = SCHED_OTHER;
  sched_param before_{};
  bool is_set_ = false;
};

class LcmBusNetworkTest : public NetworkTest {};

TEST_F(LcmBusNetworkTest, HandsOnAllThatTheKernelHeldWhenTheEndIsAskedFor) {
  constexpr int kNum = 100;
  const OneProcessor shared;  // With LCM's reader and the receiver.
  LcmBus bus("test", LcmUrl(""));
  std::vector<int> seen;
  std::vector<int> expected;
  bus.Advertise<encoders_t>("A");
  bus.Subscribe<encoders_t>(
      "A", Keep::All(), [&](const auto& m, Time) { seen.push_back(m.seq); });
  {
    // Nobody reads before Stop() waits for the receiver's end.
    const UntilItWaits alone;
    if (!alone.is_set()) GTEST_SKIP() << "no real-time priority here";
    bus.Start();
    encoders_t message;
    for (message.seq = 0; message.seq < kNum; ++message.seq) {
      bus.Publish("A", message);
      expected.push_back(message.seq);
    }
    EXPECT_GE(bus.socket().num_waiting_bytes, kNum * message.getEncodedSize());
    EXPECT_FALSE(bus.HandleOne());
    bus.Stop();
  }
  while (bus.HandleOne()) {
  }
  EXPECT_EQ(seen, expected);
}

}  // namespace
}  // namespace waymark
