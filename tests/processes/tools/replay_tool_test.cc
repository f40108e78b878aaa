#include "processes/tools/replay/replay_tool.h"

#include "processes/support/log_file.h"
#include "tests/support/temporary_directory.h"

#include <waymark/encoders_t.hpp>
#include <waymark/pose_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace waymark {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// Turns each ENCODERS message into ODOMETRY: x is left_ticks * factor.
class WheelProcess {
 public:
  struct Config {
    double factor = 1.0;
    void Describe(Describer& d) {
      d.Number("factor", &factor, kPositive, "m per tick");
    }
  };
  static constexpr std::string_view kName = "wheel";

  WheelProcess(const Config& config, Bus* bus) {
    bus->Advertise<pose_t>("ODOMETRY");
    bus->Subscribe<encoders_t>(
        "ENCODERS", Keep::All(), [=](const encoders_t& message, Time) {
          if (message.left_ticks < 0) throw std::runtime_error("negative");
          pose_t pose{};
          pose.utime = message.utime;
          pose.pose_W[0] =
              config.factor * static_cast<double>(message.left_ticks);
          bus->Publish("ODOMETRY", pose);
        });
  }
};

// Turns each ODOMETRY message into POSE, y one more.
class FilterProcess {
 public:
  struct Config {
    void Describe(Describer& /*d*/) {}
  };
  static constexpr std::string_view kName = "filter";

  FilterProcess(const Config& /*config*/, Bus* bus) {
    bus->Advertise<pose_t>("POSE");
    bus->Subscribe<pose_t>(
        "ODOMETRY", Keep::All(), [=](const pose_t& message, Time) {
          pose_t pose = message;
          pose.pose_W[1] += 1.0;
          bus->Publish("POSE", pose);
        });
  }
};

class ReplayToolTest : public testing::Test {
 protected:
  // ENCODERS, and ODOMETRY, POSE and OTHER as an earlier run recorded them.
  void SetUp() override {
    LogWriter writer(in_);
    for (int i = 0; i < 5; ++i) {
      encoders_t encoders{};
      encoders.utime = 1'000'000 + 100'000 * i;
      encoders.left_ticks = i;
      writer.Write("ENCODERS", encoders);
      pose_t old{};
      old.utime = encoders.utime;
      old.pose_W[0] = -99.0;
      for (const char* channel : {"ODOMETRY", "POSE", "OTHER"}) {
        writer.Write(channel, old);
      }
    }
    writer.Close();
  }

  // Exit code; stderr goes to error_.
  int Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "waymark-replay");
    std::vector<char*> argv;
    for (auto& argument : arguments) argv.push_back(argument.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = RunReplayTool(
        {MakeProcessClass<WheelProcess>(), MakeProcessClass<FilterProcess>()},
        static_cast<int>(argv.size()),
        argv.data());
    output_ = testing::internal::GetCapturedStdout();
    error_ = testing::internal::GetCapturedStderr();
    return code;
  }

  std::vector<double> Values(const std::string& channel, int index) const {
    LogReader reader(out_);
    std::vector<double> values;
    while (const auto event = reader.Next()) {
      if (event->channel != channel) continue;
      values.push_back(DecodeAs<pose_t>(*event)->pose_W[index]);
    }
    return values;
  }

  void ExpectRefused(const std::vector<std::string>& arguments,
                     const std::string& what) {
    EXPECT_EQ(Run(arguments), 2);
    EXPECT_THAT(error_, HasSubstr(what));
    EXPECT_EQ(std::count(error_.begin(), error_.end(), '\n'), 1) << error_;
  }

  TemporaryDirectory directory_{TemporaryDirectory::FastParent()};
  std::string in_ = directory_ / "in.log";
  std::string out_ = directory_ / "out.log";
  std::string output_;
  std::string error_;
};

