#include "estimation/filter/pose_aligner.h"

#include "estimation/geometry/angle.h"
#include "tests/support/drive_simulation.h"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

// Wheels of unequal size, so that a swap shows.
constexpr WheelParameters kWheels{1.02e-4, 0.99e-4, 0.27};
const Pose2 kMounting{0.3, -0.1, 1.6};  // X_RS.
const Pose2 kFrame{4.0, -7.0, 2.1};     // X_WF.
// Arcs between fixes merge without loss, so rounding is what is left.
constexpr double kExact = 1e-9;

using Components = std::array<bool, 3>;
constexpr Components kPosition = {true, true, false};
constexpr Components kLateral = {false, true, false};
constexpr Components kLateralHeading = {false, true, true};
constexpr Components kPose = {true, true, true};

using Drive = std::vector<SimulatedReading>;

// Left and right bends, without any noise.
Drive ExactDrive(const Pose2& start) {
  DriveSimulationOptions options;
  options.parameters = kWheels;
  options.noise = {0.0, 0.0};
  options.whole_ticks = false;
  options.start = start;
  options.rate_hz = 20.0;
  options.duration_s = 15.0;
  return SimulateDrive(options, [](double t, const Pose2&) {
    return DriveCommand{0.4, t < 5.0 ? 0.5 : -0.3};
  });
}

Drive StraightDrive(const Pose2& start) {
  DriveSimulationOptions options;
  options.parameters = kWheels;
  options.noise = {0.0, 0.0};
  options.whole_ticks = false;
  options.start = start;
  options.duration_s = 10.0;
  return SimulateDrive(options, [](double, const Pose2&) {
    return DriveCommand{0.4, 0.0};
  });
}

AbsoluteFix ExactFix(const Pose2& X_WR, const Components& has) {
  AbsoluteFix fix;
  fix.has = has;
  fix.X_WF = kFrame;
  fix.X_RS = kMounting;
  fix.value = Between(kFrame, X_WR * kMounting).vector();
  fix.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();
  return fix;
}

PoseAligner Aligner(const PoseAlignerOptions& options = {},
                    const WheelParameters& wheels = kWheels) {
  const Eigen::Vector3d sigma = 0.05 * wheels.vector();
  return {
      options, {}, wheels, sigma.cwiseAbs2().asDiagonal(), Pose2{1, 1, 0.5}};
}

// A fix every `every` readings; `spoil` may change the one with that number,
// or the ticks. The last motion ends where the drive does.
struct Feeding {
  Components has = kPosition;
  std::size_t every = 20;
  std::function<void(int, AbsoluteFix*)> spoil = [](int, AbsoluteFix*) {};
  std::function<void(WheelTicks*)> miscount = [](WheelTicks*) {};
};

void Feed(const Drive& drive, const Feeding& feeding, PoseAligner* aligner) {
  int num_fixes = 0;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    if (i > 0) {
      WheelTicks ticks{drive[i].right_ticks - drive[i - 1].right_ticks,
                       drive[i].left_ticks - drive[i - 1].left_ticks};
      feeding.miscount(&ticks);
      aligner->AddMotion(ticks);
    }
    if (i % feeding.every != 0) continue;
    AbsoluteFix fix = ExactFix(drive[i].X_WR, feeding.has);
    feeding.spoil(num_fixes++, &fix);
    EXPECT_TRUE(aligner->AddFix(fix)) << i;
  }
}

double Gap(const Pose2& a, const Pose2& b) {
  return Between(a, b).vector().cwiseAbs().maxCoeff();
}

TEST(PoseAligner, ExactPositionsGiveThePoseFromAnyHeading) {
  for (int k = 0; k < 6; ++k) {
    const Pose2 start{-3.0, 8.0, WrapAngle(2 * kPi * k / 6 + 0.1)};
    const Drive drive = ExactDrive(start);
    PoseAligner aligner = Aligner();
    Feed(drive, {}, &aligner);
    const Alignment found = aligner.Solve();
    ASSERT_TRUE(found.is_known) << k << ": " << found.reason;
    EXPECT_EQ(found.reason, "");
    EXPECT_FALSE(found.disagrees);
    EXPECT_LT(Gap(found.X_WR, drive.back().X_WR), kExact) << k;
    EXPECT_EQ(found.num_fixes, 16);
  }
}

