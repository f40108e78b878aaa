#include "estimation/filter/odometry_filter.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "tests/support/odometry_scene.h"

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

constexpr WheelParameters kParameters{1.05e-4, 0.95e-4, 0.27};

OdometryFilterOptions Options() {
  OdometryFilterOptions options;
  options.parameters = kParameters;
  options.parameter_sigma = {0.01, 0.01, 0.02};
  return options;
}

OdometrySceneOptions SceneOptions(std::uint64_t seed, double duration_s) {
  OdometrySceneOptions options;
  options.drive.parameters = kParameters;
  options.drive.rate_hz = 20;
  options.drive.duration_s = duration_s;
  options.drive.seed = seed;
  return options;
}

InitialPose StartOf(const OdometryScene& scene) {
  InitialPose start;
  start.time = scene.readings.front().time;
  start.source = "test";
  start.X_WR = scene.truth.front();
  start.covariance = 1e-4 * Eigen::Matrix3d::Identity();
  return start;
}

double Nees(const PoseEstimate& estimate, const Pose2& truth) {
  Eigen::Vector3d e = estimate.X_WR.vector() - truth.vector();
  e(2) = WrapAngle(e(2));
  return e.dot(estimate.covariance.ldlt().solve(e));
}

double Distance(const PoseEstimate& estimate, const Pose2& truth) {
  return (estimate.X_WR.position() - truth.position()).norm();
}

// Feeds everything in order of time; `each` sees the filter after a reading.
void Drive(const OdometryScene& scene,
           OdometryFilter* filter,
           const std::function<void(std::size_t)>& each = {}) {
  std::size_t fix = 0;
  for (std::size_t i = 0; i < scene.readings.size(); ++i) {
    while (fix < scene.fixes.size() &&
           scene.fixes[fix].time <= scene.readings[i].time) {
      filter->Add(scene.fixes[fix].time, scene.fixes[fix]);
      ++fix;
    }
    filter->AddReading(scene.readings[i], 0);
    if (each) each(i);
  }
}

TEST(OdometryFilter, SaysWhyThereIsNoPose) {
  OdometryFilter none{OdometryFilterOptions{}};
  EXPECT_THAT(none.estimate().reason, HasSubstr("no encoder readings"));
  none.AddReading({TimeFromMicroseconds(1), 0, 0, 0}, 0);
  EXPECT_FALSE(none.estimate().is_known);
  EXPECT_THAT(none.estimate().reason, HasSubstr("no wheel parameters"));
  EXPECT_THAT(none.odometry().reason, HasSubstr("no wheel parameters"));
  EXPECT_FALSE(none.parameters().is_known);

  OdometryFilter no_start(Options());
  no_start.AddReading({TimeFromMicroseconds(1), 0, 0, 0}, 0);
  EXPECT_THAT(no_start.estimate().reason, HasSubstr("no first pose"));
  EXPECT_TRUE(no_start.odometry().is_known);
}

TEST(OdometryFilter, FollowsFromAKnownStart) {
  const OdometryScene scene = MakeOdometryScene(SceneOptions(1, 60));
  OdometryFilter filter(Options());
  filter.Add(scene.readings.front().time, StartOf(scene));
  Drive(scene, &filter, [&](std::size_t i) {
    const PoseEstimate estimate = filter.estimate();
    ASSERT_TRUE(estimate.is_known) << estimate.reason;
    // chi-square of three degrees exceeds 30 in one of 10^6 draws.
    ASSERT_LT(Nees(estimate, scene.truth[i]), 30) << i;
  });
  EXPECT_GT(filter.counts().num_accepted, 110);
  EXPECT_EQ(filter.counts().num_rejected, 0);
  EXPECT_NEAR(filter.estimate().forward_speed, 0.4, 0.02);
  EXPECT_GT(filter.parameters().observability.minCoeff(), 0.3);
}

