#include "logs/evaluation/consistency.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

// Tables of the chi-square distribution, five digits.
TEST(ChiSquareQuantile, AgreesWithTables) {
  EXPECT_NEAR(ChiSquareQuantile(0.95, 1), 3.84146, 1e-5);
  EXPECT_NEAR(ChiSquareQuantile(0.95, 2), 5.99146, 1e-5);
  EXPECT_NEAR(ChiSquareQuantile(0.975, 3), 9.34840, 1e-5);
  EXPECT_NEAR(ChiSquareQuantile(0.025, 3), 0.215795, 1e-6);
  EXPECT_NEAR(ChiSquareQuantile(0.025, 600), 534.019, 1e-3);
  EXPECT_NEAR(ChiSquareQuantile(0.975, 600), 669.769, 1e-3);
  // Two degrees of freedom: the distribution is exponential.
  EXPECT_NEAR(ChiSquareQuantile(0.3, 2), -2 * std::log(0.7), 1e-12);
  EXPECT_THROW((void)ChiSquareQuantile(1.0, 2), std::logic_error);
}

AssociatedPair Sample(Random* random, double scale) {
  Eigen::Matrix3d P;
  P << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.01;
  const Eigen::Matrix3d L = P.llt().matrixL();
  const Eigen::Vector3d e =
      scale * (L * Eigen::Vector3d(
                       random->Normal(), random->Normal(), random->Normal()));
  AssociatedPair pair;
  const Pose2 X_WR{1, 2, 3.1};
  pair.truth.p_RS = {0.2, -0.4};
  pair.truth.heading = WrapAngle(X_WR.heading - e.z());
  // First-order: the truth's point is where the estimate's is, less the error
  // carried to S.
  const Pose2 truth{X_WR.x - e.x(), X_WR.y - e.y(), *pair.truth.heading};
  pair.truth.p_WS = truth * pair.truth.p_RS;
  pair.estimate = {Time(), X_WR, P};
  return pair;
}

TEST(Nees, ConsistentErrorsStayInTheirBand) {
  for (const int dof : {2, 3}) {
    Random random(42);
    std::vector<AssociatedPair> pairs;
    constexpr int kNum = 4000;
    for (int i = 0; i < kNum; ++i) pairs.push_back(Sample(&random, 1.0));
    const auto nees = EvaluateNees(pairs, dof);
    ASSERT_TRUE(nees);
    // Mean scatters by sqrt(2 dof / 4000) = 0.04, the share by
    // sqrt(0.95 * 0.05 / 4000) = 0.0035; four sigma each, plus 0.02 for the
    // curvature of a heading error of 0.1 rad on a lever of 0.45 m.
    EXPECT_NEAR(nees->mean, dof, 4 * std::sqrt(2.0 * dof / kNum) + 0.02);
    EXPECT_NEAR(nees->share_inside, 0.95, 0.014);
    EXPECT_NEAR(
        nees->share_below + nees->share_inside + nees->share_above, 1, 1e-12);
  }
}

TEST(Nees, TellsOverconfidenceFromCaution) {
  Random random(43);
  std::vector<AssociatedPair> bold;
  std::vector<AssociatedPair> shy;
  for (int i = 0; i < 1000; ++i) {
    bold.push_back(Sample(&random, 4.0));
    shy.push_back(Sample(&random, 0.1));
  }
  EXPECT_GT(EvaluateNees(bold, 2)->share_above, 0.5);
  EXPECT_EQ(EvaluateNees(bold, 2)->share_below < 0.05, true);
  EXPECT_GT(EvaluateNees(shy, 3)->share_below, 0.5);
  EXPECT_EQ(EvaluateNees(shy, 3)->share_above, 0.0);
}

TEST(Nees, HandComputed) {
  AssociatedPair pair;
  pair.estimate = {Time(), {0.2, 0.3, 0}, Eigen::Matrix3d::Identity() * 0.01};
  pair.truth.heading = -0.1;
  const auto position = EvaluateNees({&pair, 1}, 2);
  const auto pose = EvaluateNees({&pair, 1}, 3);
  ASSERT_TRUE(position && pose);
  EXPECT_NEAR(position->values[0], (0.04 + 0.09) / 0.01, 1e-12);
  EXPECT_NEAR(pose->values[0], (0.04 + 0.09 + 0.01) / 0.01, 1e-12);
}

TEST(Nees, CountsUnusableCovariancesAndSaysNothingWithoutAny) {
  AssociatedPair pair;
  EXPECT_FALSE(EvaluateNees({&pair, 1}, 2));
  pair.estimate.covariance = Eigen::Matrix3d::Zero();
  EXPECT_FALSE(EvaluateNees({&pair, 1}, 2));
  std::vector<AssociatedPair> two{pair, pair};
  two[1].estimate.covariance = Eigen::Matrix3d::Identity();
  const auto nees = EvaluateNees(two, 2);
  ASSERT_TRUE(nees);
  EXPECT_EQ(nees->num_unusable, 1);
  EXPECT_FALSE(EvaluateNees(two, 3));  // No headings.
}

TEST(NeesBand, NarrowsWithTheNumberOfRuns) {
  // Bar-Shalom's example: 50 runs of 2 dimensions, [1.48, 2.59] from
  // chi-square quantiles 74.2 and 129.6 at 100 degrees of freedom.
  const Band band = NeesBand(2, 50);
  EXPECT_NEAR(band.low, 1.484, 1e-3);
  EXPECT_NEAR(band.high, 2.591, 1e-3);
}

}  // namespace
}  // namespace waymark
