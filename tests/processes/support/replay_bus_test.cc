#include "processes/support/replay_bus.h"

#include "processes/support/channels.h"
#include "tests/processes/support/echo_process.h"

#include <waymark/config_t.hpp>
#include <waymark/truth_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Some time of day; event 0 of every log here.
constexpr std::int64_t kStart = 1'700'000'000'000'000;

template <typename M>
LogEvent Event(std::int64_t time, std::string_view channel, const M& message) {
  LogEvent event;
  event.time = TimeFromMicroseconds(time);
  event.channel = channel;
  event.data.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(event.data.data(), 0, static_cast<int>(event.data.size()));
  return event;
}

encoders_t Encoders(std::int64_t utime, std::int32_t seq) {
  encoders_t message;
  message.utime = utime;
  message.seq = seq;
  message.left_ticks = seq;
  return message;
}

odometry_parameters_t Parameters(std::int64_t utime, const char* source) {
  odometry_parameters_t message;
  message.utime = utime;
  message.source = source;
  return message;
}

truth_t Truth(std::int64_t utime) {
  truth_t message;
  message.utime = utime;
  return message;
}

// A recording of `seconds` at 20 Hz, in which an earlier echo ran as well.
std::vector<LogEvent> Recording(int seconds) {
  std::vector<LogEvent> events;
  events.push_back(
      Event(kStart, kOdometryParameters, Parameters(kStart, "nominal")));
  for (int i = 0; i < 20 * seconds; ++i) {
    const std::int64_t t = kStart + 50'000 * i;
    // Received a little after it was measured.
    events.push_back(Event(t + 700, kEncoders, Encoders(t, i)));
    pose_t recorded;
    recorded.utime = t;
    recorded.seq = i;
    events.push_back(Event(t + 900, kOdometry, recorded));
    events.push_back(
        Event(t + 950, kOdometryParameters, Parameters(t, "online")));
    events.push_back(Event(t + 1000, kTruth, Truth(t)));
  }
  return events;
}

std::string WriteLog(const std::string& name,
                     const std::vector<LogEvent>& events) {
  std::string path = testing::TempDir() + name;
  LogWriter writer(path, IfExists::kReplace);
  for (const LogEvent& event : events) {
    writer.Write(event.time, event.channel, event.data);
  }
  writer.Close();
  return path;
}

std::string FileBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<LogEvent> ReadLog(const std::string& path) {
  LogReader reader(path);
  std::vector<LogEvent> events;
  while (auto event = reader.Next()) events.push_back(std::move(*event));
  return events;
}

ReplayOptions Options(const std::string& log_in,
                      const std::string& log_out,
                      IfExists if_exists) {
  ReplayOptions options;
  options.log_in = log_in;
  options.log_out = log_out;
  options.if_exists = if_exists;
  return options;
}

ReplayReport Replay(const std::string& log_in,
                    const std::string& log_out,
                    const std::vector<std::string>& settings = {}) {
  return RunReplay(
      {ReplayProcess{MakeProcessClass<EchoProcess>(), "", settings}},
      Options(log_in, log_out, IfExists::kReplace));
}