TEST(OdometryFilter, ParametersAndStartFromMessages) {
  const OdometryScene scene = MakeOdometryScene(SceneOptions(1, 10));
  OdometryFilterOptions options = Options();
  options.parameters.reset();
  OdometryFilter filter(options);
  OdometryParameters nominal;
  nominal.source = "nominal";
  nominal.parameters = kParameters;
  // The start is known first, but means nothing without wheels.
  filter.Add(scene.readings[0].time, StartOf(scene));
  filter.AddReading(scene.readings[0], 0);
  EXPECT_FALSE(filter.estimate().is_known);
  filter.Add(scene.readings[0].time, nominal);
  filter.AddReading(scene.readings[1], 0);
  // The wheels moved between the start and the parameters' arrival only after
  // both were in force.
  EXPECT_TRUE(filter.estimate().is_known) << filter.estimate().reason;
  EXPECT_LT(Distance(filter.estimate(), scene.truth[1]), 0.03);
}

TEST(OdometryFilter, StartIsForgottenWhereWheelsOfUnknownSizeTurned) {
  const OdometryScene scene = MakeOdometryScene(SceneOptions(1, 10));
  OdometryFilterOptions options = Options();
  options.parameters.reset();
  OdometryFilter filter(options);
  filter.Add(scene.readings[0].time, StartOf(scene));
  for (int i = 0; i < 40; ++i) {
    filter.AddReading(scene.readings[static_cast<std::size_t>(i)], 0);
  }
  OdometryParameters nominal;
  nominal.source = "nominal";
  nominal.parameters = kParameters;
  filter.Add(scene.readings[40].time, nominal);
  filter.AddReading(scene.readings[40], 0);
  filter.AddReading(scene.readings[41], 0);
  EXPECT_FALSE(filter.estimate().is_known);
}

// Unknown start, positions only: the heading shows over the first metres,
// whatever it is, and the estimate is consistent from its first moment on.
TEST(OdometryFilter, PositionsAloneFindTheStartFromAnyHeading) {
  constexpr int kHeadings = 24;
  double sum_first = 0;
  double sum_last = 0;
  double worst_wait = 0;
  for (int k = 0; k < kHeadings; ++k) {
    OdometrySceneOptions options =
        SceneOptions(100 + static_cast<std::uint64_t>(k), 15);
    options.has_heading = false;
    options.drive.start = {3, -8, WrapAngle(2 * kPi * k / kHeadings + 0.01)};
    const OdometryScene scene = MakeOdometryScene(options);
    OdometryFilter filter(Options());
    bool known = false;
    Drive(scene, &filter, [&](std::size_t i) {
      const PoseEstimate estimate = filter.estimate();
      if (known || !estimate.is_known) return;
      known = true;
      worst_wait = std::max(
          worst_wait, Seconds(scene.readings[i].time - scene.readings[0].time));
      const double nees = Nees(estimate, scene.truth[i]);
      sum_first += nees;
      EXPECT_LT(nees, 30) << "heading " << k;
    });
    ASSERT_TRUE(known) << "heading " << k << ": " << filter.estimate().reason;
    sum_last += Nees(filter.estimate(), scene.truth.back());
    EXPECT_EQ(filter.counts().num_relocalisations, 0);
  }
  // 0.4 m/s, a fix each half second with 3 cm: 0.1 rad after about a metre.
  EXPECT_LT(worst_wait, 6);
  // Mean of 24 chi-squares of three degrees: 3 +- 4 * sqrt(6 / 24).
  EXPECT_NEAR(sum_first / kHeadings, 3, 2);
  EXPECT_NEAR(sum_last / kHeadings, 3, 2);
}

