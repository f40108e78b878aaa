#include "processes/support/local_bus.h"

#include <waymark/encoders_t.hpp>
#include <waymark/odometry_parameters_t.hpp>
#include <waymark/truth_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::ElementsAre;

encoders_t Encoders(std::int64_t utime, std::int32_t seq) {
  encoders_t message{};
  message.utime = utime;
  message.seq = seq;
  return message;
}

// Answers each ENCODERS with a TRUTH of the same time and number.
class Echo {
 public:
  Echo(Bus* bus, Keep keep) {
    bus->Advertise<truth_t>("TRUTH");
    bus->Subscribe<encoders_t>(
        "ENCODERS", keep, [bus](const encoders_t& message, Time t) {
          truth_t truth{};
          truth.utime = Microseconds(t);
          truth.seq = message.seq;
          bus->Publish("TRUTH", truth);
        });
  }
};

std::vector<std::string> Order(const LocalBus& world) {
  std::vector<std::string> order;
  for (const RawMessage& raw : world.recording()) {
    order.push_back(raw.channel + '@' +
                    std::to_string(Microseconds(raw.log_time)));
  }
  return order;
}

TEST(LocalBus, DeliversByTimeThenSequence) {
  LocalBus world;
  const Echo echo(world.AddProcess("echo"), Keep::All());
  world.Publish("ENCODERS", Encoders(30, 2));
  world.Publish("ENCODERS", Encoders(10, 0));
  world.PublishAt(
      TimeFromMicroseconds(30), "ENCODERS", Encoders(5, 1));  // Late.
  world.Run();
  EXPECT_THAT(Order(world),
              ElementsAre("ENCODERS@10",
                          "TRUTH@10",
                          "ENCODERS@30",
                          "ENCODERS@30",
                          "TRUTH@30",
                          "TRUTH@30"));
  const auto truths = world.Messages<truth_t>("TRUTH");
  ASSERT_EQ(truths.size(), 3u);
  EXPECT_EQ(truths[1].utime, 30);
  EXPECT_EQ(truths[2].utime, 5);
  EXPECT_EQ(world.now(), TimeFromMicroseconds(30));
}

TEST(LocalBus, RunUntilStopsTheClockThere) {
  LocalBus world;
  const Echo echo(world.AddProcess("echo"), Keep::All());
  for (int i = 0; i < 10; ++i) world.Publish("ENCODERS", Encoders(i * 10, i));
  world.RunUntil(TimeFromMicroseconds(45));
  EXPECT_EQ(world.Messages<truth_t>("TRUTH").size(), 5u);
  EXPECT_EQ(world.now(), TimeFromMicroseconds(45));
  // Too late for its own time: arrives now.
  world.Publish("ENCODERS", Encoders(7, 99));
  world.RunUntil(TimeFromMicroseconds(45));
  EXPECT_EQ(world.Messages<truth_t>("TRUTH").back().seq, 99);
  EXPECT_EQ(world.recording().back().log_time, TimeFromMicroseconds(45));
}

TEST(LocalBus, LatencyDelaysOutputsAndKeepsTheLatest) {
  LocalBus world;
  const Echo echo(world.AddProcess("slow", Duration(25)), Keep::Latest());
  for (int i = 0; i < 7; ++i) world.Publish("ENCODERS", Encoders(i * 10, i));
  world.Run();
  // Handled at 0, 25 (message of 20), 50 (of 50: it arrived first), 75 (of 60).
  std::vector<int> handled;
  for (const truth_t& truth : world.Messages<truth_t>("TRUTH")) {
    handled.push_back(truth.seq);
  }
  EXPECT_THAT(handled, ElementsAre(0, 2, 5, 6));
  std::vector<std::int64_t> times;
  for (const RawMessage& raw : world.recording()) {
    if (raw.channel == "TRUTH") times.push_back(Microseconds(raw.log_time));
  }
  EXPECT_THAT(times, ElementsAre(25, 50, 75, 100));
  const status_t status = world.Status("slow");
  EXPECT_EQ(status.num_received, 7);
  EXPECT_EQ(status.num_dropped, 3);
  // What the mailbox displaced was not lost on the way.
  EXPECT_EQ(status.num_lost, 0);
  EXPECT_EQ(status.num_published, 4);
}