TEST(ReplayBus, OutputsFollowTheirInputAndRecordedOnesAreLeftOut) {
  std::vector<std::string> order;
  ReplayBus bus([&](Time time, std::string_view channel, auto) {
    order.push_back(std::string(channel) + '+' +
                    std::to_string(Microseconds(time) - kStart));
  });
  EchoProcess echo(EchoConfig{}, bus.AddProcess("echo", "scale: 1\n"));
  for (const LogEvent& event : Recording(1)) {
    bus.Handle(event);
    if (Microseconds(event.time) > kStart + 51'000) break;
  }
  echo.Finish();
  bus.Finish();
  EXPECT_THAT(order,
              ElementsAre("CONFIG+0",
                          "STATUS+0",
                          "ODOMETRY_PARAMETERS+0",
                          "ENCODERS+700",
                          "ODOMETRY+700",
                          "ODOMETRY_PARAMETERS+700",
                          "TRUTH+1000",
                          "ENCODERS+50700",
                          "ODOMETRY+50700",
                          "ODOMETRY_PARAMETERS+50700",
                          "TRUTH+51000",
                          "ENCODERS+100700",
                          "ODOMETRY+100700",
                          "ODOMETRY_PARAMETERS+100700",
                          "POSE+100700",
                          "STATUS+100700"));
  EXPECT_EQ(bus.num_left_out(), 4);
  const status_t status = bus.Status("echo");
  EXPECT_EQ(status.num_lost, 0);
  EXPECT_EQ(status.pid, 0);
  EXPECT_EQ(status.host, "");
  EXPECT_EQ(status.has_timing, 0);
}

TEST(ReplayBus, OutputsOfOneProcessReachTheOthersInOrder) {
  // doubler answers ENCODERS with TRUTH; watcher notes what it sees.
  std::vector<std::string> seen;
  ReplayBus bus({});
  Bus* watcher = bus.AddProcess("watcher", "");
  watcher->Subscribe<encoders_t>(
      kEncoders, Keep::All(), [&](const encoders_t& m, Time) {
        seen.push_back("encoders " + std::to_string(m.seq));
      });
  watcher->Subscribe<truth_t>(kTruth, Keep::All(), [&](const truth_t& m, Time) {
    seen.push_back("truth " + std::to_string(m.seq));
  });
  Bus* doubler = bus.AddProcess("doubler", "");
  doubler->Advertise<truth_t>(kTruth);
  doubler->Subscribe<encoders_t>(
      kEncoders, Keep::All(), [&](const encoders_t& m, Time) {
        for (int i = 0; i < 2; ++i) {
          truth_t truth = Truth(m.utime);
          truth.seq = 2 * m.seq + i;
          doubler->Publish(kTruth, truth);
        }
      });
  for (int i = 0; i < 2; ++i) {
    bus.Handle(Event(kStart + i, kEncoders, Encoders(kStart + i, i)));
  }
  EXPECT_THAT(seen,
              ElementsAre("encoders 0",
                          "truth 0",
                          "truth 1",
                          "encoders 1",
                          "truth 2",
                          "truth 3"));
}

TEST(ReplayBus, StatusFollowsEventTimeWhateverTheClockDoes) {
  int num_status = 0;
  int num_config = 0;
  ReplayBus bus([&](Time, std::string_view channel, auto) {
    num_status += channel == kStatus;
    num_config += channel == kConfig;
  });
  bus.AddProcess("idle", "");
  const auto at = [&](std::int64_t time) {
    bus.Handle(Event(time, kTruth, Truth(time)));
  };
  for (int i = 0; i < 250; ++i) at(kStart + 100'000 * i);  // 0 to 24.9 s.
  EXPECT_EQ(num_status, 25);
  EXPECT_EQ(num_config, 3);
  at(std::numeric_limits<std::int64_t>::max());  // Far ahead: one report.
  EXPECT_EQ(num_status, 26);
  at(std::numeric_limits<std::int64_t>::min());  // Back: one.
  EXPECT_EQ(num_status, 27);
  at(kStart);
  EXPECT_EQ(num_status, 28);
}

TEST(ReplayBus, SameLogSameBytesAndItsOwnOutputToo) {
  const std::string in = WriteLog("replay_in.lcm", Recording(12));
  const std::string out = testing::TempDir() + "replay_out.lcm";
  const std::string again = testing::TempDir() + "replay_again.lcm";
  const ReplayReport report = Replay(in, out);
  Replay(in, again);
  const std::string bytes = FileBytes(out);
  EXPECT_GT(bytes.size(), 100'000u);
  EXPECT_EQ(bytes, FileBytes(again));
  EXPECT_EQ(report.num_left_out, 2 * 240);
  ASSERT_EQ(report.statuses.size(), 1u);
  EXPECT_EQ(report.statuses[0].num_bad, 0);
  // What it published is left out of its own output and made anew, the same.
  Replay(out, again);
  EXPECT_EQ(bytes, FileBytes(again));
  for (const std::string& path : {in, out, again}) std::remove(path.c_str());
}

TEST(ReplayBus, OutputSaysHowItWasMade) {
  const std::string in = WriteLog("replay_in.lcm", Recording(1));
  const std::string out = testing::TempDir() + "replay_out.lcm";
  Replay(in, out, {"scale=2.5"});
  std::vector<std::string> yaml;
  for (const LogEvent& event : ReadLog(out)) {
    if (const auto config = DecodeAs<config_t>(event)) {
      yaml.push_back(config->yaml);
      EXPECT_EQ(config->process, "echo");
      EXPECT_EQ(config->utime, kStart);
    }
  }
  EXPECT_THAT(yaml, ElementsAre(HasSubstr("scale: 2.5\n")));
  std::remove(in.c_str());
  std::remove(out.c_str());
}

TEST(ReplayBus, HandlerThatThrowsNamesTheEventAndKeepsWhatWasWritten) {
  const std::string in = WriteLog("replay_in.lcm", Recording(1));
  const std::string out = testing::TempDir() + "replay_out.lcm";
  try {
    Replay(in, out, {"throw_at=5"});
    FAIL();
  } catch (const InputError&) {
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(),
              in + ": event 21 (ENCODERS): handler threw as configured");
  }
  int num_odometry = 0;
  for (const LogEvent& event : ReadLog(out)) {
    num_odometry += event.channel == kOdometry;
  }
  EXPECT_EQ(num_odometry, 5);
  std::remove(in.c_str());
  std::remove(out.c_str());
}

TEST(ReplayBus, BadFilesAreRefused) {
  const std::string in = WriteLog("replay_in.lcm", Recording(1));
  const std::string before = FileBytes(in);
  EXPECT_THROW(Replay("/nowhere/x.lcm", ""), InputError);
  // Its own input, under another name too.
  EXPECT_THROW(Replay(in, in), InputError);
  EXPECT_THROW(Replay(in, testing::TempDir() + "./replay_in.lcm"), InputError);
  EXPECT_EQ(FileBytes(in), before);
  // An output that exists.
  const std::string out = WriteLog("replay_out.lcm", {});
  EXPECT_THROW(
      (void)RunReplay({ReplayProcess{MakeProcessClass<EchoProcess>(), "", {}}},
                      Options(in, out, IfExists::kFail)),
      InputError);
  std::remove(in.c_str());
  std::remove(out.c_str());
}

struct RefusingProcess {
  struct Config {
    void Describe(Describer&) {}
  };
  static constexpr std::string_view kName = "refusing";
  RefusingProcess(const Config&, Bus*) { throw InputError("no"); }
};

TEST(ReplayBus, AProcessThatCannotStartLeavesNoOutput) {
  const std::string in = WriteLog("replay_in.lcm", Recording(1));
  const std::string out = testing::TempDir() + "replay_none.lcm";
  std::remove(out.c_str());
  EXPECT_THROW((void)RunReplay(
                   {ReplayProcess{MakeProcessClass<RefusingProcess>(), "", {}}},
                   Options(in, out, IfExists::kFail)),
               InputError);
  EXPECT_FALSE(std::filesystem::exists(out));
  std::remove(in.c_str());
}

TEST(ReplayBus, StopEndsLikeTheEndOfTheLog) {
  const std::string in = WriteLog("replay_in.lcm", Recording(2));
  const std::string out = testing::TempDir() + "replay_out.lcm";
  int num_asked = 0;
  ReplayOptions options = Options(in, out, IfExists::kReplace);
  options.stop = [&] { return ++num_asked > 9; };
  const ReplayReport report = RunReplay(
      {ReplayProcess{MakeProcessClass<EchoProcess>(), "", {}}}, options);
  EXPECT_TRUE(report.was_stopped);
  EXPECT_EQ(report.read.num_events, 9);
  const auto events = ReadLog(out);
  ASSERT_GE(events.size(), 2u);
  EXPECT_EQ(events.back().channel, kStatus);
  EXPECT_EQ(events[events.size() - 2].channel, kPose);  // From Finish().
  std::remove(in.c_str());
  std::remove(out.c_str());
}

TEST(ReplayBus, OneProcessNamedTwiceIsRefused) {
  const std::string in = WriteLog("replay_in.lcm", Recording(1));
  const ReplayProcess echo{MakeProcessClass<EchoProcess>(), "", {}};
  EXPECT_THROW((void)RunReplay({echo, echo}, Options(in, "", IfExists::kFail)),
               InputError);
  std::remove(in.c_str());
}

TEST(ReplayBus, TimersFollowEventTimeButNotOverAGap) {
  std::vector<std::int64_t> calls;
  ReplayBus replay(nullptr);
  Bus* bus = replay.AddProcess("clock", "");
  bus->Every(std::chrono::seconds(2), [&](Time now) {
    EXPECT_EQ(now, bus->now());
    calls.push_back(Microseconds(now) / 1'000'000);
  });
  for (const int second : {100, 101, 105, 1000, 1003}) {
    LogEvent event;
    event.time = TimeFromMicroseconds(second * 1'000'000LL);
    event.channel = "X";
    replay.Handle(event);
  }
  EXPECT_THAT(calls, testing::ElementsAre(102, 104, 1002));
}

}  // namespace
}  // namespace waymark
