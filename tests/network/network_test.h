// Fixture and main() of tests with real sockets.
#pragma once

#include "tests/network/network_namespace.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <chrono>
#include <cstdint>
#include <functional>

namespace waymark {

// All tests of one executable run in one network namespace of their own, on
// LCM's default URL; they skip where that is not allowed.
class NetworkTest : public testing::Test {
 protected:
  void SetUp() override;
  // Sets net.core.rmem_max of the host until the executable ends. False, with
  // the test marked as skipped, where it may not be set.
  [[nodiscard]] static bool SetReceiveBufferLimit(std::int64_t num_bytes);
  // Runs `attempt`, and anew where it turned out not to be `is_good` while the
  // machine stood still for longer than `bearable`: that says nothing of what
  // is tested. True where the last attempt is to be judged; false where it
  // failed fatally, or, with the test marked as skipped, where the machine
  // stood still in each of four attempts.
  [[nodiscard]] static bool OnARunningMachine(
      std::chrono::milliseconds bearable,
      const std::function<void()>& attempt,
      const std::function<bool()>& is_good);
};

// Binds the calling thread, and those it starts, to its first processor for as
// long as it lives.
class OneProcessor {
 public:
  OneProcessor();
  ~OneProcessor();
  OneProcessor(const OneProcessor&) = delete;
  OneProcessor& operator=(const OneProcessor&) = delete;

 private:
  cpu_set_t before_{};
};

}  // namespace waymark