TEST_F(ReplayToolTest, ReplacesWhatTheProcessesRecorded) {
  EXPECT_EQ(Run({"--process", "wheel", "--process", "filter", in_, out_}), 0)
      << error_;
  EXPECT_THAT(Values("ODOMETRY", 0), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(Values("POSE", 0), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(Values("POSE", 1), ElementsAre(1, 1, 1, 1, 1));
  EXPECT_THAT(Values("OTHER", 0), ElementsAre(-99, -99, -99, -99, -99));
  EXPECT_THAT(output_,
              AllOf(HasSubstr("of the 20 in"),
                    HasSubstr("10 were left out"),
                    HasSubstr("wheel: 5 received, 0 lost, 0 bad")));
}

// Only the filter is run anew: it works on the recorded odometry.
TEST_F(ReplayToolTest, OtherRecordedMessagesAreInputs) {
  EXPECT_EQ(Run({"-p", "filter", in_, out_}), 0) << error_;
  EXPECT_THAT(Values("POSE", 0), ElementsAre(-99, -99, -99, -99, -99));
  EXPECT_THAT(Values("POSE", 1), ElementsAre(1, 1, 1, 1, 1));
}

TEST_F(ReplayToolTest, SameLogSameBytes) {
  EXPECT_EQ(Run({"-p", "wheel", "-p", "filter", in_, out_}), 0);
  const auto first = ReadBytes(out_);
  EXPECT_EQ(Run({"-p", "wheel", "-p", "filter", in_, out_, "--force"}), 0);
  EXPECT_EQ(ReadBytes(out_), first);
  // The output replayed gives the same again, but for STATUS and CONFIG, whose
  // place in the log is the same too.
  const std::string again = directory_ / "again.log";
  EXPECT_EQ(Run({"-p", "wheel", "-p", "filter", out_, again}), 0);
  EXPECT_EQ(ReadBytes(again), first);
}

TEST_F(ReplayToolTest, ConfigurationsGoToTheirProcess) {
  const std::string file = directory_ / "wheel.yaml";
  const std::string yaml = "factor: 5\n";
  WriteBytes(file,
             {reinterpret_cast<const std::uint8_t*>(yaml.data()), yaml.size()});
  EXPECT_EQ(Run({"-p", "wheel=" + file, in_, out_}), 0) << error_;
  EXPECT_THAT(Values("ODOMETRY", 0), ElementsAre(0, 5, 10, 15, 20));
  EXPECT_EQ(Run({"-p", "wheel", "--set", "wheel.factor=2", "-f", in_, out_}),
            0);
  EXPECT_THAT(Values("ODOMETRY", 0), ElementsAre(0, 2, 4, 6, 8));
}

TEST_F(ReplayToolTest, BadRequestsAreOneClearLine) {
  ExpectRefused({"-p", "nobody", in_, out_}, "but: wheel, filter");
  ExpectRefused({in_, out_}, "at least one --process");
  ExpectRefused({"-p", "wheel", in_}, "the log to write");
  ExpectRefused({"-p", "wheel", "-p", "wheel", in_, out_}, "named twice");
  ExpectRefused({"-p", "wheel", "--set", "factor=2", in_, out_},
                "must start with the name");
  ExpectRefused({"-p", "wheel", "--set", "filter.x=2", in_, out_},
                "must start with the name");
  ExpectRefused({"-p", "wheel", "--set", "wheel.size=2", in_, out_}, "size");
  ExpectRefused({"-p", "wheel", "--set", "wheel.factor=-2", in_, out_},
                "factor");
  ExpectRefused({"-p", "wheel=/none.yaml", in_, out_}, "/none.yaml");
  ExpectRefused({"-p", "wheel", "/none.log", out_}, "/none.log");
  ExpectRefused({"-p", "wheel", in_, in_}, in_);
  WriteBytes(out_, {});
  ExpectRefused({"-p", "wheel", in_, out_}, "exists");
}

TEST_F(ReplayToolTest, AHandlerThatThrowsIsAFaultThatNamesTheEvent) {
  {
    LogWriter writer(in_, IfExists::kReplace);
    encoders_t encoders{};
    writer.Write("ENCODERS", encoders);
    encoders.left_ticks = -1;
    writer.Write("ENCODERS", encoders);
    writer.Close();
  }
  EXPECT_EQ(Run({"-p", "wheel", in_, out_}), 1);
  EXPECT_THAT(error_, HasSubstr("event 1 (ENCODERS): negative"));
}

TEST_F(ReplayToolTest, ListsProcesses) {
  EXPECT_EQ(Run({"--list"}), 0);
  EXPECT_EQ(output_, "wheel\nfilter\n");
}

}  // namespace
}  // namespace waymark
