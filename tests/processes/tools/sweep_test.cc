#include "processes/tools/experiment/sweep.h"

#include "estimation/base/input_error.h"
#include "estimation/base/random.h"
#include "processes/tools/experiment/experiment_tool.h"
#include "processes/tools/experiment/sweep_report.h"
#include "tests/support/temporary_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Draws its figures, and does what a seed says: 13 throws, 17 crashes.
class DiceExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view name() const override { return "dice"; }
  void Describe(Describer& d) override {
    d.Number("luck", &luck, {0.0, 1.0}, "Share of success");
  }
  void Prepare() override {}
  [[nodiscard]] std::string Subject() const override { return "dice"; }
  [[nodiscard]] RunResult Run(std::uint64_t seed,
                              const std::string& /*log*/) const override {
    if (seed == 13) throw std::runtime_error("no luck");
    if (seed == 17 && crashes) std::raise(SIGKILL);
    Random random(SeedFor(seed, "dice"));
    usleep(static_cast<useconds_t>(3000.0 * random.Uniform()));
    RunResult result;
    result.is_success = random.Uniform() < luck;
    if (!result.is_success) result.reason = "lost";
    result.num_touches = random.Uniform() < 0.1 ? 1 : 0;
    result.way_m = random.Uniform(1.0, 2.0);
    result.shortest_m = 1.0 / 3.0 + random.Uniform(0.0, 0.5);
    result.duration_s = 1e-300 * random.Uniform();
    result.figures = {{"b_m", random.Normal()}, {"a_m", 0.1}};
    return result;
  }

  double luck = 0.7;
  bool crashes = false;
};

std::vector<std::uint64_t> Seeds(std::uint64_t num) {
  std::vector<std::uint64_t> seeds(num);
  std::iota(seeds.begin(), seeds.end(), 1);
  return seeds;
}

std::string TextOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

class SweepTest : public testing::Test {
 protected:
  SweepReport Sweep(const DiceExperiment& experiment,
                    const std::string& path,
                    std::uint64_t num,
                    int num_jobs) {
    ResultsFile file(path, "dice", "luck: 0.7\n");
    return RunSweep(experiment, {Seeds(num), num_jobs}, &file);
  }
  std::string Path(const std::string& name) { return folder_ / name; }

  TemporaryDirectory folder_;
  DiceExperiment dice_;
};

TEST_F(SweepTest, SameSeedsSameBytesWhateverTheNumberOfJobs) {
  const SweepReport one = Sweep(dice_, Path("one"), 40, 1);
  const SweepReport five = Sweep(dice_, Path("five"), 40, 5);
  EXPECT_EQ(one.results.size(), 40u);
  EXPECT_TRUE(one.is_complete);
  EXPECT_EQ(one.results, five.results);
  EXPECT_EQ(TextOf(Path("one")), TextOf(Path("five")));
  // In this process without any file in between.
  RunResult direct = dice_.Run(7, "");
  direct.seed = 7;
  EXPECT_EQ(one.results[6], direct);
  const SweepSummary summary = SummariseRuns(one.results);
  EXPECT_EQ(SweepJson("dice", "", summary, one.results),
            SweepJson("dice", "", SummariseRuns(five.results), five.results));
}

TEST_F(SweepTest, GoesOnWhereItWasKilledAndRepeatsNothing) {
  (void)Sweep(dice_, Path("whole"), 20, 2);
  const std::string whole = TextOf(Path("whole"));
  // As a kill leaves it, at every byte of the last line and some before.
  for (const std::size_t cut : {5000ul, 300ul, 150ul, 30ul, 2ul, 1ul, 0ul}) {
    if (cut > whole.size()) continue;
    std::ofstream(Path("torn"), std::ios::binary)
        << whole.substr(0, whole.size() - cut);
    const SweepReport report = Sweep(dice_, Path("torn"), 20, 2);
    EXPECT_EQ(report.results.size(), 20u);
    EXPECT_EQ(TextOf(Path("torn")), whole) << cut;
  }
  // Only what is missing is run: with another luck it would come out otherwise.
  DiceExperiment unlucky;
  unlucky.luck = 0.0;
  const SweepReport more = Sweep(unlucky, Path("torn"), 25, 2);
  const SweepReport before = Sweep(dice_, Path("whole"), 20, 2);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(more.results[i], before.results[i]);
  }
  for (std::size_t i = 20; i < 25; ++i) {
    EXPECT_FALSE(more.results[i].is_success);
  }
}