// With a heading at the first fix there is but one start to try: it must be
// the robot's, not the sensor's, and in the world, not in F. So must the prior
// of the position, here as tight as a fix.
TEST(PoseAligner, ThreeExactPosesAreEnough) {
  const Drive drive = ExactDrive({-3.0, 8.0, 2.9});
  const Drive begin(drive.begin(), drive.begin() + 21);
  Feeding feeding;
  feeding.has = kPose;
  feeding.every = 10;
  PoseAlignerOptions options;
  options.position_sigma = 0.01;
  PoseAligner aligner = Aligner(options);
  Feed(begin, feeding, &aligner);
  const Alignment found = aligner.Solve();
  ASSERT_TRUE(found.is_known) << found.reason;
  EXPECT_LT(Gap(found.X_WR, begin.back().X_WR), kExact);
}

TEST(PoseAligner, WheelsThatAreOffAreFoundWithThePose) {
  const Drive drive = ExactDrive({-3.0, 8.0, -1.0});
  Feeding feeding;
  feeding.every = 10;
  feeding.spoil = [](int, AbsoluteFix* fix) { fix->covariance *= 1e-4; };
  const WheelParameters off{
      1.04 * kWheels.k_right, 0.97 * kWheels.k_left, 0.94 * kWheels.wheel_base};
  OdometryEkfOptions model;
  model.noise = {1e-9, 1e-11};  // The wheels are exact, but for their sizes.
  const Eigen::Vector3d sigma = 0.05 * off.vector();
  PoseAligner aligner({}, model, off, sigma.cwiseAbs2().asDiagonal(), Pose2{});
  Feed(drive, feeding, &aligner);
  const Alignment found = aligner.Solve();
  ASSERT_TRUE(found.is_known) << found.reason;
  EXPECT_LT(Gap(found.X_WR, drive.back().X_WR), 1e-3);
  const Eigen::Vector3d error =
      found.parameters.vector().cwiseQuotient(kWheels.vector()) -
      Eigen::Vector3d::Ones();
  // What fixes of 0.1 mm leave to a prior of 5 %.
  EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-3) << error.transpose();
  // And it says how well it knows them.
  EXPECT_LT(found.covariance(5, 5), 1e-4 * sigma(2) * sigma(2));
}

// Another world frame: the same answer in it, and as sure.
TEST(PoseAligner, TurnsWithTheWorld) {
  const Drive drive = ExactDrive({-3.0, 8.0, 0.7});
  const Pose2 X_VW{20.0, -5.0, 2.0};
  PoseAligner here = Aligner();
  PoseAligner there = Aligner();
  Feeding feeding;
  Feed(drive, feeding, &here);
  feeding.spoil = [&](int, AbsoluteFix* fix) { fix->X_WF = X_VW * fix->X_WF; };
  Feed(drive, feeding, &there);
  const Alignment a = here.Solve();
  const Alignment b = there.Solve();
  ASSERT_TRUE(a.is_known && b.is_known) << a.reason << b.reason;
  // Both stop where a step is below 1e-5.
  EXPECT_LT(Gap(X_VW * a.X_WR, b.X_WR), 1e-5);
  const Eigen::Matrix2d R_VW =
      Eigen::Rotation2Dd(X_VW.heading).toRotationMatrix();
  const Eigen::Matrix2d P_V =
      R_VW * a.covariance.topLeftCorner<2, 2>() * R_VW.transpose();
  EXPECT_LT((P_V - b.covariance.topLeftCorner<2, 2>()).norm(),
            1e-4 * P_V.norm());
}

