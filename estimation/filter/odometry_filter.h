// From readings and measurements in the order of their times to poses: counter,
// EKF, gate, first pose and relocalisation in one state machine.
#pragma once

#include "estimation/filter/encoder_counter.h"
#include "estimation/filter/estimate_types.h"
#include "estimation/filter/measurement_types.h"
#include "estimation/filter/odometry_ekf.h"
#include "estimation/filter/pose_aligner.h"
#include "estimation/filter/two_hypothesis_gate.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace waymark {

struct OdometryFilterOptions {
  OdometryEkfOptions ekf;
  GateOptions gate;
  // max_tick_rate is set from max_wheel_speed once the parameters are known.
  EncoderCounterOptions counter;
  PoseAlignerOptions alignment;

  // Where given, parameters that arrive as messages with source "nominal" are
  // not used.
  std::optional<WheelParameters> parameters;
  // What an earlier run learned; the filter starts from it. Dead reckoning
  // stays with the nominal parameters.
  std::optional<OdometryParameters> learned;
  // Prior of parameters that come without covariance, share of their value:
  // (k_right, k_left, B).
  Eigen::Vector3d parameter_sigma{0.05, 0.05, 0.1};
  // True: values with source "batch" replace the filter's own, which are then
  // not estimated online.
  bool adopt_batch = false;

  // Where given, the filter starts here at the first reading.
  std::optional<InitialPose> start;

  double max_wheel_speed = 5.0;  // m/s; a faster count is a jump.
  // Between readings farther apart, the path is uncertain by this share of the
  // travel.
  double max_gap_s = 1.0;
  double gap_share = 0.5;
  // Where unmeasured motion makes the heading more uncertain, the pose is lost
  // and found again like a first one.
  double max_lost_heading_sigma = 0.3;  // rad.
  // A filter that has rejected this many fixes that agree with one another,
  // and accepted no position meanwhile, starts anew from them.
  int relocalise_after = 5;
  // A filter that has rejected this many relative motions in a row doubts its
  // wheel parameters: their standard deviations double.
  int doubt_after = 5;
  // Starts of relative motions that are kept at once, and sensors that measure
  // them; each costs as much as half the filter.
  int max_clones = 8;
  int max_mountings = 4;
};

// The pose at this time is the start of a relative motion that ends at `until`.
struct MotionStart {
  Time until;
};

struct OdometryFilterCounts {
  std::int64_t num_accepted = 0;  // Fixes and motions fused.
  std::int64_t num_rejected = 0;  // By the gate.
  // Before the first reading, or motions over a time without a known pose.
  std::int64_t num_unused = 0;
  std::int64_t num_crowded = 0;  // Motions above max_clones, max_mountings.
  std::int64_t num_doubts = 0;   // Of the wheel parameters.
  std::int64_t num_refused_readings = 0;  // Encoder jumps.
  std::int64_t num_lost_counts = 0;       // New base lines after jumps.
  std::int64_t num_relocalisations = 0;
};

// Copyable, so that a state can be kept and continued; deterministic: the same
// input in the same order gives the same bits. Cost per reading: microseconds.
class OdometryFilter {
 public:
  // What takes effect between readings.
  using Measurement = std::variant<OdometryParameters,
                                   InitialPose,
                                   AbsoluteFix,
                                   RelativeMotion,
                                   MotionStart>;

  explicit OdometryFilter(const OdometryFilterOptions& options);

  // Held until the next accepted reading at or after its `time`, whose motion
  // is divided there (constant speeds between readings). Times must not
  // decrease from call to call, nor lie before the last reading's. A relative
  // motion is of use only where its MotionStart was added at its `from`.
  void Add(Time time, Measurement measurement);
  // Raw counts; times increase.
  void AddReading(const EncoderReading& raw, int counter_bits);

  // At the last reading. Not known: no parameters, no first pose, refused
  // reading, or fault, as the reason says.
  [[nodiscard]] PoseEstimate estimate() const;
  // Dead reckoning X_OR with the nominal parameters since the first reading.
  [[nodiscard]] PoseEstimate odometry() const;
  // What the filter now drives with. Not known: none given yet, or fault.
  [[nodiscard]] OdometryParameters parameters() const;
  [[nodiscard]] const OdometryFilterCounts& counts() const { return counts_; }
  // Empty: healthy. Refused readings, stopped filter.
  [[nodiscard]] std::string fault() const;

 private:
  struct Held {
    Time time;
    Measurement measurement;
  };
  void Start();
  void Move(const WheelTicks& ticks, double seconds);
  void MoveUnmeasured(double seconds);
  void Apply(Time time, const OdometryParameters& parameters);
  void Apply(Time time, const InitialPose& pose);
  void Apply(Time time, const AbsoluteFix& fix);
  void Apply(Time time, const RelativeMotion& motion);
  void Apply(Time time, const MotionStart& start);
  void ApplyAtFirstReading(const std::vector<Held>& held);
  void Locate(const AbsoluteFix& fix);
  void Relocalise(const AbsoluteFix& fix);
  void LosePose(std::string reason);
  void SetDrive(const OdometryParameters& parameters);
  [[nodiscard]] PoseAligner MakeAligner(const Pose2& guess,
                                        bool relocalising) const;

  OdometryFilterOptions options_;
  EncoderCounter counter_;
  std::vector<Held> held_;
  // What the wheels are taken to be; with a covariance.
  std::optional<OdometryParameters> drive_;
  std::optional<WheelParameters> nominal_;  // Of dead reckoning.
  std::optional<OdometryEkf> ekf_;          // While the pose is known.
  std::optional<PoseAligner> aligner_;      // While it is not.
  std::optional<PoseAligner> relocaliser_;  // From rejected fixes.
  Eigen::Vector3d prior_variances_ = Eigen::Vector3d::Zero();
  std::string unknown_;  // Why there is no pose.
  std::string refused_;  // Why the last reading was refused.
  Time time_;
  bool has_reading_ = false;
  Pose2 X_OR_;
  Eigen::Matrix3d odometry_covariance_ = Eigen::Matrix3d::Zero();
  WheelTicks last_ticks_;
  double last_seconds_ = 0.0;
  int rejected_motions_ = 0;  // In a row.
  OdometryFilterCounts counts_;
};

}  // namespace waymark
