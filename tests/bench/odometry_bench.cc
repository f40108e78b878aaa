// Row Y23: odometry that learns its wheels; and the filter's other rows.

#include "estimation/base/random.h"
#include "estimation/filter/odometry_ekf.h"
#include "estimation/filter/posterior_bound.h"
#include "estimation/geometry/angle.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/fusion_benches.h"
#include "tests/support/drive_simulation.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace waymark {
namespace {

using Matrix6 = OdometryEkf::Matrix6;

// ---- Y23: convergence of the wheel parameters ------------------------------

constexpr WheelParameters kTrue{0.99 * 2e-4 / 1.99, 2e-4 / 1.99, 0.27};
// R = k_r / k_l from 1.1, their mean as it is; B from 0.22.
constexpr WheelParameters kStart{1.1 * 2e-4 / 2.1, 2e-4 / 2.1, 0.22};
// Prior sigma: 5 % of k, 0.05 m of B: the actual start errors are 1 sigma.
constexpr double kPriorTravel = 0.05;
constexpr double kPriorBase = 0.05;
constexpr double kStartSigma = 0.01;  // m and rad.
constexpr int kReadingsPerUpdate = 5;
constexpr std::array<int, 3> kCheckpoints = {150, 500, 2500};

struct Vision {
  double heading_sigma;
  double lateral_sigma;
  const char* name;
};

Eigen::Matrix3d PriorOfParameters() {
  return Eigen::Vector3d(std::pow(kPriorTravel * kStart.k_right, 2),
                         std::pow(kPriorTravel * kStart.k_left, 2),
                         kPriorBase * kPriorBase)
      .asDiagonal();
}

AbsoluteFix CorridorFix(const Vision& vision) {
  AbsoluteFix fix;
  fix.has = {false, true, true};
  fix.covariance.diagonal() << 0.0, std::pow(vision.lateral_sigma, 2),
      std::pow(vision.heading_sigma, 2);
  return fix;
}

// Error and variance of R = k_r / k_l and of B.
struct Errors {
  std::array<double, 2> error{};
  std::array<double, 2> variance{};
};

Errors ErrorsOf(const WheelParameters& p, const Eigen::Matrix3d& P) {
  Errors e;
  e.error = {p.k_right / p.k_left - kTrue.k_right / kTrue.k_left,
             p.wheel_base - kTrue.wheel_base};
  e.variance = {RatioVariance(p, P), P(2, 2)};
  return e;
}

PosteriorBound BoundOf(const DriveSimulationOptions& drive) {
  Matrix6 prior = Matrix6::Zero();
  prior.topLeftCorner<3, 3>() =
      kStartSigma * kStartSigma * Eigen::Matrix3d::Identity();
  prior.bottomRightCorner<3, 3>() = PriorOfParameters();
  return {kTrue, drive.noise, drive.integration, prior};
}

struct Sums {
  std::array<double, 2> squared{};
  std::array<double, 2> normalised{};
  void Add(const Errors& e) {
    for (std::size_t i = 0; i < 2; ++i) {
      squared[i] += e.error[i] * e.error[i];
      normalised[i] += e.error[i] * e.error[i] / e.variance[i];
    }
  }
};

struct Convergence {
  std::array<Sums, 3> ours;
  std::array<Sums, 3> plain;
  std::array<std::array<double, 2>, 3> bound{};  // Sum of variances.
};

OdometryEkf StartFilter(ParameterForm form,
                        const DriveSimulationOptions& drive,
                        const Pose2& start) {
  OdometryEkfOptions options;
  options.noise = drive.noise;
  options.integration = drive.integration;
  options.form = form;
  return {options,
          start,
          kStartSigma * kStartSigma * Eigen::Matrix3d::Identity(),
          kStart,
          PriorOfParameters()};
}

// Drives a zig-zag of +-30 degrees by what vision measures, as a robot would.
// A driver who saw the truth would answer the wheels' noise between two
// measurements: ticks that know more than the filter is told.
class VisionDriver {
 public:
  VisionDriver(const Vision& vision, std::uint64_t seed)
      : vision_(vision), random_(seed) {}

