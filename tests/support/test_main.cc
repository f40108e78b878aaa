// Shared main of all tests. A run in which every test was skipped prints
// "skipped: ..." as its last line, which CTest counts as skipped.
#include <gtest/gtest.h>

#include <cstdio>

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const int result = RUN_ALL_TESTS();
  const auto& run = *testing::UnitTest::GetInstance();
  if (result == 0 && run.skipped_test_count() > 0 &&
      run.successful_test_count() == 0) {
    std::printf("skipped: %d tests\n", run.skipped_test_count());
  }
  return result;
}
