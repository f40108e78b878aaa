#include "processes/support/timers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::ElementsAre;

constexpr Time At(std::int64_t utime) {
  return TimeFromMicroseconds(utime);
}

// Notes its calls as "name@time".
class Diary {
 public:
  Timers::Action Writer(const std::string& name) {
    return [this, name](Time t) {
      lines.push_back(name + '@' + std::to_string(Microseconds(t)));
    };
  }
  std::vector<std::string> lines;
};

TEST(Timers, ComeToAnEndWithTime) {
  Timers timers;
  Diary diary;
  timers.Add(Duration(10), diary.Writer("a"));
  timers.Start(Time::max() - Duration(15));
  EXPECT_EQ(timers.next(), Time::max() - Duration(5));
  timers.RunDue(Time::max());
  EXPECT_EQ(diary.lines.size(), 1u);
  EXPECT_EQ(timers.next(), std::nullopt);
  timers.RunDue(Time::max());
  EXPECT_EQ(diary.lines.size(), 1u);
  timers.RunDue(Time::min());  // Begins anew.
  EXPECT_EQ(timers.next(), Time::min() + Duration(10));
  timers.RunDue(Time::min() + Duration(10));
  EXPECT_EQ(diary.lines.size(), 2u);
}

TEST(Timers, CallInTheOrderOfDueTimesThenOfAdding) {
  Timers timers;
  Diary diary;
  timers.Add(Duration(20), diary.Writer("slow"));
  timers.Add(Duration(10), diary.Writer("fast"));
  EXPECT_EQ(timers.next(), std::nullopt);
  timers.Start(At(100));
  EXPECT_EQ(timers.next(), At(110));
  timers.RunDue(At(109));
  EXPECT_THAT(diary.lines, ElementsAre());
  timers.RunDue(At(110));
  timers.RunDue(At(120));
  EXPECT_THAT(diary.lines, ElementsAre("fast@110", "slow@120", "fast@120"));
}

TEST(Timers, MissedPeriodsAreOneCallAndKeepThePhase) {
  Timers timers;
  Diary diary;
  timers.Add(Duration(10), diary.Writer("a"));
  timers.Start(At(0));
  timers.RunDue(At(47));
  EXPECT_THAT(diary.lines, ElementsAre("a@47"));
  EXPECT_EQ(timers.next(), At(50));
}

TEST(Timers, StartAnewWhereTheClockWentBack) {
  Timers timers;
  Diary diary;
  timers.Add(Duration(10), diary.Writer("a"));
  timers.Start(At(1000));
  timers.RunDue(At(500));
  EXPECT_EQ(timers.next(), At(510));
}

TEST(Timers, TakeOneThatACallAdds) {
  Timers timers;
  Diary diary;
  timers.Add(Duration(10), [&](Time) {
    if (diary.lines.empty()) timers.Add(Duration(5), diary.Writer("child"));
    diary.lines.emplace_back("parent");
  });
  timers.Start(At(0));
  timers.RunDue(At(10));
  timers.RunDue(At(15));
  EXPECT_THAT(diary.lines, ElementsAre("parent", "child@15"));
}

TEST(Timers, RefuseAPeriodThatIsNotPositive) {
  Timers timers;
  EXPECT_THROW(timers.Add(Duration(0), [](Time) {}), std::logic_error);
}

}  // namespace
}  // namespace waymark