  DriveCommand Drive(double t, const Pose2& X_WR) {
    if (num_calls_ % kReadingsPerUpdate == 0) Measure(X_WR);
    ++num_calls_;
    constexpr double kForward = 0.3;  // m/s.
    constexpr double kLeg = 2.0;      // m.
    constexpr double kGain = 2.0;     // 1/s: stable at 5 measurements/s.
    constexpr double kMaxRate = 0.6;  // rad/s.
    const auto leg = static_cast<int>(t * kForward / kLeg);
    const double target = leg % 2 == 0 ? kPi / 6 : -kPi / 6;
    const double error = WrapAngle(target - measured_.back().z());
    return {kForward, std::clamp(kGain * error, -kMaxRate, kMaxRate)};
  }
  void Measure(const Pose2& X_WR) {
    measured_.emplace_back(
        0.0,
        X_WR.y + random_.Normal(vision_.lateral_sigma),
        X_WR.heading + random_.Normal(vision_.heading_sigma));
  }
  // (absent, y, heading), one per kReadingsPerUpdate readings from the first.
  [[nodiscard]] const std::vector<Eigen::Vector3d>& measured() const {
    return measured_;
  }

 private:
  Vision vision_;
  Random random_;
  std::int64_t num_calls_ = 0;
  std::vector<Eigen::Vector3d> measured_;
};

// Seeds that have nothing in common between cases and draws.
std::uint64_t SeedOf(const Vision& vision, int run, int draw) {
  std::uint64_t seed =
      static_cast<std::uint64_t>(run) * 16 + static_cast<std::uint64_t>(draw);
  for (const char* c = vision.name; *c != 0; ++c) {
    seed = Random(seed ^ static_cast<std::uint64_t>(*c)).Bits();
  }
  return seed;
}

void RunSeed(int run, const Vision& vision, Convergence* sums) {
  DriveSimulationOptions drive;
  drive.parameters = kTrue;
  drive.rate_hz = 25.0;
  drive.duration_s = kCheckpoints.back() * kReadingsPerUpdate / drive.rate_hz;
  drive.seed = SeedOf(vision, run, 0);
  VisionDriver driver(vision, SeedOf(vision, run, 1));
  const auto readings = SimulateDrive(
      drive,
      [&driver](double t, const Pose2& X_WR) { return driver.Drive(t, X_WR); });
  driver.Measure(readings.back().X_WR);
  Random random(SeedOf(vision, run, 2));
  AbsoluteFix fix = CorridorFix(vision);
  const Pose2 start{random.Normal(kStartSigma),
                    random.Normal(kStartSigma),
                    random.Normal(kStartSigma)};
  OdometryEkf ours = StartFilter(ParameterForm::kTurn, drive, start);
  OdometryEkf plain = StartFilter(ParameterForm::kTravel, drive, start);
  PosteriorBound bound = BoundOf(drive);
  std::size_t checkpoint = 0;
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const WheelTicks ticks{
        readings[i].right_ticks - readings[i - 1].right_ticks,
        readings[i].left_ticks - readings[i - 1].left_ticks};
    const double seconds = 1.0 / drive.rate_hz;
    ours.Predict(ticks, seconds);
    plain.Predict(ticks, seconds);
    bound.Predict(readings[i - 1].X_WR, ticks);
    if (i % kReadingsPerUpdate != 0) continue;
    fix.value = driver.measured()[i / kReadingsPerUpdate];
    ours.Update(fix);
    plain.Update(fix);
    bound.Update(readings[i].X_WR, fix);
    if (static_cast<int>(i) / kReadingsPerUpdate != kCheckpoints[checkpoint]) {
      continue;
    }
    sums->ours[checkpoint].Add(
        ErrorsOf(ours.parameters(), ours.parameter_covariance()));
    sums->plain[checkpoint].Add(
        ErrorsOf(plain.parameters(), plain.parameter_covariance()));
    const Errors least = ErrorsOf(kTrue, bound.parameter_covariance());
    for (std::size_t k = 0; k < 2; ++k) {
      sums->bound[checkpoint][k] += least.variance[k];
    }
    ++checkpoint;
  }
}

