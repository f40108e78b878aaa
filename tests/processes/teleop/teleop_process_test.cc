#include "processes/teleop/teleop_process.h"

#include "estimation/base/input_error.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"
#include "tests/support/child_process.h"
#include "tests/support/pseudo_terminal.h"

#include <waymark/stop_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kStart = 1'000'000'000;

std::int64_t Utime(double s) {
  return kStart + static_cast<std::int64_t>(s * 1e6 + 0.5);
}
Time At(double s) {
  return TimeFromMicroseconds(Utime(s));
}

class TeleopProcessTest : public testing::Test {
 protected:
  void Start() {
    process_ = std::make_unique<TeleopProcess>(
        TeleopConfig{}, world_.AddProcess("teleop"), pty_.fd(), pty_.fd());
  }
  velocity_t LastRequest() {
    return world_.Messages<velocity_t>(kMotionRequest).back();
  }

  PseudoTerminal pty_;
  LocalBus world_{At(0)};
  std::unique_ptr<TeleopProcess> process_;
};

TEST_F(TeleopProcessTest, DrivesWhileAKeyIsRepeatedAndStandsSoonAfter) {
  Start();
  world_.RunUntil(At(0.2));
  EXPECT_EQ(LastRequest().forward, 0.0) << "no key is said, too";
  EXPECT_EQ(LastRequest().source, "teleop");
  for (int i = 0; i < 10; ++i) {
    pty_.Type("w");
    world_.RunUntil(At(0.2 + 0.05 * (i + 1)));
    EXPECT_NEAR(LastRequest().forward, 0.2, 1e-12);
  }
  // 0.3 s after the last stroke at the latest.
  world_.RunUntil(At(0.65 + 0.3));
  EXPECT_EQ(LastRequest().forward, 0.0);
  const auto requests = world_.Messages<velocity_t>(kMotionRequest);
  EXPECT_GE(requests.size(), 20u);
  for (std::size_t i = 1; i < requests.size(); ++i) {
    EXPECT_LE(requests[i].utime - requests[i - 1].utime, 50'000) << "20 Hz";
  }
}

TEST_F(TeleopProcessTest, StopsAndLetsGo) {
  Start();
  pty_.Type(" ");
  world_.RunUntil(At(0.02));
  auto stops = world_.Messages<stop_t>(kStop);
  ASSERT_EQ(stops.size(), 1u);
  EXPECT_TRUE(stops[0].is_stopped);
  EXPECT_EQ(stops[0].source, "teleop");
  pty_.Type("g");
  world_.RunUntil(At(0.1));
  stops = world_.Messages<stop_t>(kStop);
  ASSERT_EQ(stops.size(), 2u);
  EXPECT_FALSE(stops[1].is_stopped);
}

TEST_F(TeleopProcessTest, ShowsWhatIsAskedAndAllowedAndWhy) {
  Start();
  pty_.Type("q");
  velocity_t command;
  command.utime = Utime(0.05);
  command.forward = 0.07;
  command.reason = "obstacle at 0.10 m, 3 deg\x1b[2J";
  world_.Publish(kMotionCommand, command);
  base_status_t base;
  base.utime = Utime(0.05);
  base.num_contacts = 3;
  base.is_bumper_right = 1;
  base.is_command_current = 1;
  world_.Publish(kBase, base);
  pose_t pose;
  pose.utime = Utime(0.05);
  pose.is_known = 1;
  pose.pose_W[0] = 1.25;
  world_.Publish(kPose, pose);
  world_.RunUntil(At(0.2));
  const std::string screen = pty_.Screen();
  EXPECT_THAT(screen, HasSubstr("space: STOP"));
  EXPECT_THAT(screen,
              HasSubstr("asked     0.20 m/s   15.0 deg/s   speed 50 %"));
  EXPECT_THAT(screen, HasSubstr("allowed   0.07 m/s"));
  EXPECT_THAT(screen, HasSubstr("obstacle at 0.10 m, 3 deg?[2J"))
      << "nothing of others controls the terminal";
  EXPECT_THAT(screen, HasSubstr("3 contacts, right"));
  EXPECT_THAT(screen, HasSubstr("x 1.25 m"));
  world_.RunUntil(At(1.0));
  EXPECT_THAT(pty_.Screen(), HasSubstr("no MOTION_COMMAND"))
      << "what is old is not shown as if it were new";
}

TEST_F(TeleopProcessTest, TakesTheRobotsTime) {
  Start();
  base_status_t base;
  base.utime = 5'000'000;  // A simulation with a time of its own.
  world_.PublishAt(At(0.1), kBase, base);
  world_.RunUntil(At(0.3));
  // What has passed since is added; it asks every 40 ms.
  EXPECT_NEAR(static_cast<double>(LastRequest().utime), 5'180'000, 20'000);
  world_.RunUntil(At(1.0));
  EXPECT_GT(LastRequest().utime, kStart) << "BASE is too old";
  base.utime = -1;
  world_.PublishAt(At(1.1), kBase, base);
  world_.RunUntil(At(1.1));
  EXPECT_EQ(world_.Status("teleop").num_bad, 1);
}

TEST_F(TeleopProcessTest, GivesTheTerminalBack) {
  const termios before = pty_.settings();
  Start();
  EXPECT_EQ(pty_.settings().c_lflag & (ICANON | ECHO), 0u);
  process_->Finish();
  world_.RunUntil(At(0.01));
  EXPECT_EQ(LastRequest().forward, 0.0);
  process_.reset();
  EXPECT_EQ(pty_.settings().c_lflag, before.c_lflag);
  EXPECT_EQ(pty_.settings().c_cc[VSUSP], before.c_cc[VSUSP]);
}

TEST_F(TeleopProcessTest, RefusesWhatIsNoTerminal) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  EXPECT_THROW(TeleopProcess({}, world_.AddProcess("teleop"), pipe[0], pipe[1]),
               InputError);
  ::close(pipe[0]);
  ::close(pipe[1]);
}

// The executable itself, in a shell that gives it the terminal.
class TeleopExecutableTest : public testing::Test {
 protected:
  std::vector<std::string> Command(const std::string& redirection) {
    return {"sh",
            "-c",
            "exec " + BuildPath("bin/teleop") + " --lcm-url memq:// " +
                redirection};
  }
  static bool Shows(PseudoTerminal* pty, const std::string& text) {
    for (int i = 0; i < 200; ++i) {
      if (pty->Screen().find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }
};

TEST_F(TeleopExecutableTest, RefusesToRunWithoutATerminal) {
  const ChildResult result = RunChild(Command("</dev/null"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err,
            "teleop: the standard input is no terminal: teleop reads the "
            "keyboard\n");
}

TEST_F(TeleopExecutableTest, RestoresTheTerminalWhateverEndsIt) {
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGABRT}) {
    PseudoTerminal pty;
    const termios before = pty.settings();
    ChildProcess teleop(Command("<" + pty.device() + " >" + pty.device()));
    ASSERT_TRUE(Shows(&pty, "asked     0.00 m/s")) << teleop.ErrSoFar();
    EXPECT_EQ(pty.settings().c_lflag & ICANON, 0u);
    pty.Type("w");
    ASSERT_TRUE(Shows(&pty, "asked     0.20 m/s")) << pty.Screen();
    teleop.Signal(signal);
    const ChildResult result = teleop.Wait();
    EXPECT_EQ(result.exit_code,
              signal == SIGTERM || signal == SIGINT ? 0 : 128 + signal)
        << result.err;
    EXPECT_EQ(pty.settings().c_lflag, before.c_lflag) << "signal " << signal;
  }
}

}  // namespace
}  // namespace waymark
