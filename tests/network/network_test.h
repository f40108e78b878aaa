// Fixture and main() of tests with real sockets.
#pragma once

#include "tests/network/network_namespace.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <cstdint>

namespace waymark {

// All tests of one executable run in one network namespace of their own, on
// LCM's default URL; they skip where that is not allowed.
class NetworkTest : public testing::Test {
 protected:
  void SetUp() override;
  // Sets net.core.rmem_max of the host until the executable ends. False, with
  // the test marked as skipped, where it may not be set.
  [[nodiscard]] static bool SetReceiveBufferLimit(std::int64_t num_bytes);
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