// Every fifth fix off by `size`, to either side, the first `count` of them.
Feeding Faulty(const Components& has, double size, int count) {
  Feeding feeding;
  feeding.has = has;
  feeding.spoil = [=](int i, AbsoluteFix* fix) {
    if (i % 5 != 2 || i / 5 >= count) return;
    fix->value.x() += i % 2 == 0 ? size : -size;
  };
  return feeding;
}

TEST(PoseAligner, FaultyFixesAreLeftOut) {
  const Drive drive = ExactDrive({-3.0, 8.0, 0.7});
  for (const Components& has : {kPosition, kPose}) {
    PoseAligner aligner = Aligner();
    Feed(drive, Faulty(has, 0.1, 2), &aligner);  // Ten sigma.
    const Alignment found = aligner.Solve();
    ASSERT_TRUE(found.is_known) << found.reason;
    EXPECT_EQ(found.num_fixes, 14);
    EXPECT_LT(Gap(found.X_WR, drive.back().X_WR), kExact);
  }
}

// However many and gross: no answer rather than a wrong one.
TEST(PoseAligner, FaultyFixesNeverMisplace) {
  const Drive drive = ExactDrive({-3.0, 8.0, 0.7});
  for (const Components& has : {kPosition, kPose}) {
    for (const double size : {0.04, 0.4}) {
      for (const int count : {1, 3}) {
        PoseAligner aligner = Aligner();
        Feed(drive, Faulty(has, size, count), &aligner);
        const Alignment found = aligner.Solve();
        if (found.is_known) {
          // One sigma of a fix: what a fault too small to tell may pull.
          EXPECT_LT(Gap(found.X_WR, drive.back().X_WR), 0.01)
              << size << " " << count;
        } else {
          EXPECT_TRUE(found.disagrees) << size << " " << count;
          EXPECT_THAT(found.reason, HasSubstr("do not agree with the wheels"));
        }
      }
    }
  }
}

TEST(PoseAligner, SwappedWheelsAndAMirroredMountingDisagree) {
  const Drive drive = ExactDrive({-3.0, 8.0, 0.7});
  Feeding feeding;
  feeding.miscount = [](WheelTicks* ticks) {
    std::swap(ticks->right, ticks->left);
  };
  PoseAligner swapped = Aligner();
  Feed(drive, feeding, &swapped);
  EXPECT_TRUE(swapped.Solve().disagrees);

  feeding = {};
  feeding.has = kPose;
  feeding.spoil = [](int, AbsoluteFix* fix) { fix->X_RS.heading *= -1; };
  PoseAligner mirrored = Aligner();
  Feed(drive, feeding, &mirrored);
  EXPECT_TRUE(mirrored.Solve().disagrees);
}

// Straight on, measured from the side only: ahead to the left looks as back to
// the left does.
TEST(PoseAligner, HeadingThatFitsAsWellIsNotGuessed) {
  const Drive drive = StraightDrive({0.0, 0.0, 1.0});
  Feeding feeding;
  feeding.has = kLateral;
  feeding.every = 50;
  feeding.spoil = [&, i = std::size_t{0}](int, AbsoluteFix* fix) mutable {
    fix->X_WF = fix->X_RS = {};
    fix->value = drive[50 * i++].X_WR.vector();
  };
  PoseAlignerOptions options;
  options.allow_partial = true;
  PoseAligner aligner = Aligner(options);
  Feed(drive, feeding, &aligner);
  EXPECT_EQ(aligner.Solve().reason,
            "first pose unknown: another heading fits as well");
  EXPECT_FALSE(aligner.Solve().disagrees);
}