// Half width of the 95 % band of the mean of n squared standard normals, by
// Wilson and Hilferty's approximation of the chi-square quantile.
double BandEdge(int n, double z) {
  const double a = 2.0 / (9.0 * n);
  return std::pow(1.0 - a + z * std::sqrt(a), 3);
}

std::vector<BenchRow> RowsOf(const Convergence& sums,
                             std::size_t checkpoint,
                             std::size_t k,
                             const char* vision,
                             int seeds) {
  const std::string what = std::string(k == 0 ? "R" : "B") + " after " +
                           std::to_string(kCheckpoints[checkpoint]) +
                           " updates, " + vision;
  const double ours = std::sqrt(sums.ours[checkpoint].squared[k] / seeds);
  const double plain = std::sqrt(sums.plain[checkpoint].squared[k] / seeds);
  const double bound = std::sqrt(sums.bound[checkpoint][k] / seeds);
  BenchRow rms;
  rms.id = "Y23";
  rms.name = what + ": RMS error";
  rms.value = ours;
  rms.unit = k == 0 ? "1" : "m";
  rms.peer = "Cramer-Rao bound";
  rms.peer_value = bound;
  rms.ratio = bound / ours;
  rms.runs = seeds;
  BenchRow share = rms;
  share.name = what + ": RMS / bound";
  share.value = ours / bound;
  share.unit = "x";
  share.peer = "plain EKF (eq. 5)";
  share.peer_value = plain / bound;
  share.ratio = plain / ours;
  share.goal = "<= 1.2";
  share.holds = share.value <= 1.2;
  BenchRow nes = share;
  nes.name = what + ": normalised error squared";
  nes.value = sums.ours[checkpoint].normalised[k] / seeds;
  nes.peer_value = sums.plain[checkpoint].normalised[k] / seeds;
  nes.ratio.reset();
  const double low = BandEdge(seeds, -1.96);
  const double high = BandEdge(seeds, 1.96);
  char goal[48];
  std::snprintf(goal, sizeof goal, "%.2f to %.2f", low, high);
  nes.goal = goal;
  nes.holds = nes.value >= low && nes.value <= high;
  return {rms, share, nes};
}

std::vector<BenchRow> BenchConvergence(bool full) {
  const int seeds = full ? 1000 : 100;
  std::vector<BenchRow> rows;
  for (const Vision& vision : {Vision{0.01, 0.03, "0.01 rad and 3 cm"},
                               Vision{0.002, 0.01, "2 mrad and 1 cm"}}) {
    Convergence sums;
    for (int run = 0; run < seeds; ++run) RunSeed(run, vision, &sums);
    for (std::size_t c = 0; c < kCheckpoints.size(); ++c) {
      for (std::size_t k = 0; k < 2; ++k) {
        const auto added = RowsOf(sums, c, k, vision.name, seeds);
        rows.insert(rows.end(), added.begin(), added.end());
      }
    }
  }
  return rows;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  return waymark::RunBenches(
      argc,
      argv,
      "odometry",
      {{"Y11",
        "Regular and faulty measurements told apart",
        waymark::BenchGate},
       {"Y13",
        "Uncertainty of a path at different reading rates",
        waymark::BenchReadingRate},
       {"Y16",
        "Late measurements, beside fusing them on arrival",
        waymark::BenchLatency},
       {"Y23",
        "Wheel parameters from a wrong start, beside the bound",
        waymark::BenchConvergence}});
}
