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

// A sweep that goes on: what was there counts, but says nothing of the pace.
TEST(Progress, GoesOnFromWhatWasAlreadyDone) {
  EXPECT_EQ(RunsText("drive", seconds(1), 200, 200, 1000),
            "drive: 200 of 1000");
  EXPECT_EQ(RunsText("drive", seconds(14), 200, 214, 1000),
            "drive: 214 of 1000, 13 min left");
}

}  // namespace
}  // namespace waymark
