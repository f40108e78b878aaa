#include "estimation/base/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace waymark {
namespace {

TEST(Check, NamesConditionAndValues) {
  const int width = -3;
  try {
    WAYMARK_CHECK(width > 0, width, 0.5);
    FAIL() << "did not throw";
  } catch (const std::logic_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("width > 0 -3 0.5"));
    EXPECT_THAT(error.what(), testing::HasSubstr("check_test.cc"));
  }
}

TEST(Check, PassesSilentlyAndEvaluatesTheConditionOnce) {
  int calls = 0;
  WAYMARK_CHECK(++calls == 1);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace waymark
