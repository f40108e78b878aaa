#include "tests/bench/fusion_benches.h"

#include "estimation/base/random.h"
#include "estimation/filter/delayed_fusion.h"
#include "estimation/filter/odometry_ekf.h"
#include "estimation/filter/two_hypothesis_gate.h"
#include "estimation/geometry/angle.h"
#include "tests/support/odometry_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace waymark {
namespace {

// Vision's error model of row Y12.
constexpr double kLateralSigma = 0.03;
constexpr double kHeadingSigma = 0.01;

DelayedFusionOptions FusionOptions(const OdometryScene& scene) {
  DelayedFusionOptions options;
  options.filter.parameters = DriveSimulationOptions{}.parameters;
  options.filter.parameter_sigma = {0.01, 0.01, 0.02};
  InitialPose start;
  start.X_WR = scene.truth.front();
  start.covariance = 1e-4 * Eigen::Matrix3d::Identity();
  options.filter.start = start;
  return options;
}

struct LatencyResult {
  double squared = 0.0;  // Sum of squared position errors of the newest pose.
  std::int64_t count = 0;
  std::vector<Settled> settled;
};

// Fixes arrive `latency_s` after their time; with `restamp` they claim to be
// of their arrival.
LatencyResult Drive(const OdometryScene& scene,
                    double latency_s,
                    bool restamp) {
  DelayedFusion fusion(FusionOptions(scene));
  LatencyResult result;
  std::size_t next = 0;
  for (std::size_t i = 0; i < scene.readings.size(); ++i) {
    for (; next < scene.fixes.size(); ++next) {
      AbsoluteFix fix = scene.fixes[next];
      const Time arrival = fix.time + DurationFromSeconds(latency_s);
      if (arrival > scene.readings[i].time) break;
      if (restamp) fix.time = arrival;
      (void)fusion.AddFix(fix);
    }
    (void)fusion.AddReading(scene.readings[i], 0);
    const PoseEstimate pose = fusion.newest().estimate();
    if (!pose.is_known) continue;
    result.squared +=
        (pose.X_WR.position() - scene.truth[i].position()).squaredNorm();
    ++result.count;
  }
  fusion.Finish();
  result.settled = fusion.TakeSettled();
  return result;
}

// Settled poses that differ in any bit. Fixes that had not arrived when the
// drive ended are missing from the last ones, which are left out.
std::int64_t NumDifferent(const LatencyResult& a,
                          const LatencyResult& b,
                          std::size_t last_left_out) {
  std::int64_t different = 0;
  for (std::size_t i = 0; i + last_left_out < a.settled.size(); ++i) {
    const PoseEstimate& p = a.settled[i].pose;
    const PoseEstimate& q = b.settled[i].pose;
    if (!(p.X_WR == q.X_WR) || p.covariance != q.covariance) ++different;
  }
  return different;
}

}  // namespace

std::vector<BenchRow> BenchGate(bool full) {
  const int draws = full ? 1'000'000 : 100'000;
  Random random(11);
  AbsoluteFix fix;
  fix.has = {false, true, true};
  Innovation v;
  v.residual.resize(2);
  v.H.setZero(2, 6);
  v.R.setZero(2, 2);
  v.R.diagonal() << kLateralSigma * kLateralSigma,
      kHeadingSigma * kHeadingSigma;
  v.HPH = v.R;
  const GateOptions options;
  int regular = 0;
  int faulty = 0;
  const auto accepted = [&] {
    return RegularProbability(fix.has, v, options) > options.min_regular;
  };
  for (int i = 0; i < draws; ++i) {
    // Half of the innovation's variance is the filter's own.
    v.residual << random.Normal(kLateralSigma * std::sqrt(2.0)),
        random.Normal(kHeadingSigma * std::sqrt(2.0));
    if (accepted()) ++regular;
    v.residual(0) += random.Normal(options.faulty_position_sigma);
    v.residual(1) += random.Normal(options.faulty_heading_sigma);
    if (accepted()) ++faulty;
  }
  BenchRow row;
  row.id = "Y11";
  row.unit = "share";
  row.runs = draws;
  row.name = "regular measurements accepted at P > 95 %";
  row.value = static_cast<double>(regular) / draws;
  BenchRow other = row;
  other.name = "faulty measurements (1 m, 0.5 rad) accepted at P > 95 %";
  other.value = static_cast<double>(faulty) / draws;
  return {row, other};
}

