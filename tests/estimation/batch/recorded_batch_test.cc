// The batch refiner on recordings by others. Bounds are those that must hold;
// bench batch-* prints the figures.
#include "tests/support/real_data.h"
#include "tests/support/recorded_problems.h"

#include <gtest/gtest.h>

#include <string>

namespace waymark {
namespace {

TEST(RecordedBatch, MotionCaptureRunsFitTheHeldOutHalf) {
  const std::string folder = RealDataFolder("optiodom_diffdrive");
  if (folder.empty()) GTEST_SKIP() << "no real recordings";
  const MocapReport report = CrossValidateMocap(folder);
  for (const BatchResult& half : report.halves) {
    EXPECT_EQ(half.status, BatchStatus::kSolved) << half.reason;
  }
  for (const MocapTypeReport& type : report.types) {
    if (type.name == "circular") {
      EXPECT_LT(type.fitted_m, 0.5 * type.nominal_m);
    }
    if (type.name == "square") {
      EXPECT_LT(type.fitted_m, 1.05 * type.nominal_m);
    }
  }
  EXPECT_NEAR(report.base_gap, 0.0, 0.005);
}

TEST(RecordedBatch, CensiMountingsPredictHeldOutMotion) {
  const std::string folder = RealDataFolder("censi_joint_calibration");
  if (folder.empty()) GTEST_SKIP() << "no real recordings";
  const CensiReport report = CrossValidateCensi(folder);
  ASSERT_EQ(report.mountings.size(), 2u);
  for (const CensiMountingReport& mounting : report.mountings) {
    // No worse than the authors', but for what resampling cannot tell: the
    // medians themselves are known to 1 %, the two fits differ by less.
    EXPECT_LT(mounting.position_gap.low, 0.0);
    EXPECT_LT(mounting.yaw_gap.low, 0.0);
    EXPECT_LT(mounting.position_gap.share, 0.005);
    EXPECT_LT(mounting.yaw_gap.share, 0.005);
  }
  EXPECT_NEAR(report.joint.parameters.wheel_base, 0.0885, 0.001);
  EXPECT_LT(report.axle_spread, 0.02);
  ASSERT_EQ(report.joint.sensors.size(), 2u);
  EXPECT_NEAR(report.joint.sensors[1].X_RS.heading, -1.56, 0.03);
}

TEST(RecordedBatch, LegoRobotIsOffByCentimetresAfterTheFit) {
  const std::string folder = RealDataFolder("brenner_lego_robot4");
  if (folder.empty()) GTEST_SKIP() << "no real recordings";
  const LegoReport report = FitLego(folder);
  EXPECT_EQ(report.result.status, BatchStatus::kSolved);
  EXPECT_GT(report.nominal_m, 0.7);
  EXPECT_LT(report.fitted_m, 0.04);
  // The base that an independent fit finds is 180.5 mm.
  EXPECT_NEAR(report.result.parameters.wheel_base, 0.1805, 0.006);
}

}  // namespace
}  // namespace waymark