TEST(OdometryFilter, WrongWheelsDoNotHideTheStart) {
  // Right and left 10 % apart from the truth, base 18 % short.
  for (int k = 0; k < 4; ++k) {
    OdometrySceneOptions options =
        SceneOptions(500 + static_cast<std::uint64_t>(k), 40);
    options.has_heading = false;
    options.drive.start = {1, 2, WrapAngle(1.6 * k)};
    const OdometryScene scene = MakeOdometryScene(options);
    OdometryFilterOptions filter_options = Options();
    filter_options.parameters = WheelParameters{1.1e-4, 0.9e-4, 0.22};
    filter_options.parameter_sigma = {0.05, 0.05, 0.2};
    OdometryFilter filter(filter_options);
    Drive(scene, &filter, [&](std::size_t i) {
      const PoseEstimate estimate = filter.estimate();
      if (estimate.is_known) {
        EXPECT_LT(Nees(estimate, scene.truth[i]), 35) << k << " " << i;
      }
    });
    ASSERT_TRUE(filter.estimate().is_known) << filter.estimate().reason;
    EXPECT_LT(Distance(filter.estimate(), scene.truth.back()), 0.15);
    EXPECT_NEAR(filter.parameters().parameters.wheel_base, 0.27, 0.01);
  }
}

// With every fifth position faulty it may take longer, but is never wrong.
TEST(OdometryFilter, FaultyPositionsDelayTheStartButNeverMisplaceIt) {
  for (int k = 0; k < 4; ++k) {
    OdometrySceneOptions options =
        SceneOptions(900 + static_cast<std::uint64_t>(k), 60);
    options.has_heading = false;
    options.drive.start = {1, 2, WrapAngle(1.7 * k)};
    OdometryScene scene = MakeOdometryScene(options);
    Random random(static_cast<std::uint64_t>(k));
    for (AbsoluteFix& fix : scene.fixes) {
      if (random.Uniform() > 0.2) continue;
      const double direction = random.Uniform(-kPi, kPi);
      const double size = random.Uniform(0.5, 3);
      fix.value.x() += size * std::cos(direction);
      fix.value.y() += size * std::sin(direction);
    }
    OdometryFilter filter(Options());
    Drive(scene, &filter, [&](std::size_t i) {
      const PoseEstimate estimate = filter.estimate();
      if (estimate.is_known) {
        ASSERT_LT(Distance(estimate, scene.truth[i]), 0.3) << k << " " << i;
      }
    });
    EXPECT_TRUE(filter.estimate().is_known) << filter.estimate().reason;
  }
}

TEST(OdometryFilter, FullPosesFindTheStartAtOnce) {
  const OdometryScene scene = MakeOdometryScene(SceneOptions(9, 5));
  OdometryFilter filter(Options());
  Drive(scene, &filter);
  EXPECT_TRUE(filter.estimate().is_known) << filter.estimate().reason;
  EXPECT_LT(Nees(filter.estimate(), scene.truth.back()), 30);
}

// Lateral offset and heading never show where along the corridor.
TEST(OdometryFilter, LateralMeasurementsAloneLeaveThePoseUnknown) {
  OdometryScene scene = MakeOdometryScene(SceneOptions(9, 30));
  for (AbsoluteFix& fix : scene.fixes) fix.has = {false, true, true};
  OdometryFilter filter(Options());
  Drive(scene, &filter);
  EXPECT_FALSE(filter.estimate().is_known);
  EXPECT_THAT(filter.estimate().reason, HasSubstr("sigma"));
}

TEST(OdometryFilter, StandingStillLeavesTheHeadingUnknown) {
  OdometrySceneOptions options = SceneOptions(4, 20);
  options.has_heading = false;
  options.driver = [](double, const Pose2&) { return DriveCommand{}; };
  const OdometryScene scene = MakeOdometryScene(options);
  OdometryFilter filter(Options());
  Drive(scene, &filter);
  EXPECT_FALSE(filter.estimate().is_known);
}

