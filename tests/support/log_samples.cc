#include "tests/support/log_samples.h"

#include "estimation/base/check.h"
#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"
#include "tests/support/drive_simulation.h"

#include <waymark/config_t.hpp>
#include <waymark/truth_t.hpp>

#include <cmath>

namespace waymark {
namespace {

// Encoder readings come at 20 Hz; the simulation runs twice as fast, so that
// fixes can fall between readings.
constexpr double kSimulationHz = 40.0;
constexpr double kDuration = 40.0;  // s.
// 2026-02-02: stamps are dates, as in live logs.
constexpr Time kStart = TimeFromMicroseconds(1'770'000'000'000'000);

// Drops digits that could differ between mathematical libraries.
double Rounded(double value) {
  constexpr double kStep = 1e-7;
  return std::round(value / kStep) * kStep;
}
Pose2 Rounded(const Pose2& pose) {
  return {Rounded(pose.x), Rounded(pose.y), WrapAngle(Rounded(pose.heading))};
}

struct SampleOptions {
  std::string what;
  Driver driver;
  std::uint64_t seed = 1;
  bool has_start = true;
  // A fix every so many simulation steps, from step 1 on; 0: none.
  std::size_t fix_every = 0;
  bool fix_has_heading = false;
  // A relative motion over so many steps (even: between readings); 0: none.
  std::size_t motion_every = 0;
  Pose2 X_RS;          // True mounting of that sensor.
  Pose2 X_RS_nominal;  // As the log states it.
};

SampleOptions OptionsFor(const std::string& name) {
  SampleOptions options;
  if (name == "zigzag.log") {
    options.what = "zig-zag of +-30 degrees, position fixes at 2 Hz";
    options.driver = ZigZagDriver(0.25, RadiansFromDegrees(30.0), 1.0, 0.8);
    options.seed = 11;
    options.fix_every = 20;
    return options;
  }
  if (name == "square.log") {
    options.what = "squares of 1 m, no start, pose fixes at 1 Hz";
    options.driver = SquareDriver(0.25, 1.0, 0.6);
    options.seed = 12;
    options.has_start = false;
    options.fix_every = 40;
    options.fix_has_heading = true;
    return options;
  }
  WAYMARK_CHECK(name == "scan_matched.log", name);
  options.what = "zig-zag, motion of a sensor mounted askew at 2.5 Hz";
  options.driver = ZigZagDriver(0.2, RadiansFromDegrees(50.0), 0.5, 0.9);
  options.seed = 13;
  options.motion_every = 16;
  options.X_RS = {0.05, 0.01, RadiansFromDegrees(92.0)};
  options.X_RS_nominal = {0.04, 0.0, RadiansFromDegrees(90.0)};
  return options;
}

OdometryParameters NominalWheels() {
  const WheelParameters truth = SampleTruth();
  OdometryParameters nominal;
  nominal.time = kStart;
  nominal.source = "nominal";
  nominal.parameters = {
      1.03 * truth.k_right, 0.98 * truth.k_left, 0.94 * truth.wheel_base};
  nominal.covariance =
      Eigen::Vector3d(
          0.04 * truth.k_right, 0.04 * truth.k_left, 0.08 * truth.wheel_base)
          .cwiseAbs2()
          .asDiagonal();
  return nominal;
}

class SampleWriter {
 public:
  SampleWriter(const SampleOptions& options, LogWriter* writer)
      : options_(options), writer_(writer), noise_(options.seed + 1000) {}

  void WriteHead(const Pose2& X_WR) {
    config_t config;
    config.utime = Microseconds(kStart);
    config.seq = 0;
    config.process = "make_samples";
    config.version = "";  // Bytes stay the same from release to release.
    config.yaml = "what: \"simulated: " + options_.what +
                  "\"\n"
                  "true_parameters: [1.0e-04, 1.02e-04, 0.27]\n";
    writer_->Write(kConfig, config);
    writer_->Write(kOdometryParameters, ToMessage(NominalWheels(), 0));
    if (!options_.has_start) return;
    InitialPose start;
    start.time = kStart;
    start.source = "simulated";
    start.X_WR = Rounded(X_WR);
    start.covariance =
        Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();  // 1 cm, 0.6 degrees.
    writer_->Write(kInitialPose, ToMessage(start));
  }

  void WriteStep(const std::vector<SimulatedReading>& drive, std::size_t i) {
    // Encoders at 20 Hz, truth at 4 Hz.
    if (i % 2 == 0) WriteEncoders(drive[i]);
    if (options_.motion_every > 0 && i > 0 && i % options_.motion_every == 0) {
      WriteMotion(drive[i - options_.motion_every], drive[i]);
    }
    if (options_.fix_every > 0 && i % options_.fix_every == 1) {
      WriteFix(drive[i]);
    }
    if (i % 10 == 0) WriteTruth(drive[i]);
  }

 private:
  void WriteEncoders(const SimulatedReading& now) {
    EncoderReading reading;
    reading.time = now.time;
    reading.seq = num_encoders_++;
    reading.left = std::llround(now.left_ticks);
    reading.right = std::llround(now.right_ticks);
    writer_->Write(kEncoders, ToMessage(reading, 0, false));
  }

  void WriteMotion(const SimulatedReading& from, const SimulatedReading& now) {
    constexpr double kSigmaPosition = 0.001;  // m.
    constexpr double kSigmaYaw = 0.002;       // rad.
    RelativeMotion motion;
    motion.from = from.time;
    motion.time = now.time;
    motion.seq = num_motions_++;
    motion.source = "simulated scan matching";
    const Pose2 X_S0S1 =
        Between(from.X_WR * options_.X_RS, now.X_WR * options_.X_RS);
    motion.X_S0S1 = Rounded(Pose2{X_S0S1.x + noise_.Normal(kSigmaPosition),
                                  X_S0S1.y + noise_.Normal(kSigmaPosition),
                                  X_S0S1.heading + noise_.Normal(kSigmaYaw)});
    motion.covariance =
        Eigen::Vector3d(kSigmaPosition, kSigmaPosition, kSigmaYaw)
            .cwiseAbs2()
            .asDiagonal();
    motion.X_RS = options_.X_RS_nominal;
    writer_->Write(kRelativeMotion, ToMessage(motion));
  }

  void WriteFix(const SimulatedReading& now) {
    constexpr double kSigmaPosition = 0.02;  // m.
    constexpr double kSigmaHeading = 0.02;   // rad.
    AbsoluteFix fix;
    fix.time = now.time;
    fix.seq = num_fixes_++;
    fix.source = "simulated camera";
    fix.has = {true, true, options_.fix_has_heading};
    const Pose2 pose =
        Rounded(Pose2{now.X_WR.x + noise_.Normal(kSigmaPosition),
                      now.X_WR.y + noise_.Normal(kSigmaPosition),
                      now.X_WR.heading + noise_.Normal(kSigmaHeading)});
    fix.value = {pose.x, pose.y, 0.0};
    fix.covariance(0, 0) = kSigmaPosition * kSigmaPosition;
    fix.covariance(1, 1) = kSigmaPosition * kSigmaPosition;
    if (options_.fix_has_heading) {
      fix.value(2) = pose.heading;
      fix.covariance(2, 2) = kSigmaHeading * kSigmaHeading;
    }
    writer_->Write(kPositionFix, ToMessage(fix));
  }

  void WriteTruth(const SimulatedReading& now) {
    truth_t truth{};
    truth.utime = Microseconds(now.time);
    truth.seq = num_truth_++;
    truth.source = "simulated";
    truth.has_heading = 1;
    const Pose2 X_WR = Rounded(now.X_WR);
    truth.x = X_WR.x;
    truth.y = X_WR.y;
    truth.heading = X_WR.heading;
    writer_->Write(kTruth, truth);
  }

  const SampleOptions& options_;
  LogWriter* writer_;
  Random noise_;
  std::int64_t num_encoders_ = 0;
  std::int64_t num_motions_ = 0;
  std::int64_t num_fixes_ = 0;
  std::int32_t num_truth_ = 0;
};

}  // namespace

WheelParameters SampleTruth() {
  return {1.0e-4, 1.02e-4, 0.27};
}

std::vector<std::string> SampleNames() {
  return {"zigzag.log", "square.log", "scan_matched.log"};
}

void WriteSample(const std::string& name,
                 const std::string& path,
                 IfExists if_exists) {
  const SampleOptions options = OptionsFor(name);
  DriveSimulationOptions simulation;
  simulation.parameters = SampleTruth();
  simulation.start = {1.0, 2.0, 0.4};
  simulation.start_time = kStart;
  simulation.rate_hz = kSimulationHz;
  simulation.duration_s = kDuration;
  simulation.seed = options.seed;
  const auto drive = SimulateDrive(simulation, options.driver);
  LogWriter writer(path, if_exists);
  SampleWriter sample(options, &writer);
  sample.WriteHead(drive.front().X_WR);
  for (std::size_t i = 0; i < drive.size(); ++i) sample.WriteStep(drive, i);
  writer.Close();
}

}  // namespace waymark
