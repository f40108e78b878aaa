#include "processes/collision_guard/collision_guard_process.h"

#include "estimation/geometry/angle.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kStart = 1'000'000'000;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::int64_t Utime(double s) {
  return kStart + static_cast<std::int64_t>(s * 1e6 + 0.5);
}
Time At(double s) {
  return TimeFromMicroseconds(Utime(s));
}

velocity_t Request(double s,
                   double forward,
                   double turn_rate = 0.0,
                   const char* source = "test") {
  velocity_t message;
  message.utime = Utime(s);
  message.source = source;
  message.forward = forward;
  message.turn_rate = turn_rate;
  return message;
}

planar_lidar_t Ranges(double s, double range) {
  planar_lidar_t message;
  message.utime = Utime(s);
  message.nranges = 72;
  message.ranges.assign(72, static_cast<float>(range));
  message.nintensities = 0;
  message.rad0 = 0.0f;
  message.radstep = static_cast<float>(kPi / 36);
  return message;
}

stop_t Stop(double s, bool is_stopped) {
  stop_t message;
  message.utime = Utime(s);
  message.source = "person";
  message.is_stopped = is_stopped ? 1 : 0;
  return message;
}

class CollisionGuardProcessTest : public testing::Test {
 protected:
  CollisionGuardProcessTest() { config_.stop_file = folder_ / "stop"; }
  void Start() {
    process_ = std::make_unique<CollisionGuardProcess>(
        config_, world_.AddProcess("collision_guard"));
  }
  std::vector<velocity_t> Commands() {
    return world_.Messages<velocity_t>(kMotionCommand);
  }
  velocity_t Last() { return Commands().back(); }
  std::int64_t NumBad() { return world_.Status("collision_guard").num_bad; }
  std::string Fault() { return world_.Status("collision_guard").fault; }

  TemporaryDirectory folder_{TemporaryDirectory::FastParent()};
  CollisionGuardConfig config_;
  LocalBus world_{At(0)};
  std::unique_ptr<CollisionGuardProcess> process_;
};

TEST_F(CollisionGuardProcessTest, AnswersEachRequestAtOnceWithItsTime) {
  Start();
  for (int i = 1; i <= 20; ++i) {
    world_.Publish(kRanges, Ranges(0.04 * i, 4.0));
    world_.Publish(kMotionRequest, Request(0.04 * i, 0.3, 0.1));
  }
  world_.RunUntil(At(0.8));
  std::vector<velocity_t> answers;
  for (const velocity_t& command : Commands()) {
    if (command.source == "test") answers.push_back(command);
  }
  ASSERT_EQ(answers.size(), 20u);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(answers[i].utime, Utime(0.04 * (i + 1)));
    EXPECT_EQ(answers[i].forward, 0.3);
    EXPECT_EQ(answers[i].turn_rate, 0.1);
    EXPECT_EQ(answers[i].reason, "");
  }
  EXPECT_EQ(Fault(), "");
}

TEST_F(CollisionGuardProcessTest, StandsWhenNobodyAsksAnyLonger) {
  config_.request_timeout_s = 0.5;
  config_.guard.ranges = RangeUse::kNone;
  Start();
  world_.RunUntil(At(0.1));
  EXPECT_EQ(Last().reason, "no request");
  EXPECT_EQ(Last().utime, Utime(0.1)) << "nothing to answer: the clock's time";
  world_.Publish(kMotionRequest, Request(0.12, 0.3));
  world_.RunUntil(At(0.61));
  EXPECT_EQ(Last().forward, 0.3);
  world_.RunUntil(At(0.66));
  EXPECT_EQ(Last().forward, 0.0);
  EXPECT_EQ(Last().reason, "no request for 0.5 s");
  EXPECT_EQ(Last().utime, Utime(0.12));
  const std::size_t num = Commands().size();
  world_.RunUntil(At(1.66));
  EXPECT_EQ(Commands().size(), num + 20) << "20 Hz";
}

