#include "tests/logs/evaluation/synthetic_log.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "processes/support/channels.h"
#include "processes/support/log_file.h"
#include "tests/support/drive_simulation.h"

#include <waymark/config_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/initial_pose_t.hpp>
#include <waymark/odometry_parameters_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/position_fix_t.hpp>
#include <waymark/status_t.hpp>
#include <waymark/truth_t.hpp>

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

constexpr std::int64_t kDayUs = 86'400'000'000;

class Generator {
 public:
  Generator(const std::string& path, const SyntheticLogOptions& options)
      : options_(options), random_(options.seed), writer_(path) {}

  void Write() {
    DriveSimulationOptions drive;
    drive.parameters = options_.true_parameters;
    drive.noise = {1e-7, 1e-9};
    drive.start = {1, 2, 0.5};
    drive.rate_hz = 20;
    drive.duration_s = options_.duration_s;
    drive.seed = options_.seed;
    const auto readings =
        SimulateDrive(drive, ZigZagDriver(0.3, 0.9, 1.5, 0.8));
    WriteStart(readings.front());
    Pose2 X_OR;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const SimulatedReading& now = readings[i];
      if (i > 0) {
        X_OR = X_OR *
               IntegrateTicks({now.right_ticks - readings[i - 1].right_ticks,
                               now.left_ticks - readings[i - 1].left_ticks},
                              options_.nominal_parameters,
                              {},
                              DriveIntegration::kArc)
                   .X_R0R1;
      }
      WriteStep(static_cast<int>(i), now, X_OR);
    }
    if (options_.has_estimates) {
      WriteParameters("batch",
                      Microseconds(readings.back().time),
                      options_.true_parameters,
                      1e-4,
                      0);
    }
    writer_.Close();
  }

 private:
  template <typename M>
  void Put(std::string_view channel, const M& message, double delay_s) {
    std::vector<std::uint8_t> data(
        static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(data.data(), 0, static_cast<int>(data.size()));
    writer_.Write(TimeFromMicroseconds(message.utime + kDayUs) +
                      DurationFromSeconds(delay_s),
                  channel,
                  data);
  }

  void WriteStart(const SimulatedReading& first) {
    const std::int64_t utime = Microseconds(first.time);
    WriteParameters("nominal", utime, options_.nominal_parameters, 0.05, 0);
    initial_pose_t start{};
    start.utime = utime;
    start.source = "synthetic";
    start.pose_W[0] = first.X_WR.x;
    start.pose_W[1] = first.X_WR.y;
    start.pose_W[2] = first.X_WR.heading;
    Put(kInitialPose, start, 0);
    if (!options_.has_estimates) return;
    config_t config{};
    config.utime = utime;
    config.process = "pose_filter";
    config.version = "0.1.0";
    config.yaml = "window_s: 2\nnote: \"<b>&\"\n";
    Put(kConfig, config, 0);
  }

  void WriteStep(int i, const SimulatedReading& now, const Pose2& X_OR) {
    const std::int64_t utime = Microseconds(now.time);
    encoders_t encoders{};
    encoders.utime = utime;
    encoders.seq = i;
    encoders.left_ticks = std::llround(now.left_ticks);
    encoders.right_ticks = std::llround(now.right_ticks);
    Put(kEncoders, encoders, 0);
    if (i % 10 == 9) {
      WriteFix(i, now);
    } else if (i % 2 == 0 && options_.has_truth) {
      WriteTruth(now);
    }
    if (!options_.has_estimates) return;
    WritePose(kOdometry, i, utime, X_OR);
    const Pose2 noisy{
        now.X_WR.x + random_.Normal(options_.pose_sigma_m),
        now.X_WR.y + random_.Normal(options_.pose_sigma_m),
        WrapAngle(now.X_WR.heading + random_.Normal(options_.pose_sigma_rad))};
    WritePose(kPose, i, utime, noisy);
    if (i % 2 == 0) WritePose(kPoseSettled, i / 2, utime, noisy);
    if (i % 20 == 0) {
      WriteOnlineParameters(i / 20, now);
      WriteStatus(i / 20, utime);
    }
  }

  void WriteFix(int i, const SimulatedReading& now) {
    position_fix_t fix{};
    fix.utime = Microseconds(now.time);
    fix.seq = i / 10;
    fix.source = options_.fix_source;
    fix.has_x = fix.has_y = 1;
    fix.x = now.X_WR.x;
    fix.y = now.X_WR.y;
    fix.covariance[0] = fix.covariance[4] = 1e-4;
    Put(kPositionFix, fix, 0);
  }

  void WriteTruth(const SimulatedReading& now) {
    truth_t truth{};
    truth.utime = Microseconds(now.time);
    truth.seq = num_truth_++;
    truth.source = "synthetic";
    truth.has_heading = options_.has_truth_heading ? 1 : 0;
    // S sits 3 cm ahead of the axle and 1 cm to its left.
    truth.sensor_R[0] = 0.03;
    truth.sensor_R[1] = 0.01;
    const Eigen::Vector2d p_WS = now.X_WR * Eigen::Vector2d(0.03, 0.01);
    truth.x = p_WS.x();
    truth.y = p_WS.y();
    truth.heading = options_.has_truth_heading ? now.X_WR.heading : 0.0;
    Put(kTruth, truth, 0);
  }

  void WritePose(std::string_view channel,
                 int seq,
                 std::int64_t utime,
                 const Pose2& X) {
    pose_t pose{};
    pose.utime = utime;
    pose.seq = seq;
    pose.is_known = 1;
    pose.pose_W[0] = X.x;
    pose.pose_W[1] = X.y;
    pose.pose_W[2] = X.heading;
    pose.covariance[0] = pose.covariance[4] =
        options_.pose_sigma_m * options_.pose_sigma_m;
    pose.covariance[8] = options_.pose_sigma_rad * options_.pose_sigma_rad;
    Put(channel, pose, options_.latency_s);
  }

  void WriteParameters(const std::string& source,
                       std::int64_t utime,
                       const WheelParameters& values,
                       double relative_sigma,
                       int seq) {
    odometry_parameters_t m{};
    m.utime = utime;
    m.seq = seq;
    m.source = source;
    m.reason = source == "batch" ? options_.no_batch : "";
    m.is_known = m.reason.empty() ? 1 : 0;
    m.k_right = values.k_right;
    m.k_left = values.k_left;
    m.wheel_base = values.wheel_base;
    for (int k = 0; k < 3; ++k) {
      const double sigma = relative_sigma * values.vector()(k);
      m.covariance[4 * k] = sigma * sigma;
      // Apart for each, so that exchanged ones show.
      if (source == "batch") m.observability[k] = 0.98 - 0.1 * k;
    }
    Put(kOdometryParameters, m, 0);
  }

  // From nominal to true, exponentially, within its own three sigma.
  void WriteOnlineParameters(int n, const SimulatedReading& now) {
    const double share = std::exp(-n / 8.0);
    const Eigen::Vector3d truth = options_.true_parameters.vector();
    const Eigen::Vector3d value =
        truth + share * (options_.nominal_parameters.vector() - truth);
    WriteParameters("online",
                    Microseconds(now.time),
                    WheelParameters::FromVector(value),
                    0.04 * share + 0.001,
                    n);
  }

  void WriteStatus(int n, std::int64_t utime) {
    status_t status{};
    status.utime = utime;
    status.seq = n;
    status.process = "pose_filter";
    status.pid = options_.latency_s > 0 ? 1234 : 0;
    status.num_received = 22 * n;
    status.num_published = 33 * n;
    status.num_dropped = 2;
    status.worst_handler_us = options_.latency_s > 0 ? 150 + n : -1;
    status.clock_offset_us = -1;
    status.fault = n == 3 ? "synthetic fault" : "";
    Put(kStatus, status, options_.latency_s);
  }

  SyntheticLogOptions options_;
  Random random_;
  LogWriter writer_;
  int num_truth_ = 0;
};

}  // namespace

void WriteSyntheticLog(const std::string& path,
                       const SyntheticLogOptions& options) {
  Generator(path, options).Write();
}

}  // namespace waymark
