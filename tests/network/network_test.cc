#include "tests/network/network_test.h"

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
  if (result == 0 && run.skipped_test_count() > 0 &&
      run.successful_test_count() == 0) {
    std::printf("skipped: %d tests: %s\n",
                run.skipped_test_count(),
                waymark::why_no_network.c_str());
  }
  return result;
}
