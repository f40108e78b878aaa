// The launcher script: starts, restarts with back-off, stops in order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

namespace {

using testing::HasSubstr;
using testing::Not;

class LauncherTest : public testing::Test {
 protected:
  LauncherTest() {
    const char* source = std::getenv("WAYMARK_SOURCE");
    script_ =
        std::string(source == nullptr ? "." : source) + "/procman/launcher.sh";
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("launcher_test_") + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~LauncherTest() override {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    std::filesystem::remove_all(folder_);
  }

  void Start(const std::string& list) {
    std::ofstream(folder_ / "list") << list;
    pid_ = fork();
    if (pid_ == 0) {
      const std::string err = (folder_ / "err").string();
      if (std::freopen(err.c_str(), "w", stderr) == nullptr) _exit(99);
      execl(script_.c_str(),
            script_.c_str(),
            (folder_ / "list").c_str(),
            (folder_ / "logs").c_str(),
            nullptr);
      _exit(99);
    }
  }
  int Wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string Text(const std::string& name) const {
    std::ifstream file(folder_ / name);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }
  // False where the text does not appear within 20 s (a loaded machine).
  bool Appears(const std::string& name, const std::string& text) const {
    for (int i = 0; i < 400; ++i) {
      if (Text(name).find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }

  std::string script_;
  std::filesystem::path folder_;
  pid_t pid_ = -1;
};

TEST_F(LauncherTest, StopsFromTheLastToTheFirst) {
  const std::string trap =
      "bash -c \"trap 'echo bye; exit 0' TERM; echo up; "
      "while :; do sleep 0.05; done\"\n";
  Start("# recorder first\n\nfirst: " + trap + "second: " + trap);
  ASSERT_TRUE(Appears("logs/first.txt", "up"));
  ASSERT_TRUE(Appears("logs/second.txt", "up"));
  kill(pid_, SIGTERM);
  EXPECT_EQ(Wait(), 0);
  EXPECT_EQ(Text("logs/first.txt"), "up\nbye\n");
  EXPECT_EQ(Text("logs/second.txt"), "up\nbye\n");
  const std::string log = Text("logs/launcher.txt");
  EXPECT_LT(log.find("second: ended with 0"), log.find("first: ended with 0"));
}

TEST_F(LauncherTest, RestartsWhatCrashesAndLeavesWhatIsDone) {
  Start(
      "crash: bash -c 'echo again; exit 3'\n"
      "done: bash -c 'echo once'\n");
  ASSERT_TRUE(Appears("logs/crash.txt", "again\nagain\n"));
  kill(pid_, SIGTERM);
  Wait();
  EXPECT_EQ(Text("logs/done.txt"), "once\n");
  EXPECT_THAT(Text("err"), HasSubstr("crash ended with 3; again in 500 ms"));
}

TEST_F(LauncherTest, BadInputOfAProcessIsNotRestarted) {
  Start("bad: bash -c 'echo what is wrong >&2; exit 2'\n");
  EXPECT_EQ(Wait(), 1);  // Ends by itself: nothing is left to run.
  EXPECT_EQ(Text("err"), "launcher: bad: what is wrong\n");
  EXPECT_EQ(Text("logs/bad.txt"), "what is wrong\n");
}

TEST_F(LauncherTest, SaysWhichLineIsWrong) {
  Start("good: true\nno colon here\n");
  EXPECT_EQ(Wait(), 2);
  EXPECT_THAT(Text("err"), HasSubstr("list:2: expected 'name: command'"));
  Start("twice: true\ntwice: true\n");
  EXPECT_EQ(Wait(), 2);
  EXPECT_THAT(Text("err"), HasSubstr("list:2: second process of name"));
  EXPECT_THAT(Text("err"), Not(HasSubstr("line ")));  // Bash's own errors.
}

}  // namespace