TEST(LocalBus, KeepAllRefusesBeyondItsBound) {
  LocalBus world;
  const Echo echo(world.AddProcess("slow", Duration(1000)), Keep::All(2));
  for (int i = 0; i < 7; ++i) world.Publish("ENCODERS", Encoders(i * 10, i));
  world.Run();
  std::vector<int> handled;
  for (const truth_t& truth : world.Messages<truth_t>("TRUTH")) {
    handled.push_back(truth.seq);
  }
  EXPECT_THAT(handled, ElementsAre(0, 1, 2));
  EXPECT_EQ(world.Status("slow").num_dropped, 4);
}

TEST(LocalBus, CountsLossBadTypeAndBadContent) {
  LocalBus world;
  Bus* bus = world.AddProcess("reader");
  int num_handled = 0;
  bus->Subscribe<encoders_t>(
      "ENCODERS", Keep::All(), [&](const encoders_t& message, Time) {
        ++num_handled;
        if (message.left_ticks < 0) {
          bus->ReportBad("ENCODERS", Bad::kContent, "negative");
        }
      });
  world.Publish("ENCODERS", Encoders(10, 100));
  world.Publish("ENCODERS", Encoders(20, 105));  // 4 lost.
  truth_t other{};
  other.utime = 30;
  world.Publish("ENCODERS", other);  // Takes the place of number 106.
  world.Publish("ENCODERS", Encoders(40, 107));
  world.Publish("ENCODERS", Encoders(50, 0));  // A new sender.
  world.Publish("ENCODERS", Encoders(60, 1));
  encoders_t negative = Encoders(70, 2);
  negative.left_ticks = -1;
  world.Publish("ENCODERS", negative);
  world.PublishBytesAt(TimeFromMicroseconds(80), "ENCODERS", {});
  world.PublishBytesAt(TimeFromMicroseconds(80), "ENCODERS", {1, 2, 3});
  std::vector<std::uint8_t> torn(
      static_cast<std::size_t>(negative.getEncodedSize()));
  negative.encode(torn.data(), 0, static_cast<int>(torn.size()));
  torn.pop_back();
  world.PublishBytesAt(TimeFromMicroseconds(80), "ENCODERS", torn);
  world.Run();
  const status_t status = world.Status("reader");
  EXPECT_EQ(num_handled, 6);
  EXPECT_EQ(status.num_lost, 4);
  EXPECT_EQ(status.num_bad, 5);
  EXPECT_EQ(status.num_received, 10);
}

TEST(LocalBus, SourcesOnOneChannelCountTheirOwnNumbers) {
  LocalBus world;
  Bus* bus = world.AddProcess("reader");
  bus->Subscribe<odometry_parameters_t>(
      "ODOMETRY_PARAMETERS",
      Keep::All(),
      [](const odometry_parameters_t&, Time) {});
  for (int i = 0; i < 5; ++i) {
    odometry_parameters_t message{};
    message.utime = i;
    message.seq = i;
    message.source = "online";
    world.Publish("ODOMETRY_PARAMETERS", message);
    message.seq = 1000 + 2 * i;  // This one loses every second message.
    message.source = "batch";
    world.Publish("ODOMETRY_PARAMETERS", message);
  }
  world.Run();
  EXPECT_EQ(world.Status("reader").num_lost, 4);
}

TEST(LocalBus, HandlerExceptionAndUndeclaredChannelEndTheRun) {
  LocalBus world;
  Bus* bus = world.AddProcess("broken");
  bus->Subscribe<encoders_t>(
      "ENCODERS", Keep::All(), [&](const encoders_t& message, Time) {
        if (message.seq == 1) throw std::runtime_error("as planned");
        if (message.seq == 2) bus->Publish("TRUTH", truth_t{});
      });
  world.Publish("ENCODERS", Encoders(10, 0));
  world.Run();
  world.Publish("ENCODERS", Encoders(20, 1));
  EXPECT_THROW(world.Run(), std::runtime_error);
  world.Publish("ENCODERS", Encoders(20, 2));
  EXPECT_THROW(world.Run(), std::logic_error);
}