TEST_F(CollisionGuardProcessTest, SlowsDownBetweenRequests) {
  Start();
  world_.Publish(kRanges, Ranges(0.01, 4.0));
  world_.Publish(kMotionRequest, Request(0.01, 0.4));
  world_.Publish(kRanges, Ranges(0.21, 0.5));  // Somebody steps in its way.
  world_.RunUntil(At(0.2));
  EXPECT_EQ(Last().forward, 0.4);
  world_.RunUntil(At(0.25));
  EXPECT_LT(Last().forward, 0.35);
  EXPECT_EQ(Last().utime, Utime(0.01));
  EXPECT_EQ(Last().source, "test");
  EXPECT_THAT(Last().reason, HasSubstr("obstacle"));
}

TEST_F(CollisionGuardProcessTest, StandsWithoutRanges) {
  Start();
  world_.Publish(kMotionRequest, Request(0.01, 0.4));
  world_.RunUntil(At(0.06));
  EXPECT_EQ(Last().forward, 0.0);
  EXPECT_EQ(Last().reason, "no ranges yet");
  EXPECT_EQ(Fault(), "no RANGES yet");
  world_.Publish(kRanges, Ranges(0.1, 4.0));
  for (int i = 1; i < 20; ++i) {
    world_.Publish(kMotionRequest, Request(0.1 * i, 0.4));
  }
  world_.RunUntil(At(0.56));
  EXPECT_EQ(Last().forward, 0.4);
  world_.RunUntil(At(1.9));
  EXPECT_EQ(Last().forward, 0.0);
  EXPECT_THAT(Last().reason, HasSubstr("ranges are"));
  EXPECT_EQ(Fault(), "no RANGES for 2 s");
}

TEST_F(CollisionGuardProcessTest, StopWinsAtOnceAndHolds) {
  config_.guard.ranges = RangeUse::kNone;
  Start();
  for (int i = 1; i < 40; ++i) {
    world_.Publish(kMotionRequest, Request(0.1 * i, 0.4));
  }
  world_.Publish(kStop, Stop(1.02, true));
  world_.RunUntil(At(1.02));
  EXPECT_EQ(Last().forward, 0.0) << "does not wait for a request";
  EXPECT_EQ(Last().utime, Utime(1.02));
  world_.RunUntil(At(2.0));
  for (const velocity_t& command : Commands()) {
    if (command.utime < Utime(1.02)) continue;
    EXPECT_EQ(command.forward, 0.0);
  }
  EXPECT_EQ(Last().reason, "stopped by person");
  EXPECT_EQ(Last().utime, Utime(2.0)) << "requests are answered all the same";
  EXPECT_EQ(Fault(), "stopped by person");
  world_.Publish(kStop, Stop(2.02, false));
  world_.RunUntil(At(2.15));
  EXPECT_EQ(Last().forward, 0.4);
  EXPECT_EQ(Fault(), "");
}

TEST_F(CollisionGuardProcessTest, AStopOutlivesTheProcess) {
  config_.guard.ranges = RangeUse::kNone;
  Start();
  world_.Publish(kStop, Stop(0.1, true));
  world_.RunUntil(At(0.2));
  LocalBus other(At(0));
  CollisionGuardProcess again(config_, other.AddProcess("collision_guard"));
  other.Publish(kMotionRequest, Request(0.1, 0.4));
  other.RunUntil(At(0.2));
  const velocity_t last = other.Messages<velocity_t>(kMotionCommand).back();
  EXPECT_EQ(last.forward, 0.0);
  EXPECT_EQ(last.reason, "stopped by person (before a restart)");
}

TEST_F(CollisionGuardProcessTest, OnlyBackwardsAfterABumper) {
  config_.guard.ranges = RangeUse::kNone;
  Start();
  base_status_t base;
  base.utime = Utime(0.1);
  base.is_bumper_left = 1;
  world_.Publish(kBase, base);
  world_.Publish(kMotionRequest, Request(0.2, 0.4));
  world_.RunUntil(At(0.2));
  EXPECT_EQ(Last().forward, 0.0);
  EXPECT_THAT(Last().reason, HasSubstr("bumper"));
  world_.Publish(kMotionRequest, Request(0.3, -0.2));
  world_.RunUntil(At(0.3));
  EXPECT_EQ(Last().forward, -0.2);
  world_.Publish(kMotionRequest, Request(1.2, 0.4));
  world_.RunUntil(At(1.2));
  EXPECT_EQ(Last().forward, 0.4);
}

