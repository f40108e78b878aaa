// The committed logs are what the generator makes, and are worth showing:
// dead reckoning is wrong with the nominal parameters, right with the true.
#include "estimation/geometry/angle.h"
#include "logs/evaluation/dead_reckoning.h"
#include "logs/evaluation/trajectory_error.h"
#include "processes/convert/odometry_convert.h"
#include "tests/support/log_samples.h"
#include "tests/support/temporary_directory.h"

#include <waymark/truth_t.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace waymark {
namespace {

std::string CommittedPath(const std::string& name) {
  return std::string(std::getenv("WAYMARK_SOURCE")) + "/logs/samples/" + name;
}

struct Content {
  std::vector<EncoderReading> readings;
  std::vector<AbsoluteFix> fixes;
  std::vector<RelativeMotion> motions;
  std::vector<TruthSample> truth;
  std::optional<InitialPose> start;
  std::optional<OdometryParameters> nominal;
};

Content ReadSample(const std::string& name) {
  Content content;
  std::string reason;
  LogReader reader(CommittedPath(name));
  Time last{};
  while (const auto event = reader.Next()) {
    EXPECT_GE(event->time, last);
    last = event->time;
    if (const auto m = DecodeAs<encoders_t>(*event)) {
      content.readings.push_back(*EncoderReadingFromMessage(*m, &reason));
      EXPECT_FALSE(m->is_virtual);
    } else if (const auto f = DecodeAs<position_fix_t>(*event)) {
      content.fixes.push_back(*AbsoluteFixFromMessage(*f, &reason));
    } else if (const auto r = DecodeAs<relative_motion_t>(*event)) {
      content.motions.push_back(*RelativeMotionFromMessage(*r, &reason));
    } else if (const auto i = DecodeAs<initial_pose_t>(*event)) {
      content.start = InitialPoseFromMessage(*i, &reason);
    } else if (const auto p = DecodeAs<odometry_parameters_t>(*event)) {
      content.nominal = OdometryParametersFromMessage(*p, &reason);
    } else if (const auto t = DecodeAs<truth_t>(*event)) {
      TruthSample sample;
      sample.time = TimeFromMicroseconds(t->utime);
      sample.p_WS = {t->x, t->y};
      sample.heading = t->heading;
      content.truth.push_back(sample);
    }
  }
  EXPECT_TRUE(reader.report().is_sound());
  return content;
}

double Rmse(const Content& content, const WheelParameters& parameters) {
  const TruthSample& first = content.truth.front();
  const auto path = Anchor(DeadReckon(content.readings, parameters),
                           first.time,
                           {first.p_WS.x(), first.p_WS.y(), *first.heading});
  const auto association = Associate(content.truth, path, AssociationOptions{});
  return EvaluateAbsoluteError(association.pairs, Alignment::kNone)
      ->position_summary.rmse;
}

TEST(SamplesTest, CommittedLogsAreWhatTheGeneratorMakes) {
  const TemporaryDirectory folder;
  std::uintmax_t total = 0;
  for (const std::string& name : SampleNames()) {
    WriteSample(name, folder / name, IfExists::kFail);
    EXPECT_EQ(ReadBytes(folder / name), ReadBytes(CommittedPath(name)))
        << name << ": run build/tests/make_samples logs/samples";
    total += std::filesystem::file_size(CommittedPath(name));
  }
  EXPECT_LT(total, 300'000u);
}

TEST(SamplesTest, ParametersMatter) {
  for (const std::string& name : SampleNames()) {
    const Content content = ReadSample(name);
    ASSERT_TRUE(content.nominal) << name;
    EXPECT_EQ(content.readings.size(), 801u);
    EXPECT_EQ(content.truth.size(), 161u);
    const double nominal = Rmse(content, content.nominal->parameters);
    const double truth = Rmse(content, SampleTruth());
    EXPECT_GT(nominal, 0.5) << name;
    // What is left is the drive's own noise.
    EXPECT_LT(truth, 0.2 * nominal) << name;
    // The prior in the log is honest: truth within 2 sigma.
    const Eigen::Vector3d error =
        SampleTruth().vector() - content.nominal->parameters.vector();
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(std::abs(error(i)),
                2.0 * std::sqrt(content.nominal->covariance(i, i)));
    }
  }
}

// Measurements scatter about the truth as their covariances say.
TEST(SamplesTest, MeasurementsAreHonest) {
  const Content zigzag = ReadSample("zigzag.log");
  EXPECT_EQ(zigzag.fixes.size(), 80u);
  EXPECT_TRUE(zigzag.start);
  const Content square = ReadSample("square.log");
  EXPECT_EQ(square.fixes.size(), 40u);
  EXPECT_TRUE(square.fixes[0].has[2]);
  EXPECT_FALSE(square.start);
  for (const Content* content : {&zigzag, &square}) {
    const auto path = DeadReckon(content->readings, SampleTruth());
    double sum = 0.0;
    for (const AbsoluteFix& fix : content->fixes) {
      // Truth comes every 250 ms: the nearest, moved on by dead reckoning.
      const TruthSample* nearest = &content->truth[0];
      for (const TruthSample& sample : content->truth) {
        if (sample.time <= fix.time) nearest = &sample;
      }
      const auto moved =
          Anchor(path,
                 nearest->time,
                 {nearest->p_WS.x(), nearest->p_WS.y(), *nearest->heading});
      TruthSample at_fix;
      at_fix.time = fix.time;
      const std::vector<TruthSample> query = {at_fix};
      const auto pair = Associate(query, moved, AssociationOptions{});
      sum += (pair.pairs[0].estimate.X_WR.position() - fix.value.head<2>())
                 .squaredNorm() /
             fix.covariance(0, 0);
    }
    // Chi-squared with 2 n degrees of freedom: 4 sigma.
    const auto n = static_cast<double>(content->fixes.size());
    EXPECT_NEAR(sum / (2.0 * n), 1.0, 4.0 / std::sqrt(n));
  }
}

TEST(SamplesTest, ScanMatchedMotionsFollowTheTrueMounting) {
  const Content content = ReadSample("scan_matched.log");
  ASSERT_EQ(content.motions.size(), 100u);
  const Pose2 X_RS{0.05, 0.01, RadiansFromDegrees(92.0)};
  const auto path = DeadReckon(content.readings, SampleTruth());
  double sum = 0.0;
  for (const RelativeMotion& motion : content.motions) {
    std::vector<TruthSample> query(2);
    query[0].time = motion.from;
    query[1].time = motion.time;
    const auto at = Associate(query, path, AssociationOptions{});
    ASSERT_EQ(at.pairs.size(), 2u);
    const Pose2 predicted = Between(at.pairs[0].estimate.X_WR * X_RS,
                                    at.pairs[1].estimate.X_WR * X_RS);
    sum += std::abs(WrapAngle(motion.X_S0S1.heading - predicted.heading));
    // The nominal mounting is a centimetre and 2 degrees off.
    EXPECT_NEAR(motion.X_RS.heading, RadiansFromDegrees(90.0), 1e-12);
  }
  // Mean magnitude of 2 mrad from the sensor and some 4 mrad from the wheels;
  // a wrong sign would give 0.1 rad.
  EXPECT_LT(sum / 100.0, 0.01);
}

}  // namespace
}  // namespace waymark
