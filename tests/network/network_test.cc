#include "tests/network/network_test.h"

#include "tests/network/stall_watch.h"

#include <cstdio>
#include <cstdlib>
#include <string>

namespace waymark {
namespace {

std::string why_no_network;
ReceiveBufferLimit* limit = nullptr;

}  // namespace

void NetworkTest::SetUp() {
  if (!why_no_network.empty()) GTEST_SKIP() << why_no_network;
}

bool NetworkTest::SetReceiveBufferLimit(std::int64_t num_bytes) {
  if (limit->Set(num_bytes)) return true;
  [] { GTEST_SKIP() << "net.core.rmem_max cannot be set here"; }();
  return false;
}

bool NetworkTest::OnARunningMachine(std::chrono::milliseconds bearable,
                                    const std::function<void()>& attempt,
                                    const std::function<bool()>& is_good) {
  static constexpr int kMaxAttempts = 4;
  for (int i = 0; i < kMaxAttempts; ++i) {
    const StallWatch stalls;
    attempt();
    if (HasFatalFailure()) return false;
    const double longest_ms =
        1e-3 * static_cast<double>(stalls.longest().count());
    std::printf("the machine stood still for %.1f ms at most\n", longest_ms);
    if (is_good() || stalls.longest() <= bearable) return true;
  }
  [] {
    GTEST_SKIP() << "the machine stood still in each of " << kMaxAttempts
                 << " attempts";
  }();
  return false;
}

OneProcessor::OneProcessor() {
  ::sched_getaffinity(0, sizeof(before_), &before_);
  cpu_set_t one;
  CPU_ZERO(&one);
  int first = 0;
  while (!CPU_ISSET(first, &before_)) ++first;
  CPU_SET(first, &one);
  ::sched_setaffinity(0, sizeof(one), &one);
}

OneProcessor::~OneProcessor() {
  ::sched_setaffinity(0, sizeof(before_), &before_);
}

}  // namespace waymark

// As test_main.cc, but first, while there is one thread, into the namespace.
int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  waymark::ReceiveBufferLimit rmem_max;
  waymark::limit = &rmem_max;
  waymark::why_no_network = waymark::EnterNetworkNamespace();
  ::unsetenv("LCM_DEFAULT_URL");
  const int result = RUN_ALL_TESTS();
  const auto& run = *testing::UnitTest::GetInstance();
  // Whoever reads the sum of all tests sees that not all was judged here.
  if (result == 0 && run.skipped_test_count() > 0) {
    std::printf("\nskipped: %d of %d tests\n",
                run.skipped_test_count(),
                run.test_to_run_count());
  }
  return result;
}
