#include "logs/import/reference_split.h"

#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

Reference StraightReference(int num_samples) {
  Reference reference;
  reference.p_RS = {0.03, 0.01};
  reference.sigma = {0.001, 0.002, 0.003};
  for (int i = 0; i < num_samples; ++i) {
    TruthSample sample;
    sample.time = kRecordingEpoch + Duration(50'000 * i);
    sample.p_WS = {0.01 * i, -0.02 * i};
    sample.heading = 3.13;
    reference.samples.push_back(sample);
  }
  return reference;
}

TEST(ReferenceSplitTest, EveryTenthIsAFixAndTheOthersAreTruth) {
  const Reference reference = StraightReference(101);
  const ReferenceSplit split =
      SplitReference(reference, ReferenceSplitOptions{});
  ASSERT_EQ(split.fixes.size(), 11u);  // 0, 10, ..., 100.
  ASSERT_EQ(split.truth.size(), 90u);
  for (std::size_t i = 0; i < split.fixes.size(); ++i) {
    const AbsoluteFix& fix = split.fixes[i];
    EXPECT_EQ(fix.time, reference.samples[10 * i].time);
    EXPECT_EQ(fix.seq, static_cast<std::int64_t>(i));
    EXPECT_EQ(fix.source, "reference, every 10th, noise 0.02 m, seed 1");
    EXPECT_TRUE(fix.has[0] && fix.has[1]);
    EXPECT_FALSE(fix.has[2]);
    EXPECT_EQ(fix.X_RS, (Pose2{0.03, 0.01, 0.0}));
    EXPECT_DOUBLE_EQ(fix.covariance(0, 0), 1e-6 + 4e-4);
    EXPECT_DOUBLE_EQ(fix.covariance(1, 1), 4e-6 + 4e-4);
    EXPECT_EQ(fix.covariance(2, 2), 0.0);
  }
  // No sample is both, none is lost, and truth is as recorded.
  std::size_t next = 0;
  for (std::size_t i = 0; i < reference.samples.size(); ++i) {
    if (i % 10 == 0) continue;
    EXPECT_EQ(split.truth[next].time, reference.samples[i].time);
    EXPECT_EQ(split.truth[next].p_WS, reference.samples[i].p_WS);
    ++next;
  }
}

// The added noise is what it is said to be: mean 0, the stated sigma, and
// independent of the sample.
TEST(ReferenceSplitTest, NoiseIsAsStated) {
  const int n = 20'000;
  const Reference reference = StraightReference(n);
  ReferenceSplitOptions options;
  options.every = 1;
  options.use_heading = true;
  const ReferenceSplit split = SplitReference(reference, options);
  ASSERT_EQ(split.fixes.size(), static_cast<std::size_t>(n));
  EXPECT_TRUE(split.truth.empty());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < split.fixes.size(); ++i) {
    const TruthSample& sample = reference.samples[i];
    const AbsoluteFix& fix = split.fixes[i];
    const Eigen::Vector3d error(fix.value(0) - sample.p_WS.x(),
                                fix.value(1) - sample.p_WS.y(),
                                WrapAngle(fix.value(2) - *sample.heading));
    EXPECT_LE(std::abs(fix.value(2)), kPi);
    sum += error;
    squares += error.cwiseAbs2();
  }
  const Eigen::Vector3d sigma(0.02, 0.02, 0.01);
  for (int i = 0; i < 3; ++i) {
    // Four standard errors of a mean and of a variance.
    EXPECT_LT(std::abs(sum(i) / n), 4.0 * sigma(i) / std::sqrt(n));
    EXPECT_NEAR(
        squares(i) / n / (sigma(i) * sigma(i)), 1.0, 4.0 * std::sqrt(2.0 / n));
  }
  EXPECT_EQ(split.fixes[0].source,
            "reference, every 1st, noise 0.02 m and 0.01 rad, seed 1");
}

TEST(ReferenceSplitTest, CalibrationTakesEverySampleAsItIs) {
  const Reference reference = StraightReference(25);
  ReferenceSplitOptions options;
  options.use = ReferenceUse::kCalibration;
  options.use_heading = true;
  const ReferenceSplit split = SplitReference(reference, options);
  ASSERT_EQ(split.fixes.size(), 25u);
  EXPECT_TRUE(split.truth.empty());
  for (std::size_t i = 0; i < split.fixes.size(); ++i) {
    const AbsoluteFix& fix = split.fixes[i];
    EXPECT_EQ(fix.value,
              Eigen::Vector3d(reference.samples[i].p_WS.x(),
                              reference.samples[i].p_WS.y(),
                              3.13));
    EXPECT_DOUBLE_EQ(fix.covariance(0, 0), 1e-6);
    EXPECT_DOUBLE_EQ(fix.covariance(2, 2), 9e-6);
    EXPECT_EQ(fix.source, "reference, every sample, no added noise");
  }
}

TEST(ReferenceSplitTest, SameSeedSameNoiseWithOrWithoutHeading) {
  const Reference reference = StraightReference(50);
  ReferenceSplitOptions options;
  const ReferenceSplit a = SplitReference(reference, options);
  options.use_heading = true;
  const ReferenceSplit b = SplitReference(reference, options);
  options.seed = 2;
  const ReferenceSplit c = SplitReference(reference, options);
  for (std::size_t i = 0; i < a.fixes.size(); ++i) {
    EXPECT_EQ(a.fixes[i].value.head<2>(), b.fixes[i].value.head<2>());
    EXPECT_NE(a.fixes[i].value.head<2>(), c.fixes[i].value.head<2>());
  }
}

TEST(ReferenceSplitTest, NoReferenceNoFixes) {
  const ReferenceSplit split = SplitReference({}, ReferenceSplitOptions{});
  EXPECT_TRUE(split.fixes.empty());
  EXPECT_TRUE(split.truth.empty());
}

TEST(ReferenceSplitTest, OptionsOutOfRangeAreRefused) {
  Reference reference = StraightReference(3);
  ReferenceSplitOptions options;
  options.every = 0;
  EXPECT_THROW((void)SplitReference(reference, options), std::invalid_argument);
  options = {};
  options.noise_m = -0.1;
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.noise_rad = std::nan("");
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.use_heading = true;
  reference.samples[1].heading.reset();
  EXPECT_THROW((void)SplitReference(reference, options), std::invalid_argument);
}

}  // namespace
}  // namespace waymark