TEST(LocalBus, SameInputGivesTheSameRecording) {
  std::vector<std::vector<RawMessage>> recordings;
  for (int run = 0; run < 2; ++run) {
    LocalBus world;
    const Echo fast(world.AddProcess("fast"), Keep::All());
    const Echo slow(world.AddProcess("slow", Duration(17)), Keep::Latest());
    for (int i = 0; i < 200; ++i) {
      world.Publish("ENCODERS", Encoders((i * 37) % 500, i));
    }
    world.Run();
    recordings.push_back(world.recording());
  }
  ASSERT_EQ(recordings[0].size(), recordings[1].size());
  for (std::size_t i = 0; i < recordings[0].size(); ++i) {
    EXPECT_EQ(recordings[0][i].channel, recordings[1][i].channel);
    EXPECT_EQ(recordings[0][i].data, recordings[1][i].data);
    EXPECT_EQ(recordings[0][i].log_time, recordings[1][i].log_time);
  }
}

TEST(LocalBus, CallAtRunsBetweenMessages) {
  LocalBus world;
  std::vector<std::string> events;
  world.bus()->Subscribe<encoders_t>(
      "ENCODERS", Keep::All(), [&](const encoders_t& message, Time) {
        events.push_back("message " + std::to_string(message.seq));
      });
  world.CallAt(TimeFromMicroseconds(15), [&] {
    events.emplace_back("call");
    world.bus()->Publish("ENCODERS", Encoders(15, 7));
  });
  world.Publish("ENCODERS", Encoders(10, 1));
  world.Publish("ENCODERS", Encoders(20, 2));
  world.Run();
  EXPECT_THAT(events,
              ElementsAre("message 1", "call", "message 7", "message 2"));
}

// Publishes a TRUTH every ten microseconds.
void MakeClock(Bus* bus) {
  bus->Advertise<truth_t>("TRUTH");
  bus->Every(Duration(10), [bus](Time now) {
    EXPECT_EQ(now, bus->now());
    truth_t truth{};
    truth.utime = Microseconds(now);
    bus->Publish("TRUTH", truth);
  });
}

TEST(LocalBus, TimersRunAfterMessagesOfTheSameTime) {
  LocalBus world(TimeFromMicroseconds(1000));
  MakeClock(world.AddProcess("clock"));
  EXPECT_EQ(world.now(), TimeFromMicroseconds(1000));
  world.Publish("ENCODERS", Encoders(1015, 0));
  world.Publish("ENCODERS", Encoders(1020, 1));
  world.RunUntil(TimeFromMicroseconds(1020));
  EXPECT_THAT(
      Order(world),
      ElementsAre(
          "TRUTH@1010", "ENCODERS@1015", "ENCODERS@1020", "TRUTH@1020"));
}

TEST(LocalBus, TimersStartAtTheFirstEventAndEndWithTheLast) {
  LocalBus world;
  MakeClock(world.AddProcess("clock"));
  world.Publish("ENCODERS", Encoders(1'000'000'000, 0));
  world.Publish("ENCODERS", Encoders(1'000'000'025, 1));
  world.RunUntil(TimeFromMicroseconds(1'000'000'005));
  world.RunUntil(TimeFromMicroseconds(1'000'000'030));
  EXPECT_THAT(Order(world),
              ElementsAre("ENCODERS@1000000000",
                          "TRUTH@1000000010",
                          "TRUTH@1000000020",
                          "ENCODERS@1000000025",
                          "TRUTH@1000000030"));
}

TEST(LocalBus, RecordsToASinkInstead) {
  LocalBus world;
  std::vector<std::string> channels;
  world.RecordTo(
      [&](const RawMessage& message) { channels.push_back(message.channel); });
  world.Publish("ENCODERS", Encoders(10, 0));
  world.Run();
  EXPECT_THAT(channels, ElementsAre("ENCODERS"));
  EXPECT_TRUE(world.recording().empty());
}

}  // namespace
}  // namespace waymark