TEST_F(SweepTest, RunsThatThrowOrCrashAreFailuresAndNoMore) {
  dice_.crashes = true;
  const SweepReport report = Sweep(dice_, Path("crash"), 20, 3);
  EXPECT_TRUE(report.has_crashed);
  ASSERT_EQ(report.results.size(), 20u);
  EXPECT_EQ(report.results[12].reason, "fault: no luck");
  EXPECT_EQ(report.results[16].reason, "crashed: Killed");
  EXPECT_EQ(report.results[16].seed, 17u);
  // What crashed is tried again.
  dice_.crashes = false;
  const SweepReport again = Sweep(dice_, Path("crash"), 20, 3);
  EXPECT_FALSE(again.has_crashed);
  RunResult direct = dice_.Run(17, "");
  direct.seed = 17;
  EXPECT_EQ(again.results[16], direct);
}

// Its own runs and the number of those with a log, in this process.
class LoggedDice final : public Experiment {
 public:
  explicit LoggedDice(std::vector<std::uint64_t>* logged) : logged_(logged) {}
  [[nodiscard]] std::string_view name() const override { return "dice"; }
  void Describe(Describer& d) override {
    d.Number("luck", &luck_, {0.0, 1.0}, "Share of success");
  }
  void Prepare() override {}
  [[nodiscard]] std::string Subject() const override { return "dice"; }
  [[nodiscard]] RunResult Run(std::uint64_t seed,
                              const std::string& log) const override {
    RunResult result;
    result.reason = "lost";
    result.num_touches = static_cast<std::int64_t>(seed);
    if (!log.empty()) {
      logged_->push_back(seed);
      std::ofstream(log) << "log of " << seed;
    }
    return result;
  }

 private:
  double luck_ = 0.5;
  std::vector<std::uint64_t>* logged_;
};

// What has been logged is not run again; what is not whole, or of results that
// are gone, is.
TEST_F(SweepTest, LogsOfTheWorstRunsAreMadeOnce) {
  std::vector<std::uint64_t> logged;
  const auto run = [&](int num_seeds) {
    logged.clear();
    std::vector<std::string> words{"waymark-experiment",
                                   "dice",
                                   "--out=" + Path("out"),
                                   "--keep-worst=2",
                                   "--seeds=" + std::to_string(num_seeds)};
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    testing::internal::CaptureStdout();
    const int code = RunExperimentTool(
        static_cast<int>(argv.size()),
        argv.data(),
        {{"dice", "", [&] { return std::make_unique<LoggedDice>(&logged); }}});
    const std::string output = testing::internal::GetCapturedStdout();
    EXPECT_THAT(
        output,
        HasSubstr("worst/seed_" + std::to_string(num_seeds) + ".lcm: lost\n"));
    return code;
  };
  EXPECT_EQ(run(4), 0);
  EXPECT_THAT(logged, ElementsAre(4, 3));
  EXPECT_EQ(run(4), 0);
  EXPECT_THAT(logged, ElementsAre());
  EXPECT_EQ(run(5), 0);
  EXPECT_THAT(logged, ElementsAre(5));
  const std::filesystem::path worst = Path("out/worst");
  EXPECT_FALSE(std::filesystem::exists(worst / "seed_3.lcm"));
  // Stopped while it wrote.
  std::filesystem::rename(worst / "seed_5.lcm", worst / "seed_5.lcm.part");
  EXPECT_EQ(run(5), 0);
  EXPECT_THAT(logged, ElementsAre(5));
  EXPECT_FALSE(std::filesystem::exists(worst / "seed_5.lcm.part"));
  std::filesystem::remove(Path("out/runs.jsonl"));
  EXPECT_EQ(run(5), 0);
  EXPECT_THAT(logged, ElementsAre(5, 4));
}

TEST_F(SweepTest, ASignalStopsItAndKeepsWhatIsDone) {
  class Signalled final : public Experiment {
   public:
    explicit Signalled(pid_t parent) : parent_(parent) {}
    [[nodiscard]] std::string_view name() const override { return "dice"; }
    void Describe(Describer& /*d*/) override {}
    void Prepare() override {}
    [[nodiscard]] std::string Subject() const override { return "dice"; }
    [[nodiscard]] RunResult Run(std::uint64_t seed,
                                const std::string& /*log*/) const override {
      if (seed == 3) {
        kill(parent_, SIGTERM);
        pause();  // Killed from outside.
      }
      return {};
    }
    pid_t parent_;
  };
  ResultsFile file(Path("signal"), "dice", "");
  const Signalled experiment(getpid());
  const SweepReport report = RunSweep(experiment, {Seeds(10), 1}, &file);
  EXPECT_FALSE(report.is_complete);
  EXPECT_EQ(report.results.size(), 2u);
}

