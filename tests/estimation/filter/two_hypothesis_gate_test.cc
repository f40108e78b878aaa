#include "estimation/filter/two_hypothesis_gate.h"

#include "estimation/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace waymark {
namespace {

AbsoluteFix LateralFix() {
  AbsoluteFix fix;
  fix.has = {false, true, true};
  fix.covariance.diagonal() << 0, 9e-4, 1e-4;
  return fix;
}

Innovation InnovationOf(const AbsoluteFix& fix,
                        double y,
                        double heading,
                        double scale) {
  Innovation v;
  v.residual.resize(2);
  v.residual << y, heading;
  v.H.setZero(2, 6);
  v.R = fix.covariance.bottomRightCorner<2, 2>();
  v.HPH = scale * v.R;
  return v;
}

double Probability(double y, double heading, double scale) {
  const AbsoluteFix fix = LateralFix();
  return RegularProbability(fix.has, InnovationOf(fix, y, heading, scale), {});
}

TEST(RegularProbability, FallsWithTheInnovation) {
  double last = 1;
  for (double y = 0; y < 0.4; y += 0.01) {
    const double p = Probability(y, 0, 1);
    EXPECT_LE(p, last);
    EXPECT_GE(p, 0);
    EXPECT_DOUBLE_EQ(p, Probability(-y, 0, 1));
    last = p;
  }
  EXPECT_GT(Probability(0, 0, 1), 0.999);
  EXPECT_LT(last, 0.05);
}

// By hand for one component: N(0.2; 0.1^2) against N(0.2; 0.1^2 + 1^2).
TEST(RegularProbability, IsBayesRule) {
  AbsoluteFix fix;
  fix.has = {true, false, false};
  Innovation v;
  v.residual.setConstant(1, 0.2);
  v.H.setZero(1, 6);
  v.R.setConstant(1, 1, 0.004);
  v.HPH.setConstant(1, 1, 0.006);
  GateOptions options;
  options.prior_regular = 0.9;
  const double regular = 0.9 * std::exp(-0.5 * 0.04 / 0.01) / 0.1;
  const double faulty = 0.1 * std::exp(-0.5 * 0.04 / 1.01) / std::sqrt(1.01);
  EXPECT_NEAR(RegularProbability(fix.has, v, options),
              regular / (regular + faulty),
              1e-12);
}

// A filter that knows nothing must not lock itself out.
TEST(RegularProbability, UncertainFilterAccepts) {
  EXPECT_GT(Probability(20, 2, 1e6), 0.95);
}

TEST(RegularProbability, BrokenInnovationIsFaulty) {
  EXPECT_EQ(Probability(std::nan(""), 0, 1), 0);
  EXPECT_EQ(Probability(0, 0, -3), 0);
  EXPECT_EQ(Probability(0, 0, std::numeric_limits<double>::infinity()), 0);
}

// Row Y11: faulty measurements with sigma 1 m and 0.5 rad among regular ones.
TEST(RegularProbability, SeparatesFaultyFromRegular) {
  Random random(11);
  constexpr int kDraws = 20'000;
  int regular_accepted = 0;
  int faulty_accepted = 0;
  for (int i = 0; i < kDraws; ++i) {
    // Twice the variance of the measurement: the filter's own adds as much.
    const double y = random.Normal(0.03 * std::sqrt(2.0));
    const double heading = random.Normal(0.01 * std::sqrt(2.0));
    if (Probability(y, heading, 1) > 0.95) ++regular_accepted;
    if (Probability(y + random.Normal(1.0), heading + random.Normal(0.5), 1) >
        0.95) {
      ++faulty_accepted;
    }
  }
  const double detection = static_cast<double>(regular_accepted) / kDraws;
  const double false_alarm = static_cast<double>(faulty_accepted) / kDraws;
  std::printf("accepted: %.4f of the regular, %.4f of the faulty\n",
              detection,
              false_alarm);
  EXPECT_GT(detection, 0.995);
  // By chance a faulty one lies within four sigma in both components: about
  // (0.34 / 2.5) (0.11 / 1.25) of them.
  EXPECT_LT(false_alarm, 0.015);
}

}  // namespace
}  // namespace waymark