std::vector<BenchRow> BenchReadingRate(bool /*full*/) {
  // 30 m of turns; the same ticks in 500 or in 10 readings a second.
  const auto covariance = [](int readings_per_s) {
    const WheelParameters p = DriveSimulationOptions{}.parameters;
    OdometryEkfOptions options;
    OdometryEkf ekf(options,
                    {},
                    Eigen::Matrix3d::Zero(),
                    p,
                    Eigen::Vector3d(1e-12, 1e-12, 1e-6).asDiagonal());
    for (int s = 0; s < 75; ++s) {
      const double turn = 0.3 * std::sin(0.7 * s);
      const WheelTicks ticks{(0.4 + turn * p.wheel_base) / p.k_right,
                             (0.4 - turn * p.wheel_base) / p.k_left};
      for (int i = 0; i < readings_per_s; ++i) {
        ekf.Predict({ticks.right / readings_per_s, ticks.left / readings_per_s},
                    1.0 / readings_per_s);
      }
    }
    return ekf.pose_covariance();
  };
  const Eigen::Matrix3d fine = covariance(500);
  std::vector<BenchRow> rows;
  for (const int rate : {10, 50}) {
    const Eigen::Vector3d ratio =
        covariance(rate).diagonal().cwiseQuotient(fine.diagonal());
    BenchRow row;
    row.id = "Y13";
    row.name = "variance after 30 m, read at " + std::to_string(rate) +
               " Hz instead of 500 Hz: largest change";
    row.value = 100.0 * (ratio.array() - 1.0).abs().maxCoeff();
    row.unit = "%";
    row.goal = "<= 1";
    row.holds = row.value <= 1.0;
    row.runs = 1;
    rows.push_back(row);
  }
  return rows;
}

std::vector<BenchRow> BenchLatency(bool full) {
  const int seeds = full ? 100 : 20;
  std::vector<BenchRow> rows;
  for (const int latency_ms : {50, 100, 200, 500}) {
    LatencyResult ours;
    LatencyResult naive;
    std::int64_t num_different = 0;
    for (int seed = 0; seed < seeds; ++seed) {
      OdometrySceneOptions options;
      options.drive.rate_hz = 50;
      options.drive.duration_s = 60;
      options.drive.seed = 7000 + static_cast<std::uint64_t>(seed);
      const OdometryScene scene = MakeOdometryScene(options);
      const double latency_s = 1e-3 * latency_ms;
      const LatencyResult in_order = Drive(scene, 0.0, false);
      const LatencyResult late = Drive(scene, latency_s, false);
      const LatencyResult restamped = Drive(scene, latency_s, true);
      num_different += NumDifferent(in_order, late, 50);
      for (const auto& [sum, one] :
           {std::pair{&ours, &late}, std::pair{&naive, &restamped}}) {
        sum->squared += one->squared;
        sum->count += one->count;
      }
    }
    const auto rms = [](const LatencyResult& r) {
      return std::sqrt(r.squared /
                       static_cast<double>(std::max<std::int64_t>(r.count, 1)));
    };
    const std::string what = std::to_string(latency_ms) + " ms late";
    BenchRow row;
    row.id = "Y16";
    row.name = what + ": position RMS of POSE";
    row.value = rms(ours);
    row.unit = "m";
    row.peer = "fused on arrival";
    row.peer_value = rms(naive);
    row.ratio = rms(naive) / rms(ours);
    row.runs = seeds;
    rows.push_back(row);
    row = BenchRow{};
    row.id = "Y16";
    row.name = what + ": settled poses that differ from in order";
    row.value = static_cast<double>(num_different);
    row.unit = "poses";
    row.goal = "0";
    row.holds = num_different == 0;
    row.runs = seeds;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace waymark