TEST_F(CollisionGuardProcessTest, AnIdleSourceDoesNotStopAnother) {
  config_.guard.ranges = RangeUse::kNone;
  Start();
  for (int i = 1; i < 10; ++i) {
    world_.Publish(kMotionRequest, Request(0.1 * i, 0.4, 0.0, "tour_driver"));
    world_.Publish(kMotionRequest,
                   Request(0.1 * i + 0.05, 0.0, 0.0, "path_follower"));
  }
  world_.RunUntil(At(0.95));
  for (const velocity_t& command : Commands()) {
    if (command.utime < Utime(0.1)) continue;
    EXPECT_EQ(command.forward, 0.4);
    EXPECT_EQ(command.source, "tour_driver");
  }
  EXPECT_EQ(Last().utime, Utime(0.95));
  // A person takes over, and lets go.
  world_.Publish(kMotionRequest, Request(1.0, -0.1, 0.0, "teleop"));
  world_.Publish(kMotionRequest, Request(1.05, 0.4, 0.0, "tour_driver"));
  world_.RunUntil(At(1.05));
  EXPECT_EQ(Last().forward, -0.1);
  world_.Publish(kMotionRequest, Request(1.1, 0.0, 0.0, "teleop"));
  world_.RunUntil(At(1.1));
  EXPECT_EQ(Last().forward, 0.4);
}

TEST_F(CollisionGuardProcessTest, BadMessagesAreCountedAndMoveNothing) {
  Start();
  world_.Publish(kRanges, Ranges(0.1, 4.0));
  world_.Publish(kMotionRequest, Request(0.1, kNan));
  world_.RunUntil(At(0.1));
  EXPECT_EQ(Last().utime, Utime(0.1)) << "answered all the same";
  EXPECT_EQ(Last().forward, 0.0);
  EXPECT_THAT(Last().reason, HasSubstr("bad request: forward"));
  EXPECT_EQ(NumBad(), 1);
  planar_lidar_t ranges = Ranges(0.2, 4.0);
  ranges.rad0 = static_cast<float>(kNan);
  world_.Publish(kRanges, ranges);
  ranges = Ranges(0.2, 4.0);
  ranges.radstep = 1.0f;
  world_.Publish(kRanges, ranges);
  world_.PublishAt(At(0.2), kRanges, Ranges(0.05, 0.1));  // Late.
  world_.PublishAt(At(0.2), kMotionRequest, Request(0.05, 0.1));
  velocity_t negative = Request(0.0, 0.2);
  negative.utime = std::numeric_limits<std::int64_t>::min();
  world_.PublishAt(At(0.2), kMotionRequest, negative);
  negative.utime = std::numeric_limits<std::int64_t>::max();
  world_.PublishAt(At(0.2), kMotionRequest, negative);
  base_status_t base;
  base.utime = -1;
  base.is_bumper_left = 1;
  world_.PublishAt(At(0.2), kBase, base);
  world_.RunUntil(At(0.3));
  EXPECT_EQ(NumBad(), 8);
  world_.Publish(kMotionRequest, Request(0.31, 0.3));
  world_.RunUntil(At(0.31));
  EXPECT_EQ(Last().forward, 0.3);
  // A stop is a stop, whatever its time.
  stop_t stop = Stop(0.0, true);
  stop.utime = 0;
  world_.PublishAt(At(0.32), kStop, stop);
  world_.RunUntil(At(0.32));
  EXPECT_EQ(Last().forward, 0.0);
  stop.is_stopped = 0;
  world_.PublishAt(At(0.33), kStop, stop);
  world_.Publish(kMotionRequest, Request(0.34, 0.3));
  world_.RunUntil(At(0.34));
  EXPECT_EQ(Last().forward, 0.0) << "no letting go without a time";
}