TEST_F(SweepTest, ResultsOfSomethingElseAreRefusedInOneLine) {
  (void)Sweep(dice_, Path("file"), 2, 1);
  const auto error_of = [&](const std::string& name, const std::string& text) {
    try {
      ResultsFile file(Path("file"), name, text);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(error_of("dice", "luck: 0.7\n"), "none");
  EXPECT_THAT(error_of("dice", "luck: 0.8\n"),
              HasSubstr("file:1: results of another configuration: "
                        "'luck: 0.7' there, 'luck: 0.8' here"));
  EXPECT_THAT(error_of("drive", "luck: 0.7\n"), HasSubstr("experiment"));
  for (const char* text :
       {"hello\n", "{}\n", "[1]\n", "{\"experiment\":3}\n", "\n"}) {
    std::ofstream(Path("file"), std::ios::binary) << text;
    EXPECT_THAT(error_of("dice", "luck: 0.7\n"), HasSubstr("file:1: "));
  }
  std::ofstream(Path("file"), std::ios::binary)
      << "{\"experiment\":\"dice\",\"configuration\":\"luck: 0.7\\n\"}\n"
      << "{\"seed\":-1}\n";
  EXPECT_THAT(error_of("dice", "luck: 0.7\n"), HasSubstr("file:2: "));
  EXPECT_THROW(ResultsFile(Path("none/there"), "dice", ""), InputError);
}

TEST(SweepReport, CountsByHand) {
  std::vector<RunResult> results(4);
  results[0] = {1, true, "", 0, 12.0, 10.0, 30.0, {{"error_m", 0.1}}};
  results[1] = {2, false, "late", 2, 30.0, 10.0, 99.0, {{"error_m", 0.3}}};
  results[2] = {3, true, "", 1, 10.0, 10.0, 20.0, {{"error_m", 0.2}}};
  results[3] = {4, false, "late", 0, 5.0, 10.0, 99.0, {}};
  const SweepSummary s = SummariseRuns(results);
  EXPECT_EQ(s.num_runs, 4);
  EXPECT_EQ(s.num_successes, 2);
  EXPECT_EQ(s.num_touches, 3);
  EXPECT_EQ(s.num_untouched, 2);
  EXPECT_DOUBLE_EQ(s.spl, (10.0 / 12.0 + 1.0) / 4.0);
  EXPECT_EQ(s.way_over_shortest.num, 2);
  EXPECT_DOUBLE_EQ(s.way_over_shortest.mean, 1.1);
  EXPECT_DOUBLE_EQ(s.duration_s.mean, 25.0);
  EXPECT_EQ(s.figures[0].second.num, 3);
  EXPECT_DOUBLE_EQ(s.figures[0].second.median, 0.2);
  EXPECT_EQ(s.reasons.at("late"), 2);
  EXPECT_NEAR(s.success.low, WilsonInterval(2, 4).low, 1e-15);
  EXPECT_THAT(WorstSeeds(results, 9), ElementsAre(2, 4, 3));
  EXPECT_THAT(WorstSeeds(results, 1), ElementsAre(2));
  const std::string table = SweepTable("dice", s);
  EXPECT_THAT(table, HasSubstr("2 of 4 (50.0 %, 95 % in 15.0 to 85.0 %)"));
  EXPECT_THAT(table, HasSubstr("2 x late"));
  EXPECT_EQ(SummariseRuns({}).num_runs, 0);
}

TEST(SweepReport, LinesOfResultsReadBackBitForBit) {
  RunResult result;
  result.seed = 0xFFFFFFFFFFFFFFFFull;
  result.reason = "a \"quoted\"\nline";
  result.way_m = 0.1 + 0.2;
  result.shortest_m = 5e-324;
  result.figures = {{"z", 1.0 / 3.0}, {"a", -0.0}};
  EXPECT_EQ(ResultOfLine(LineOfResult(result)), result);
}

}  // namespace
}  // namespace waymark
