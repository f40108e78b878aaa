// What the batch refiner takes and gives.
#pragma once

#include "estimation/base/time.h"
#include "estimation/filter/differential_drive.h"
#include "estimation/filter/measurement_types.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

// Where a log starts.
struct StartPose {
  Time time;
  Pose2 X_WR;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
};

// One recording. Readings are in time order; of two with the same time the
// later one counts. Measurements may come in any order.
struct BatchLog {
  std::vector<EncoderReading> encoders;
  std::vector<AbsoluteFix> fixes;
  std::vector<RelativeMotion> motions;
  std::optional<StartPose> start;
};

enum class BatchLoss { kNone, kHuber, kCauchy };

// What is estimated of the sensor that measurements of one source come from.
// Its nominal pose X_RS is that of the source's first measurement.
struct BatchSensorOptions {
  std::string source;     // Empty: every source without an entry of its own.
  bool position = false;  // Estimate x and y of X_RS.
  bool yaw = false;       // Estimate the yaw of X_RS (no use for fixes without
                          // heading: not observable).
  bool time_offset = false;  // Estimate the sensor's clock minus the encoders'.
  bool shared = true;        // One mounting for all logs, or one per log.
  double time_offset_s = 0.0;  // Nominal.
  // Prior sigmas about the nominal values.
  double sigma_position_m = 0.3;
  double sigma_yaw_rad = 3.0;
  double sigma_time_offset_s = 0.2;
};

struct BatchOptions {
  WheelParameters initial;  // Where the search starts; mean of the prior.
  // Prior sigmas of k_right, k_left and B as shares of their initial values.
  Eigen::Vector3d relative_sigma{0.2, 0.2, 0.2};
  DriveNoise noise;
  DriveIntegration integration = DriveIntegration::kArc;
  // Error of one reading, ticks: a whole tick is uniform, 1 / sqrt(12).
  double tick_sigma = 0.29;
  // Sideways slip between two keyframes, m. Keeps the covariance of a step
  // (rank 2) positive definite; far below what any fix resolves.
  double slip_sigma_m = 2e-5;

  std::vector<BatchSensorOptions> sensors;

  BatchLoss loss = BatchLoss::kCauchy;  // On each measurement.
  // In sigmas, times sqrt(components): 2.385 keeps 95 % efficiency on normal
  // errors for Cauchy's loss.
  double loss_scale = 2.385;
  BatchLoss odometry_loss =
      BatchLoss::kNone;  // On each step between keyframes.
  // Measurements closer in time than this to a keyframe are tied to it by the
  // ticks between, taken without noise.
  double keyframe_s = 0.001;

  int max_iterations = 60;  // Of Ceres, per round.
  int max_rounds =
      8;  // Rounds renew weights, keyframe times and linearisation.
  double min_travel_m = 0.2;  // Less is too little motion.
  // A wheel parameter counts as observable from this figure on: 0.9 means that
  // the data shrink its prior variance ten times.
  double min_observability = 0.9;
  // Multiplies covariances by the variance factor where that is above 1, for
  // data whose true noise is not known.
  bool scale_covariance = false;
  bool keep_trajectory = false;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

enum class BatchStatus {
  kSolved,         // Everything asked of the wheels is observable.
  kPartly,         // Some wheel parameter is not observable: see result.
  kNotObservable,  // No wheel parameter is: nothing was learnt.
  kNoData,         // Fewer than two readings, or no usable measurement.
  kTooLittleMotion,
  kNotConverged,
  kImplausible,  // A wheel parameter left (1/4, 4) times its initial value:
                 // swapped or reversed wheels, wrong units.
};
[[nodiscard]] const char* NameOf(BatchStatus status);
// True where the result's parameters may be used.
[[nodiscard]] bool HasAnswer(BatchStatus status);

// One sensor mounting. Order everywhere: x m, y m, yaw rad, time offset s.
struct BatchSensor {
  std::string source;
  int log = -1;  // Index of its log; -1: shared by all.
  Pose2 X_RS;
  double time_offset_s = 0.0;
  std::array<bool, 4> is_estimated{};
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  Eigen::Vector4d observability = Eigen::Vector4d::Zero();
  // Residuals after the fit, without robust weights; medians over those that
  // carry the component, 0 where none does.
  int num_measurements = 0;
  int num_inliers = 0;
  double median_position_m = 0.0;
  double median_heading_rad = 0.0;
};

struct TimedPose {
  Time time;  // On the encoders' clock.
  Pose2 X_WR;
};

struct BatchResult {
  BatchStatus status = BatchStatus::kNoData;
  std::string reason;  // One line; empty where kSolved.

  // Where there is no answer: the initial ones, with their prior covariance.
  WheelParameters parameters;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  // 1 - posterior / prior variance, in [0, 1]. 0 where there is no answer.
  Eigen::Vector3d observability = Eigen::Vector3d::Zero();
  std::vector<BatchSensor> sensors;  // By source, then by log.

  double initial_cost = 0.0;  // Half the sum of squares, with loss.
  double final_cost = 0.0;
  int num_iterations = 0;
  int num_rounds = 0;
  int num_keyframes = 0;
  int num_measurements = 0;  // Used.
  // Outside the readings' time, not finite, or by another mounting than the
  // first of that source.
  int num_refused = 0;
  double inlier_share = 0.0;
  double travel_m = 0.0;
  // Weighted sum of squares over degrees of freedom: 1 where the stated noise
  // is the true one.
  double variance_factor = 0.0;
  Time newest;  // Time of the newest measurement used.
  std::vector<std::vector<TimedPose>> trajectories;  // Per log, where kept.
};

}  // namespace waymark