// Of two that ask, one has a clock that is wrong by seconds, either way.
TEST_F(CollisionGuardProcessTest, ForgetsNothingForAClockThatIsOff) {
  Start();
  for (const double off : {-7.0, 7.0}) {
    const double begin = off < 0 ? 0.0 : 3.0;
    base_status_t bumped;
    bumped.utime = Utime(begin + 0.25);
    bumped.is_bumper_left = 1;
    world_.Publish(kBase, bumped);
    for (int i = 0; i < 40; ++i) {
      const double t = begin + 0.05 * i;
      world_.Publish(kRanges, Ranges(t, 4.0));
      world_.Publish(kMotionRequest, Request(t, 0.3));
      // Comes now, with a time stamp of its own.
      world_.PublishAt(
          At(t + 0.01), kMotionRequest, Request(t + off, 0.2, 0.0, "laptop"));
      world_.RunUntil(At(t + 0.02));
      if (i == 4) {
        EXPECT_GT(Last().forward, 0.0);
      }
      if (i > 5 && i < 24) {
        EXPECT_LE(Last().forward, 0.0) << off << " " << i;
      }
      if (i == 20) {
        EXPECT_THAT(Fault(), HasSubstr("clock of laptop is off"));
      }
    }
    EXPECT_GT(Last().forward, 0.0) << "the bumper's hold has passed";
  }
}

// Known senders keep their numbers and their time, however many names another
// one takes, with requests or with stops.
TEST_F(CollisionGuardProcessTest, RemembersASourceAmongMany) {
  Start();
  world_.Publish(kRanges, Ranges(0.0, 4.0));
  for (int i = 1; i <= 150; ++i) {
    const double t = 0.01 * i;
    if (i % 30 == 0) world_.Publish(kRanges, Ranges(t, 4.0));
    world_.Publish(kMotionRequest, Request(t, 0.3));
    const std::string name = "other" + std::to_string(i);
    world_.Publish(kMotionRequest, Request(t, 0.0, 0.0, name.c_str()));
    stop_t release = Stop(t, false);
    release.source = "stop" + std::to_string(i);
    world_.Publish(kStop, release);
  }
  world_.RunUntil(At(1.5));
  std::int32_t expected = 0;
  for (const velocity_t& command : Commands()) {
    if (command.source != "test") continue;
    EXPECT_EQ(command.seq, expected++);
  }
  EXPECT_GE(expected, 150);
  EXPECT_EQ(NumBad(), 0);
  world_.PublishAt(At(1.51), kMotionRequest, Request(1.4, 0.3));
  world_.RunUntil(At(1.51));
  EXPECT_EQ(NumBad(), 1) << "time goes back";
  // The first of the others was forgotten long since, the last one not.
  world_.PublishAt(At(1.52), kMotionRequest, Request(1.0, 0.0, 0.0, "other1"));
  world_.RunUntil(At(1.52));
  EXPECT_EQ(NumBad(), 1);
  world_.PublishAt(
      At(1.53), kMotionRequest, Request(1.0, 0.0, 0.0, "other150"));
  world_.RunUntil(At(1.53));
  EXPECT_EQ(NumBad(), 2);
}

// "No echo" of a driver that sends the largest number there is.
TEST_F(CollisionGuardProcessTest, AnyLargeRangeIsNoEcho) {
  config_.guard.beam_width = 0.5;
  Start();
  for (const double range : {1e7, double{std::numeric_limits<float>::max()}}) {
    const double t = range > 1e8 ? 0.2 : 0.1;
    world_.Publish(kRanges, Ranges(t, range));
    world_.Publish(kMotionRequest, Request(t, 0.4));
    world_.RunUntil(At(t));
    EXPECT_EQ(Last().forward, 0.4) << range;
    EXPECT_EQ(Last().reason, "") << range;
  }
  EXPECT_EQ(NumBad(), 0);
}

TEST_F(CollisionGuardProcessTest, AnotherRunMayStartEarlier) {
  Start();
  world_.Publish(kRanges, Ranges(100.0, 4.0));
  world_.Publish(kMotionRequest, Request(100.0, 0.3));
  world_.RunUntil(At(100.01));
  world_.PublishAt(At(100.1), kRanges, Ranges(1.0, 4.0));
  world_.PublishAt(At(100.1), kMotionRequest, Request(1.0, 0.3));
  world_.RunUntil(At(100.1));
  EXPECT_EQ(Last().forward, 0.3);
  EXPECT_EQ(Last().utime, Utime(1.0));
  EXPECT_EQ(NumBad(), 0);
}

}  // namespace
}  // namespace waymark
