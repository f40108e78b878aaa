#include "estimation/base/statistics.h"

#include "estimation/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

TEST(Statistics, SummaryOfKnownValues) {
  const std::vector<double> values{3, 1, 2, 4};
  const Summary s = Summarise(values);
  EXPECT_EQ(s.num, 4);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.p95, 4);
  EXPECT_DOUBLE_EQ(s.max, 4);
  std::vector<double> hundred;
  for (int i = 100; i > 0; --i) hundred.push_back(i);
  EXPECT_DOUBLE_EQ(Summarise(hundred).p95, 95);
  EXPECT_EQ(Summarise({}).num, 0);
}

// Table I of R. G. Newcombe, Statistics in Medicine 17, 857-872, 1998,
// method 3.
TEST(Statistics, WilsonIntervalsOfTheLiterature) {
  const auto expect = [](int r, int n, double low, double high) {
    const Interval interval = WilsonInterval(r, n);
    EXPECT_NEAR(interval.low, low, 5e-5) << r << "/" << n;
    EXPECT_NEAR(interval.high, high, 5e-5) << r << "/" << n;
  };
  expect(81, 263, 0.2553, 0.3662);
  expect(15, 148, 0.0624, 0.1605);
  expect(0, 20, 0.0, 0.1611);
  expect(1, 29, 0.0061, 0.1718);
}

TEST(Statistics, WilsonHoldsTheTruthAsOftenAsItSays) {
  Random random(SeedFor(1, "wilson"));
  for (const double p : {0.05, 0.5, 0.9}) {
    int num_held = 0;
    constexpr int kTrials = 4000;
    for (int trial = 0; trial < kTrials; ++trial) {
      int successes = 0;
      for (int i = 0; i < 60; ++i) successes += random.Uniform() < p ? 1 : 0;
      const Interval interval = WilsonInterval(successes, 60);
      num_held += interval.low <= p && p <= interval.high ? 1 : 0;
    }
    // It is known to swing by some 2 % about 95 % for such n.
    EXPECT_NEAR(num_held / static_cast<double>(kTrials), 0.95, 0.03) << p;
  }
}

TEST(Statistics, WilsonIsSymmetricAndRefusesNonsense) {
  for (int r = 0; r <= 10; ++r) {
    const Interval a = WilsonInterval(r, 10);
    const Interval b = WilsonInterval(10 - r, 10);
    EXPECT_NEAR(a.low, 1.0 - b.high, 1e-12);
    EXPECT_LE(a.low, r / 10.0);
    EXPECT_GE(a.high, r / 10.0);
  }
  EXPECT_EQ(WilsonInterval(0, 0).high, 1.0);
  EXPECT_EQ(WilsonInterval(7, 7).high, 1.0);
  EXPECT_THROW((void)WilsonInterval(2, 1), std::logic_error);
  EXPECT_THROW((void)WilsonInterval(-1, 1), std::logic_error);
}

TEST(Statistics, SplWeighsSuccessByHowDirectItWas) {
  const std::vector<PathOutcome> outcomes{{true, 10.0, 10.0},
                                          {true, 20.0, 10.0},
                                          {false, 10.0, 10.0},
                                          // Shorter than the shortest: within
                                          // a goal's tolerance.
                                          {true, 9.9, 10.0}};
  EXPECT_DOUBLE_EQ(SuccessWeightedByPathLength(outcomes), (1 + 0.5 + 1) / 4.0);
  EXPECT_EQ(SuccessWeightedByPathLength({}), 0.0);
  const PathOutcome there{true, 0.0, 0.0};
  EXPECT_EQ(SuccessWeightedByPathLength({&there, 1}), 1.0);
}

}  // namespace
}  // namespace waymark
