#include "estimation/filter/delayed_fusion.h"

#include "estimation/base/random.h"
#include "tests/support/odometry_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

namespace waymark {
namespace {

using Message = std::variant<EncoderReading,
                             AbsoluteFix,
                             InitialPose,
                             OdometryParameters,
                             RelativeMotion>;

// From when on it matters.
Time TimeOf(const Message& message) {
  const auto* motion = std::get_if<RelativeMotion>(&message);
  return motion ? motion->from
                : std::visit([](const auto& m) { return m.time; }, message);
}

DelayedFusionOptions Options() {
  DelayedFusionOptions options;
  options.filter.parameter_sigma = {0.02, 0.02, 0.05};
  return options;
}

Arrival Deliver(const Message& message, DelayedFusion* fusion) {
  if (const auto* reading = std::get_if<EncoderReading>(&message)) {
    return fusion->AddReading(*reading, 0);
  }
  if (const auto* fix = std::get_if<AbsoluteFix>(&message)) {
    return fusion->AddFix(*fix);
  }
  if (const auto* pose = std::get_if<InitialPose>(&message)) {
    return fusion->AddInitialPose(*pose);
  }
  if (const auto* motion = std::get_if<RelativeMotion>(&message)) {
    return fusion->AddMotion(*motion);
  }
  return fusion->AddParameters(std::get<OdometryParameters>(message));
}

// Two sources of relative motion: a chain from reading to reading, and longer
// ones that overlap, between readings, some faulty.
void AddMotions(const OdometryScene& scene, std::vector<Message>* messages) {
  const auto add = [&](const char* source, std::size_t from, std::size_t to) {
    RelativeMotion motion;
    motion.source = source;
    motion.seq = static_cast<std::int64_t>(from);
    motion.from = scene.readings[from].time;
    motion.time = scene.readings[to].time;
    motion.X_RS = {0.1, 0.05, 0.8};
    motion.X_S0S1 =
        Between(scene.truth[from] * motion.X_RS, scene.truth[to] * motion.X_RS);
    motion.covariance = 4e-4 * Eigen::Matrix3d::Identity();
    return motion;
  };
  for (std::size_t i = 0; i + 8 < scene.readings.size(); i += 8) {
    messages->emplace_back(add("chain", i, i + 8));
  }
  for (std::size_t i = 0; i + 16 < scene.readings.size(); i += 11) {
    RelativeMotion motion = add("overlapping", i, i + 15);
    // At these speeds as good as the motion from reading to reading.
    motion.from += Duration(20'000);
    motion.time += Duration(20'000);
    if (i % 33 == 0) motion.X_S0S1.y += 1.5;
    messages->emplace_back(motion);
  }
}

// Readings, two sources of fixes, some at the very times of readings, faulty
// fixes, relative motions, an encoder jump, parameters and a start.
std::vector<Message> MakeMessages(std::uint64_t seed, bool with_start) {
  OdometrySceneOptions options;
  options.drive.rate_hz = 20;
  options.drive.duration_s = 20;
  options.drive.seed = seed;
  OdometryScene scene = MakeOdometryScene(options);
  scene.readings[200].left += 10'000'000;
  std::vector<Message> messages;
  for (const EncoderReading& reading : scene.readings) {
    messages.emplace_back(reading);
  }
  for (std::size_t i = 0; i < scene.fixes.size(); ++i) {
    AbsoluteFix fix = scene.fixes[i];
    if (i % 7 == 3) fix.value.x() += 2;
    messages.emplace_back(fix);
    fix.source = "other";
    fix.time = scene.readings[(i + 1) * 10].time;
    fix.value = scene.truth[(i + 1) * 10].vector();
    fix.has = {false, true, true};
    messages.emplace_back(fix);
  }
  AddMotions(scene, &messages);
  OdometryParameters nominal;
  nominal.time = scene.readings[0].time;
  nominal.source = "nominal";
  nominal.parameters = options.drive.parameters;
  messages.emplace_back(nominal);
  if (with_start) {
    InitialPose start;
    start.time = scene.readings[0].time;
    start.source = "test";
    start.X_WR = scene.truth[0];
    start.covariance = 1e-4 * Eigen::Matrix3d::Identity();
    messages.emplace_back(start);
  }
  return messages;
}

// The order in which the history keeps them.
int RankOf(const Message& message) {
  if (std::holds_alternative<OdometryParameters>(message)) return 0;
  if (std::holds_alternative<InitialPose>(message)) return 1;
  if (std::holds_alternative<AbsoluteFix>(message)) return 2;
  return std::holds_alternative<RelativeMotion>(message) ? 4 : 5;
}

void SortByTime(std::vector<Message>* messages) {
  std::stable_sort(messages->begin(),
                   messages->end(),
                   [](const Message& a, const Message& b) {
                     return TimeOf(a) != TimeOf(b) ? TimeOf(a) < TimeOf(b)
                                                   : RankOf(a) < RankOf(b);
                   });
}

std::string Text(const PoseEstimate& e) {
  char text[512];
  std::snprintf(text,
                sizeof text,
                "%lld %d %s %a %a %a %a %a %a %a %a %lld %lld",
                static_cast<long long>(Microseconds(e.time)),
                e.is_known,
                e.reason.c_str(),
                e.X_WR.x,
                e.X_WR.y,
                e.X_WR.heading,
                e.covariance(0, 0),
                e.covariance(1, 1),
                e.covariance(2, 2),
                e.covariance(0, 2),
                e.turn_rate,
                static_cast<long long>(e.num_accepted),
                static_cast<long long>(e.num_rejected));
  return text;
}

std::string Text(const OdometryParameters& p) {
  if (!p.is_known) return "";
  char number[128];
  std::snprintf(number,
                sizeof number,
                " %a %a %a",
                p.parameters.k_right,
                p.parameters.wheel_base,
                p.covariance(1, 1));
  return number;
}

std::vector<std::string> SettledTexts(DelayedFusion* fusion) {
  std::vector<std::string> texts;
  for (const Settled& settled : fusion->TakeSettled()) {
    texts.push_back(Text(settled.pose) + Text(settled.parameters));
  }
  return texts;
}

std::vector<std::string> Settle(const std::vector<Message>& messages,
                                DelayedFusion* fusion) {
  for (const Message& message : messages) {
    EXPECT_EQ(Deliver(message, fusion), Arrival::kTaken);
  }
  fusion->Finish();
  return SettledTexts(fusion);
}

// The filter itself, fed in order: what all else is compared with.
std::vector<std::string> InOrder(std::vector<Message> messages) {
  SortByTime(&messages);
  OdometryFilter filter(Options().filter);
  std::vector<std::string> texts;
  // Ends of motions, in the order in which the history keeps them.
  std::vector<RelativeMotion> ends;
  for (const Message& message : messages) {
    if (const auto* motion = std::get_if<RelativeMotion>(&message)) {
      ends.push_back(*motion);
    }
  }
  std::sort(ends.begin(), ends.end(), [](const auto& a, const auto& b) {
    return std::tie(a.time, a.source, a.seq) <
           std::tie(b.time, b.source, b.seq);
  });
  auto end = ends.begin();
  for (const Message& message : messages) {
    const auto is_next = [&](const RelativeMotion& motion) {
      return motion.time != TimeOf(message) ? motion.time < TimeOf(message)
                                            : RankOf(message) > 3;
    };
    for (; end != ends.end() && is_next(*end); ++end) {
      filter.Add(end->time, *end);
    }
    if (const auto* reading = std::get_if<EncoderReading>(&message)) {
      filter.AddReading(*reading, 0);
      texts.push_back(Text(filter.estimate()) + Text(filter.parameters()));
    } else if (const auto* fix = std::get_if<AbsoluteFix>(&message)) {
      filter.Add(fix->time, *fix);
    } else if (const auto* pose = std::get_if<InitialPose>(&message)) {
      filter.Add(pose->time, *pose);
    } else if (const auto* motion = std::get_if<RelativeMotion>(&message)) {
      filter.Add(motion->from, MotionStart{motion->time});
    } else {
      const auto& p = std::get<OdometryParameters>(message);
      filter.Add(p.time, p);
    }
  }
  return texts;
}

// Must show: any arrival order within the window gives the in-order filter's
// settled estimates bit for bit.
TEST(DelayedFusion, AnyArrivalOrderWithinTheWindowSettlesTheSame) {
  for (const bool with_start : {true, false}) {
    std::vector<Message> messages = MakeMessages(5, with_start);
    const std::vector<std::string> expected = InOrder(messages);
    ASSERT_EQ(expected.size(), 401u);
    std::int64_t num_recomputed = 0;
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      // Each message is delayed by up to the window, independently.
      Random random(seed);
      std::vector<std::pair<double, Message>> delayed;
      SortByTime(&messages);
      for (const Message& message : messages) {
        const double arrival =
            static_cast<double>(Microseconds(TimeOf(message))) +
            random.Uniform(0, 2e6);
        delayed.emplace_back(arrival, message);
      }
      std::stable_sort(
          delayed.begin(), delayed.end(), [](const auto& a, const auto& b) {
            return a.first < b.first;
          });
      DelayedFusion fusion(Options());
      std::vector<Message> permuted;
      for (const auto& [arrival, message] : delayed) {
        permuted.push_back(message);
      }
      const std::vector<std::string> settled = Settle(permuted, &fusion);
      ASSERT_EQ(settled.size(), expected.size()) << "seed " << seed;
      for (std::size_t i = 0; i < settled.size(); ++i) {
        ASSERT_EQ(settled[i], expected[i]) << "seed " << seed << " line " << i;
      }
      num_recomputed += fusion.counts().num_recomputed;
      EXPECT_EQ(fusion.counts().num_late, 0);
    }
    EXPECT_GT(num_recomputed, 500);
  }
}

// In the end both filters have seen the same.
TEST(DelayedFusion, NewestEqualsSettledAtTheEnd) {
  std::vector<Message> messages = MakeMessages(6, true);
  SortByTime(&messages);
  // Fixes arrive one second late.
  std::stable_sort(
      messages.begin(), messages.end(), [](const Message& a, const Message& b) {
        const auto arrival = [](const Message& m) {
          const bool is_fix = std::holds_alternative<AbsoluteFix>(m);
          return TimeOf(m) + Duration(is_fix ? 1'000'000 : 0);
        };
        return arrival(a) < arrival(b);
      });
  DelayedFusion fusion(Options());
  for (const Message& message : messages) (void)Deliver(message, &fusion);
  const std::string newest = Text(fusion.newest().estimate());
  fusion.Finish();
  const std::vector<Settled> settled = fusion.TakeSettled();
  ASSERT_FALSE(settled.empty());
  EXPECT_EQ(Text(settled.back().pose), newest);
  EXPECT_GT(fusion.counts().num_recomputed, 30);
}

TEST(DelayedFusion, DuplicatesAndLateMessagesAreCountedAndChangeNothing) {
  std::vector<Message> messages = MakeMessages(7, true);
  const std::vector<std::string> expected = InOrder(messages);
  SortByTime(&messages);
  DelayedFusion fusion(Options());
  int num_duplicates = 0;
  int num_late = 0;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    EXPECT_EQ(Deliver(messages[i], &fusion), Arrival::kTaken);
    if (i % 3 == 0) {
      EXPECT_EQ(Deliver(messages[i], &fusion), Arrival::kDuplicate);
      ++num_duplicates;
    }
    if (i % 50 == 49 && i > 200) {
      // From some four seconds ago.
      const Message& old = messages[i - 180];
      if (!std::holds_alternative<AbsoluteFix>(old) &&
          !std::holds_alternative<RelativeMotion>(old)) {
        continue;
      }
      EXPECT_EQ(Deliver(old, &fusion), Arrival::kLate);
      ++num_late;
    }
  }
  fusion.Finish();
  EXPECT_EQ(SettledTexts(&fusion), expected);
  EXPECT_EQ(fusion.counts().num_duplicates, num_duplicates);
  EXPECT_EQ(fusion.counts().num_late, num_late);
}

EncoderReading Still(double seconds, std::int64_t seq) {
  return {TimeFromMicroseconds(1'000'000'000) + DurationFromSeconds(seconds),
          seq,
          100,
          100};
}

// A motion must fit into the window with its delay: what counts is its start.
TEST(DelayedFusion, MotionThatStartsBehindTheWindowIsLate) {
  DelayedFusion fusion(Options());
  for (int i = 0; i < 100; ++i) (void)fusion.AddReading(Still(0.05 * i, i), 0);
  RelativeMotion motion;
  motion.source = "scan";
  motion.time = Still(4.9, 0).time;
  motion.from = Still(2.9, 0).time;  // The newest reading is of 4.95 s.
  EXPECT_EQ(fusion.AddMotion(motion), Arrival::kLate);
  motion.from = Still(3.0, 0).time;
  EXPECT_EQ(fusion.AddMotion(motion), Arrival::kTaken);
  EXPECT_EQ(fusion.AddMotion(motion), Arrival::kDuplicate);
  // The same end under another start is the same motion.
  motion.from = Still(3.1, 0).time;
  EXPECT_EQ(fusion.AddMotion(motion), Arrival::kDuplicate);
  EXPECT_EQ(fusion.counts().num_late, 1);
  EXPECT_EQ(fusion.counts().num_duplicates, 2);
}

TEST(DelayedFusion, SettlesOnlyBehindTheWindow) {
  std::vector<Message> messages = MakeMessages(8, true);
  SortByTime(&messages);
  DelayedFusion fusion(Options());
  for (const Message& message : messages) {
    (void)Deliver(message, &fusion);
    if (!fusion.newest_time()) continue;
    for (const Settled& settled : fusion.TakeSettled()) {
      EXPECT_LT(settled.pose.time,
                *fusion.newest_time() - DurationFromSeconds(2));
      EXPECT_GT(settled.pose.time,
                *fusion.newest_time() - DurationFromSeconds(2.2));
    }
  }
}

TEST(DelayedFusion, OneStampFromTheFutureDoesNotCloseTheWindow) {
  DelayedFusion fusion(Options());
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(fusion.AddReading(Still(0.05 * i, i), 0), Arrival::kTaken);
  }
  EXPECT_EQ(fusion.AddReading(Still(1e6, 50), 0), Arrival::kAhead);
  EXPECT_EQ(fusion.AddReading(Still(2.5, 51), 0), Arrival::kTaken);
  // A real pause: the second reading after it confirms.
  EXPECT_EQ(fusion.AddReading(Still(100, 52), 0), Arrival::kAhead);
  EXPECT_EQ(fusion.AddReading(Still(100.05, 53), 0), Arrival::kTaken);
  fusion.Finish();
  EXPECT_EQ(fusion.TakeSettled().size(), 53u);
  EXPECT_EQ(fusion.counts().num_ahead, 1);
}

TEST(DelayedFusion, TimeThatGoesBackForGoodStartsAnew) {
  DelayedFusion fusion(Options());
  for (int i = 0; i < 50; ++i) {
    (void)fusion.AddReading(Still(1000 + 0.05 * i, i), 0);
  }
  // One old reading is late; twenty in a row are a new time.
  for (int i = 0; i < 19; ++i) {
    EXPECT_EQ(fusion.AddReading(Still(0.05 * i, i), 0), Arrival::kLate);
  }
  EXPECT_EQ(fusion.AddReading(Still(0.95, 19), 0), Arrival::kRestarted);
  EXPECT_EQ(fusion.AddReading(Still(1.0, 20), 0), Arrival::kTaken);
  EXPECT_EQ(fusion.newest_time(), Still(1.0, 20).time);
  fusion.Finish();
  EXPECT_EQ(fusion.TakeSettled().size(), 50u + 21u);
  EXPECT_EQ(fusion.counts().num_restarts, 1);
}

// A recording that is played again: the second pass starts from its own
// messages, which were late at first, and gives what the first gave.
TEST(DelayedFusion, ARecordingPlayedTwiceGivesTheSameTwice) {
  std::vector<Message> messages = MakeMessages(9, true);
  SortByTime(&messages);
  DelayedFusion fusion(Options());
  for (const Message& message : messages) (void)Deliver(message, &fusion);
  fusion.Finish();
  const std::vector<std::string> first = SettledTexts(&fusion);
  for (const Message& message : messages) (void)Deliver(message, &fusion);
  fusion.Finish();
  EXPECT_EQ(SettledTexts(&fusion), first);
  EXPECT_EQ(fusion.counts().num_restarts, 1);
}

TEST(DelayedFusion, ConfiguredStartIsNotUsedAgainAfterTimeWentBack) {
  DelayedFusionOptions options = Options();
  options.filter.parameters = WheelParameters{1e-4, 1e-4, 0.3};
  options.filter.start = InitialPose{};
  DelayedFusion fusion(options);
  for (int i = 0; i < 50; ++i) {
    (void)fusion.AddReading(Still(1000 + 0.05 * i, i), 0);
  }
  EXPECT_TRUE(fusion.newest().estimate().is_known);
  for (int i = 0; i < 30; ++i) {
    (void)fusion.AddReading(Still(0.05 * i, i), 0);
  }
  EXPECT_EQ(fusion.counts().num_restarts, 1);
  EXPECT_FALSE(fusion.newest().estimate().is_known);
}

TEST(DelayedFusion, FutureFixesWaitInBoundedNumber) {
  DelayedFusionOptions options = Options();
  options.max_waiting = 10;
  DelayedFusion fusion(options);
  (void)fusion.AddReading(Still(0, 0), 0);
  AbsoluteFix fix;
  fix.has = {true, true, true};
  fix.covariance = Eigen::Matrix3d::Identity();
  for (int i = 1; i < 40; ++i) {
    fix.time = Still(10.0 * i, 0).time;
    fix.seq = i;
    EXPECT_EQ(fusion.AddFix(fix), i <= 10 ? Arrival::kTaken : Arrival::kFull);
  }
  EXPECT_EQ(fusion.AddReading(Still(0.05, 1), 0), Arrival::kTaken);
}

}  // namespace
}  // namespace waymark