// One way: isolated faulty fixes never enter, at the start nor later.
TEST(OdometryFilter, IsolatedFaultyFixesAreNeverFused) {
  for (int seed = 0; seed < 10; ++seed) {
    OdometryScene scene = MakeOdometryScene(
        SceneOptions(40 + static_cast<std::uint64_t>(seed), 120));
    Random random(static_cast<std::uint64_t>(seed));
    int num_faulty = 0;
    for (std::size_t i = 0; i < scene.fixes.size(); ++i) {
      if (i % 5 != 3) continue;
      // Half a metre to three, any direction.
      const double direction = random.Uniform(-kPi, kPi);
      const double size = random.Uniform(0.5, 3);
      scene.fixes[i].value.x() += size * std::cos(direction);
      scene.fixes[i].value.y() += size * std::sin(direction);
      ++num_faulty;
    }
    OdometryFilter filter(Options());
    Drive(scene, &filter, [&](std::size_t i) {
      const PoseEstimate estimate = filter.estimate();
      if (estimate.is_known) {
        ASSERT_LT(Distance(estimate, scene.truth[i]), 0.2) << i;
      }
    });
    EXPECT_EQ(filter.counts().num_relocalisations, 0);
    EXPECT_EQ(filter.counts().num_rejected, num_faulty);
  }
}

// The other way: carried off, the filter finds itself again.
TEST(OdometryFilter, CarriedOffWithPosesRecoversWithinFiveFixes) {
  for (const Pose2& carried : {Pose2{4, 3, 0},
                               Pose2{0, 0, kPi},
                               Pose2{-2, 1, 1.5},
                               Pose2{0.6, 0, 0}}) {
    OdometryScene scene = MakeOdometryScene(SceneOptions(21, 60));
    const std::size_t half = scene.readings.size() / 2;
    const Time from = scene.readings[half].time;
    for (std::size_t i = half; i < scene.truth.size(); ++i) {
      scene.truth[i] = carried * scene.truth[i];
    }
    std::int64_t num_after = 0;
    for (AbsoluteFix& fix : scene.fixes) {
      if (fix.time < from) continue;
      fix.value = (carried * Pose2::FromVector(fix.value)).vector();
    }
    OdometryFilter filter(Options());
    filter.Add(scene.readings.front().time, StartOf(scene));
    std::int64_t fixes_needed = -1;
    Drive(scene, &filter, [&](std::size_t i) {
      if (i < half) return;
      num_after = 0;
      for (const AbsoluteFix& fix : scene.fixes) {
        num_after += fix.time >= from && fix.time <= scene.readings[i].time;
      }
      if (fixes_needed < 0 && filter.counts().num_relocalisations > 0) {
        fixes_needed = num_after;
      }
    });
    EXPECT_EQ(filter.counts().num_relocalisations, 1);
    EXPECT_GT(fixes_needed, 0);
    EXPECT_LE(fixes_needed, 5);
    EXPECT_LT(Nees(filter.estimate(), scene.truth.back()), 30);
  }
}

TEST(OdometryFilter, CarriedOffWithPositionsRecoversAfterSomeMetres) {
  OdometrySceneOptions options = SceneOptions(22, 90);
  options.has_heading = false;
  OdometryScene scene = MakeOdometryScene(options);
  const Pose2 carried{5, -2, 2.5};
  const std::size_t half = scene.readings.size() / 2;
  for (std::size_t i = half; i < scene.truth.size(); ++i) {
    scene.truth[i] = carried * scene.truth[i];
  }
  for (AbsoluteFix& fix : scene.fixes) {
    if (fix.time < scene.readings[half].time) continue;
    fix.value = (carried * Pose2::FromVector(fix.value)).vector();
  }
  OdometryFilter filter(Options());
  filter.Add(scene.readings.front().time, StartOf(scene));
  double wait = 0;
  Drive(scene, &filter, [&](std::size_t i) {
    if (i >= half && filter.counts().num_relocalisations == 0) {
      wait = Seconds(scene.readings[i].time - scene.readings[half].time);
    }
  });
  EXPECT_EQ(filter.counts().num_relocalisations, 1);
  EXPECT_LT(wait, 10);
  EXPECT_LT(Nees(filter.estimate(), scene.truth.back()), 30);
}