TEST(PoseAligner, LateralFixesGiveAPartWhereThatIsAllowed) {
  const Drive drive = StraightDrive({0.0, 0.0, 0.3});
  Feeding feeding;
  feeding.has = kLateralHeading;
  feeding.every = 50;
  PoseAligner strict = Aligner();
  Feed(drive, feeding, &strict);
  EXPECT_THAT(strict.Solve().reason, HasSubstr("sigma of heading"));
  EXPECT_FALSE(strict.Solve().disagrees);

  PoseAlignerOptions options;
  options.allow_partial = true;
  PoseAligner aligner = Aligner(options);
  Feed(drive, feeding, &aligner);
  const Alignment found = aligner.Solve();
  ASSERT_TRUE(found.is_known) << found.reason;
  EXPECT_NEAR(found.X_WR.heading, 0.3, kExact);
  // Across F it is where it is; along F as unsure as the prior.
  const Pose2 truth = Between(kFrame, drive.back().X_WR);
  EXPECT_NEAR(Between(kFrame, found.X_WR).y, truth.y, kExact);
  const Eigen::Matrix2d R_FW =
      Eigen::Rotation2Dd(-kFrame.heading).toRotationMatrix();
  const Eigen::Matrix2d P_F =
      R_FW * found.covariance.topLeftCorner<2, 2>() * R_FW.transpose();
  EXPECT_LT(P_F(1, 1), 1e-2);
  EXPECT_NEAR(P_F(0, 0), options.position_sigma * options.position_sigma, 1.0);
}

TEST(PoseAligner, TooFewFixesAndStandingStillTellNothing) {
  const Pose2 X_WR{1.0, 2.0, 0.3};
  PoseAligner aligner = Aligner();
  EXPECT_FALSE(aligner.Solve().is_known);
  EXPECT_TRUE(aligner.AddFix(ExactFix(X_WR, kPosition)));
  EXPECT_FALSE(aligner.AddFix(ExactFix(X_WR, kPosition)));
  aligner.AddMotion({100, 100});  // A centimetre.
  EXPECT_FALSE(aligner.AddFix(ExactFix(X_WR, kPosition)));
  // Back and forth counts as way; a heading needs none.
  aligner.AddMotion({-110, -110});
  EXPECT_TRUE(aligner.AddFix(ExactFix(X_WR, kPosition)));
  EXPECT_EQ(aligner.num_fixes(), 2);
  EXPECT_EQ(aligner.Solve().reason,
            "first pose unknown: too few measurements yet");
  EXPECT_TRUE(aligner.AddFix(ExactFix(X_WR, kPose)));
  EXPECT_TRUE(aligner.AddFix(ExactFix(X_WR, kPose)));
  EXPECT_EQ(aligner.num_fixes(), 4);
}

// What is forgotten is a measurement, never a motion.
TEST(PoseAligner, FullItForgetsFixesAndKeepsTheWay) {
  const Drive drive = ExactDrive({-3.0, 8.0, 0.7});
  PoseAlignerOptions options;
  options.max_fixes = 10;
  PoseAligner aligner = Aligner(options);
  Feed(drive, {}, &aligner);
  // The 11th: 9 of 10 after the first, every second of them, and itself are 6;
  // the 15th makes ten, the 16th again 6.
  EXPECT_EQ(aligner.num_fixes(), 6);
  const Alignment found = aligner.Solve();
  ASSERT_TRUE(found.is_known) << found.reason;
  EXPECT_EQ(found.num_fixes, 6);
  EXPECT_LT(Gap(found.X_WR, drive.back().X_WR), kExact);
}

TEST(PoseAligner, DroppingAFaultyFirstFixLeavesTheTruth) {
  const Drive drive = ExactDrive({-3.0, 8.0, 0.7});
  Feeding feeding;
  feeding.has = kPose;
  feeding.spoil = [](int i, AbsoluteFix* fix) {
    if (i == 0) fix->value += Eigen::Vector3d(5.0, -5.0, 2.0);
  };
  PoseAligner aligner = Aligner();
  Feed(drive, feeding, &aligner);
  aligner.DropFirst();
  EXPECT_EQ(aligner.num_fixes(), 15);
  const Alignment found = aligner.Solve();
  ASSERT_TRUE(found.is_known) << found.reason;
  EXPECT_EQ(found.num_fixes, 15);
  EXPECT_LT(Gap(found.X_WR, drive.back().X_WR), kExact);
  PoseAligner empty = Aligner();
  empty.DropFirst();  // Nothing to drop is no error.
  EXPECT_EQ(empty.num_fixes(), 0);
}

}  // namespace
}  // namespace waymark
