#include "processes/support/progress.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

using std::chrono::seconds;

TEST(Progress, TimeLeftGoesByThePaceSoFar) {
  EXPECT_EQ(TimeLeftText(seconds(10), 0, 100), "");
  EXPECT_EQ(TimeLeftText(seconds(10), 50, 100), "10 s left");
  EXPECT_EQ(TimeLeftText(seconds(20), 1, 100), "33 min left");
  EXPECT_EQ(TimeLeftText(seconds(100), 1, 1000), "27.8 h left");
  EXPECT_EQ(TimeLeftText(seconds(10), 100, 100), "0 s left");
}

}  // namespace
}  // namespace waymark
