#include "planner/control/request_choice.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

Time At(double s) {
  return TimeFromMicroseconds(1) + DurationFromSeconds(s);
}

MotionRequest Request(const char* source, double s, double forward) {
  return {At(s), At(s), source, {forward, 0.0}, ""};
}

class RequestChoiceTest : public testing::Test {
 protected:
  std::string ChosenAt(double s) {
    const auto chosen = choice_.Choose(At(s));
    return chosen ? chosen->source : "";
  }
  RequestChoice choice_{DurationFromSeconds(0.5), "teleop"};
};

TEST_F(RequestChoiceTest, NothingOrTooOldIsNone) {
  EXPECT_EQ(ChosenAt(0.0), "");
  choice_.Set(Request("a", 1.0, 0.2));
  EXPECT_EQ(ChosenAt(1.5), "a");
  EXPECT_EQ(ChosenAt(1.501), "");
}

TEST_F(RequestChoiceTest, WhoAsksForNothingLeavesTheWheels) {
  choice_.Set(Request("a", 0.0, 0.2));
  choice_.Set(Request("b", 0.1, 0.0));
  EXPECT_EQ(ChosenAt(0.1), "a");
  choice_.Set(Request("b", 0.2, 0.3));
  EXPECT_EQ(ChosenAt(0.2), "a") << "who has them keeps them";
  choice_.Set(Request("a", 0.3, 0.0));
  EXPECT_EQ(ChosenAt(0.3), "b");
  choice_.Set(Request("b", 0.4, 0.0));
  EXPECT_EQ(ChosenAt(0.4), "b") << "the newest zero, for its reason";
}

TEST_F(RequestChoiceTest, ThePreferredTakesThem) {
  choice_.Set(Request("a", 0.0, 0.2));
  EXPECT_EQ(ChosenAt(0.0), "a");
  choice_.Set(Request("teleop", 0.1, 0.2));
  EXPECT_EQ(ChosenAt(0.1), "teleop");
  choice_.Set(Request("a", 0.2, 0.2));
  EXPECT_EQ(ChosenAt(0.2), "teleop");
  choice_.Set(Request("a", 0.6, 0.2));
  EXPECT_EQ(ChosenAt(0.61), "a") << "teleop is silent for 0.51 s";
}

TEST_F(RequestChoiceTest, TimeThatGoesBackForgetsTheFuture) {
  choice_.Set(Request("a", 100.0, 0.2));
  choice_.Set(Request("b", 1.0, 0.1));
  EXPECT_EQ(ChosenAt(1.0), "b");
}

}  // namespace
}  // namespace waymark