TEST(OdometryFilter, EncoderJumpIsRefusedAndResetIsSurvived) {
  OdometryScene scene = MakeOdometryScene(SceneOptions(31, 60));
  scene.readings[300].right += 1'000'000;
  for (std::size_t i = 600; i < scene.readings.size(); ++i) {
    scene.readings[i].right -= scene.readings[599].right + 123'456;
    scene.readings[i].left = scene.readings[i].left - 77'000'000;
  }
  OdometryFilterOptions options = Options();
  options.max_wheel_speed = 2;
  OdometryFilter filter(options);
  filter.Add(scene.readings.front().time, StartOf(scene));
  Drive(scene, &filter, [&](std::size_t i) {
    const PoseEstimate estimate = filter.estimate();
    if (i == 300) {
      EXPECT_FALSE(estimate.is_known);
      EXPECT_THAT(estimate.reason, HasSubstr("encoder jump: right wheel"));
      EXPECT_EQ(filter.fault(), estimate.reason);
    }
    if (i == 301 || i == 610) {
      EXPECT_EQ(filter.fault(), "") << i;
    }
    if (estimate.is_known) {
      ASSERT_LT(Nees(estimate, scene.truth[i]), 30) << i;
    }
  });
  EXPECT_EQ(filter.counts().num_refused_readings, 1 + 4);
  EXPECT_EQ(filter.counts().num_lost_counts, 1);
  EXPECT_TRUE(filter.estimate().is_known) << filter.estimate().reason;
}

TEST(OdometryFilter, FaultStopsUntilAStartIsStated) {
  const OdometryScene scene = MakeOdometryScene(SceneOptions(33, 20));
  OdometryFilter filter(Options());
  filter.Add(scene.readings[0].time, StartOf(scene));
  filter.AddReading(scene.readings[0], 0);
  AbsoluteFix breaking = scene.fixes[0];
  breaking.time = scene.readings[1].time;
  // Passes the gate (the innovation fits), then breaks the update.
  breaking.value = scene.truth[1].vector();
  breaking.covariance = -1e-5 * Eigen::Matrix3d::Identity();
  filter.Add(breaking.time, breaking);
  filter.AddReading(scene.readings[1], 0);
  filter.AddReading(scene.readings[2], 0);
  const PoseEstimate stopped = filter.estimate();
  EXPECT_FALSE(stopped.is_known);
  EXPECT_THAT(stopped.reason, HasSubstr("filter stopped: update"));
  EXPECT_EQ(filter.fault(), stopped.reason);
  InitialPose again = StartOf(scene);
  again.X_WR = scene.truth[3];
  filter.Add(scene.readings[3].time, again);
  filter.AddReading(scene.readings[3], 0);
  EXPECT_TRUE(filter.estimate().is_known);
  EXPECT_LT(Distance(filter.estimate(), scene.truth[3]), 0.01);
}

TEST(OdometryFilter, BatchParametersAreAdoptedOnlyWhereAsked) {
  const OdometryScene scene = MakeOdometryScene(SceneOptions(35, 20));
  OdometryParameters batch;
  batch.source = "batch";
  batch.parameters = {1.2e-4, 1.1e-4, 0.3};
  batch.covariance = Eigen::Vector3d(1e-14, 1e-14, 1e-8).asDiagonal();
  for (const bool adopt : {false, true}) {
    OdometryFilterOptions options = Options();
    options.adopt_batch = adopt;
    OdometryFilter filter(options);
    filter.Add(scene.readings[0].time, StartOf(scene));
    filter.AddReading(scene.readings[0], 0);
    filter.Add(scene.readings[1].time, batch);
    filter.AddReading(scene.readings[1], 0);
    EXPECT_EQ(filter.parameters().parameters.wheel_base > 0.29, adopt);
    // Dead reckoning stays nominal.
    filter.AddReading(scene.readings[2], 0);
    EXPECT_LT((filter.odometry().X_WR.position() -
               (Inverse(scene.truth[0]) * scene.truth[2]).position())
                  .norm(),
              0.01);
  }
}

}  // namespace
}  // namespace waymark
